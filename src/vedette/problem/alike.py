"""Are two impacts the same? They may be arrays, numbers, collections, dataclasses or anything with ``==``."""

from __future__ import annotations

import copy
import dataclasses
from collections.abc import Mapping
from typing import Any, TypeVar

import numpy as np

ImpactT = TypeVar("ImpactT")


def equal(a: object, b: object, tolerance: float = 0.0, *of: object) -> bool:
    """Tell whether two impacts are `alike`; False also for what cannot be compared."""
    try:
        return alike(a, b, tolerance, *of)
    except (TypeError, ValueError, AttributeError):
        return False


def copied(impact: ImpactT) -> ImpactT:
    """Return an equal copy, or the impact itself where that cannot be had or nobody could tell."""
    try:
        other = copy.deepcopy(impact)
    except (TypeError, ValueError, AttributeError, RuntimeError, copy.Error):
        return impact
    return other if equal(other, impact) else impact


def alike(a: Any, b: Any, tolerance: float = 0.0, *of: Any) -> bool:
    """Tell whether two impacts are equal: integers exactly, floats to the tolerance, the rest by parts.

    The tolerance is a share of the largest float in the same part of ``a``, ``b`` and those impacts that they
    are made ``of``: units do not matter.
    """
    if isinstance(a, np.ndarray | np.generic | int | float | complex):
        one, two = np.asarray(a), np.asarray(b)
        if one.shape != two.shape:
            return False
        if bool(np.all(one == two)):
            return True
        if one.dtype.kind in "fc" or two.dtype.kind in "fc":
            least = tolerance * max(map(_largest, (one, two, *of)))
            return bool(np.allclose(one, two, rtol=tolerance, atol=least, equal_nan=True))
        return False
    if type(a) is not type(b):
        return False
    if isinstance(a, Mapping):
        return a.keys() == b.keys() and all(
            alike(a[key], b[key], tolerance, *(each[key] for each in of if key in each)) for key in a
        )
    if isinstance(a, list | tuple):
        return len(a) == len(b) and all(
            alike(a[i], b[i], tolerance, *(each[i] for each in of if i < len(each))) for i in range(len(a))
        )
    if dataclasses.is_dataclass(a):
        parts = [[getattr(each, field.name) for each in (a, b, *of)] for field in dataclasses.fields(a)]
        return all(alike(one, two, tolerance, *rest) for one, two, *rest in parts)
    return bool(a == b)


def _largest(numbers: Any) -> float:
    """Return the size of the largest finite number in an array."""
    sizes = np.abs(np.multiply(numbers, 1.0))
    return float(np.max(sizes, initial=0.0, where=np.isfinite(sizes)))

"""The guarded way to call a user's objective: what is no number, or none that can be used, stops here."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vedette.errors import InputError, brief
from vedette.number import many
from vedette.problem.objective import BeliefT, ImpactT, Objective

MOST = 1e90  # size of a value: sums over any team stay within what messages carry


def value_of(objective: Objective[BeliefT, ImpactT], belief: BeliefT, impact: ImpactT) -> float:
    """Return ``objective.value``; ``InputError`` if it is not a finite number."""
    return number_of(objective.value(belief, impact), f"{type(objective).__name__}.value")


def values_of(
    objective: Objective[BeliefT, ImpactT], belief: BeliefT, others: ImpactT, own: Sequence[ImpactT]
) -> NDArray[np.float64]:
    """Return ``objective.values``, shape (K,); ``InputError`` if the shape or a number is wrong."""
    values = objective.values(belief, others, own)
    return numbers_of(values, len(own), f"{type(objective).__name__}.values")


def number_of(returned: Any, name: str) -> float:
    """Return as a float what a function of this name returned; ``InputError`` if it is no finite number."""
    plain = not isinstance(returned, str | bytes) and getattr(returned, "ndim", 0) == 0
    try:
        number = float(returned) if plain else None
    except (TypeError, ValueError, OverflowError):
        number = None
    if number is None:
        raise InputError(f"{name} returned {brief(returned)}; it must return a number")
    if not abs(number) <= MOST:
        raise InputError(f"{name} returned {number}; values must be finite, of size {MOST:g} at most")
    return number


def numbers_of(returned: Any, count: int, name: str) -> NDArray[np.float64]:
    """Return as an array what a function of this name returned; ``InputError`` if not ``count`` numbers."""
    try:
        values = np.asarray(returned)
        numeric = values.dtype.kind in "biufO"
        values = values.astype(np.float64, copy=False) if numeric else values
    except (TypeError, ValueError, OverflowError):
        numeric = False
    if not numeric:
        raise InputError(f"{name} returned {brief(returned)}; it must return {many(count, 'number')}")
    if values.shape != (count,):
        raise InputError(f"{name} returned shape {values.shape} for {many(count, 'impact')}; want ({count},)")
    good = np.abs(values) <= MOST
    if not good.all():
        k = int(np.argmin(good))
        want = f"values must be finite, of size {MOST:g} at most"
        raise InputError(f"{name} returned {values[k]} for own[{k}]; {want}")
    return values

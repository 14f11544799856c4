"""Numbers: what counts as one where a caller may give anything, and how many of something are told."""

from __future__ import annotations

import math
from numbers import Integral, Real
from typing import TypeGuard


def is_number(value: object) -> TypeGuard[float]:
    """Tell whether a value is a finite real number, one of NumPy's or not; True and False are none."""
    if isinstance(value, bool) or not isinstance(value, Real):
        return False
    try:
        return math.isfinite(value)
    except OverflowError:  # an int beyond all floats
        return False


def is_whole(value: object) -> TypeGuard[int]:
    """Tell whether a value is an integer by type, one of NumPy's or not; True and False are none."""
    return isinstance(value, Integral) and not isinstance(value, bool)


def short(value: float) -> str:
    """Return three digits of a number, and all that it has before the point: ``0.0123``, ``1073``."""
    return f"{value:.0f}" if 999.5 <= abs(value) < 1e7 else f"{value:.3g}"


def many(count: int, what: str) -> str:
    """Return ``1 robot``, ``2 robots``; ``what`` takes an s where there are more."""
    return f"{count} {what}" if count == 1 else f"{count} {what}s"

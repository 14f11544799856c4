"""Is it an array of numbers as the ready-made objectives take them? If not, what is wrong with it."""

from __future__ import annotations

import sys
from collections.abc import Sequence

import numpy as np
from numpy.typing import DTypeLike

LARGEST = sys.float_info.max  # no float is larger but infinity


def misfit(
    array: object,
    what: str,
    shape: tuple[int, ...] | None = None,
    within: tuple[float, float] = (-LARGEST, LARGEST),
    dtype: DTypeLike | None = None,
) -> str | None:
    """Return why something is no plain array of finite numbers as wanted, ``None`` if it is.

    Args:
        array: the array, or what is given in its place.
        what: what its numbers are, in the plural.
        shape: that it must have; without it any.
        within: least and largest of its numbers.
        dtype: that it must have; without it any of real numbers.
    """
    if not isinstance(array, np.ndarray) or isinstance(array, np.matrix | np.ma.MaskedArray):
        return f"{what} must be a NumPy array; got {type(array).__name__}"
    if array.dtype.kind not in "biuf" or dtype not in (None, array.dtype):
        return f"{what} must be {'real numbers' if dtype is None else np.dtype(dtype)}; got {array.dtype}"
    if shape is not None and array.shape != shape:
        return f"{what} must have shape {shape}; got {array.shape}"
    low, high = within
    if array.size == 0 or (low <= float(array.min()) and float(array.max()) <= high):  # never with a NaN
        return None
    wide = array.astype(np.float64)
    place = np.unravel_index(int(np.argmin((low <= wide) & (wide <= high))), array.shape)
    where = f" at {[int(k) for k in place]}" if place else ""
    return f"{what} must be {_range(low, high)}; got {array[place]}{where}"


def first_misfit(
    arrays: Sequence[object],
    what: str,
    shape: tuple[int, ...],
    within: tuple[float, float] = (-LARGEST, LARGEST),
    dtype: DTypeLike | None = None,
) -> tuple[int, str] | None:
    """Return the first k for which ``arrays[k]`` is a `misfit`, and why; ``None`` if all fit."""
    for k, array in enumerate(arrays):
        if (wrong := misfit(array, what, shape, within, dtype)) is not None:
            return k, wrong
    return None


def _range(low: float, high: float) -> str:
    if high < LARGEST:
        return f"in [{low:.15g}, {high:.15g}]"
    return "finite" if low == -LARGEST else f"finite and >= {low:g}"

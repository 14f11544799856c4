"""What the kernels take: contiguous arrays of their own element types, not copied where possible."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

Mask: TypeAlias = NDArray[np.bool_] | NDArray[np.uint8]


def mask_bytes(mask: Mask) -> NDArray[np.uint8]:
    """Return a mask as contiguous bytes, 0 where false; a contiguous mask is not copied."""
    if mask.dtype == np.uint8:
        return np.ascontiguousarray(mask, dtype=np.uint8)
    return np.ascontiguousarray(mask, dtype=np.bool_).view(np.uint8)


def classes_of(classes: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Return cell classes as contiguous bytes."""
    return np.ascontiguousarray(classes, dtype=np.uint8)


def floats(values: ArrayLike) -> NDArray[np.float64]:
    """Return numbers as a contiguous float64 array."""
    return np.ascontiguousarray(values, dtype=np.float64)


def cells_of(cells: ArrayLike) -> NDArray[np.int64]:
    """Return flat cell indices as a contiguous int64 array."""
    return np.ascontiguousarray(cells, dtype=np.int64)


def flags(values: ArrayLike) -> NDArray[np.bool_]:
    """Return truth values as a contiguous bool array."""
    return np.ascontiguousarray(values, dtype=np.bool_)


def truth(mask: NDArray[Any]) -> NDArray[np.bool_]:
    """View bytes that are 0 or 1 as bool."""
    return mask.view(np.bool_)

"""The connected parts of a grid."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vedette import _kernels


def components(cells: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Return labels ``int64[R, C]``: 4-connected parts from 0 by their smallest flat index, -1 elsewhere.

    Four neighbours are what a robot that cuts no corner can use: a diagonal step needs both side cells.
    """
    return _kernels.components(np.ascontiguousarray(cells))


def largest(cells: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return the part with the most cells (the first of equals) as a mask; no cell where there is none."""
    if not cells.any():
        return np.zeros_like(cells)
    labels = components(cells)
    part: NDArray[np.bool_] = labels == np.bincount(labels[cells]).argmax()
    return part

"""The cells that a disc lies on."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vedette.maps.frame import GridFrame

TOUCH = 1e-6  # a disc that overlaps a cell by less only touches it [m]


def cells_under(frame: GridFrame, x: float, y: float, radius: float) -> NDArray[np.int64]:
    """Return the flat cells that a disc about (x, y) overlaps, ascending; where it stands, all are free.

    Args:
        frame: where the grid lies.
        x: of the middle [m], team frame.
        y: likewise.
        radius: of the disc [m]; none or less: it overlaps nothing.
    """
    if radius <= TOUCH:
        return np.empty(0, np.int64)
    col, off_x = _along(x - frame.origin_x, radius, frame.resolution, frame.cols)
    row, off_y = _along(y - frame.origin_y, radius, frame.resolution, frame.rows)
    inside = off_y[:, None] ** 2 + off_x**2 < (radius - TOUCH) ** 2
    flat: NDArray[np.int64] = (row[:, None] * frame.cols + col)[inside]
    return flat


def _along(
    middle: float, radius: float, side: float, count: int
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Return the cells of one axis within reach, and how far each is from the middle [m]."""
    first = max(0, int((middle - radius) // side))
    cells = np.arange(first, min(count, int((middle + radius) // side) + 1))
    low = cells * side
    return cells, np.maximum(np.maximum(low - middle, middle - low - side), 0.0)

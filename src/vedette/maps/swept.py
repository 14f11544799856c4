"""How much of a grid can come within range of somebody on the move."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray


def most_cells_swept(radius: float, way: ArrayLike, side: float) -> NDArray[np.float64]:
    """``(pi r^2 + 2 r way) / side^2`` with ``r = radius + 2 side``: no disc can touch more cells on its way.

    Whatever the way's shape, what comes within r of it has at most that area, and a cell that the disc
    touches is within ``sqrt(2) side`` of it; the rest of the two sides is for poses rounded to cells.

    Args:
        radius: of the disc [m].
        way: length of the way [m], any shape.
        side: of a cell [m].

    Returns:
        number of cells, in the shape of ``way``.
    """
    r = radius + 2.0 * side
    return np.asarray((math.pi * r**2 + 2.0 * r * np.asarray(way, np.float64)) / side**2)

"""A grid seen on another whose frame is turned and moved: each cell takes what lies under its middle."""

from __future__ import annotations

from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from vedette.align.pose import FramePose
from vedette.maps import GridFrame

CellT = TypeVar("CellT", np.bool_, np.uint8)


def turned(grid: NDArray[CellT], frame: GridFrame, back: FramePose, onto: GridFrame) -> NDArray[CellT]:
    """Return ``(R, C)`` over the frame ``onto``: what a grid of another frame has under each middle, or 0.

    ``back``: T_grid_onto.
    """
    col = onto.origin_x + (np.arange(onto.cols) + 0.5) * onto.resolution
    row = onto.origin_y + (np.arange(onto.rows) + 0.5) * onto.resolution
    (cos, _), (sin, _) = back.rotation
    x = cos * col[None, :] - sin * row[:, None] + back.x
    y = sin * col[None, :] + cos * row[:, None] + back.y
    j = np.floor((x - frame.origin_x) / frame.resolution).astype(np.int64)
    i = np.floor((y - frame.origin_y) / frame.resolution).astype(np.int64)
    inside = (i >= 0) & (i < frame.rows) & (j >= 0) & (j < frame.cols)
    out = np.zeros(onto.shape, grid.dtype)
    out[inside] = grid[i[inside], j[inside]]
    return out

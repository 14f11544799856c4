"""A grid seen on another: each cell takes what lies under its middle."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from vedette.maps.bounds import Bounds, Extent
from vedette.maps.frame import GridFrame

CellT = TypeVar("CellT", np.bool_, np.uint8, np.float32)


def laid(grid: NDArray[CellT], frame: GridFrame, onto: GridFrame) -> NDArray[CellT]:
    """Return ``(R, C)`` over the frame ``onto``: what a grid has under each middle; 0 where nothing."""
    whole = np.zeros(onto.shape, grid.dtype)  # costs no more than what is written to it
    there, under = part_laid(grid, frame, onto)
    whole[there] = under
    return whole


def part_laid(
    grid: NDArray[CellT], frame: GridFrame, onto: GridFrame
) -> tuple[tuple[slice, slice], NDArray[CellT]]:
    """Return the rows and columns of ``onto`` that have something under their middles, and what that is."""
    (to_rows, rows), (to_cols, cols) = _matching_axes(frame, onto)
    return (to_rows, to_cols), grid[rows][:, cols]


def under(frames: Iterable[GridFrame], onto: GridFrame) -> Extent:
    """Return the rows and columns of ``onto`` outside of which none of some frames is under any middle."""
    bounds = Bounds()
    for frame in frames:
        (rows, _), (cols, _) = _matching_axes(frame, onto)
        if rows.stop > rows.start and cols.stop > cols.start:
            bounds.hold(rows.start, rows.stop, cols.start, cols.stop)
    return bounds.extent


def _matching_axes(
    frame: GridFrame, onto: GridFrame
) -> tuple[tuple[slice, slice | NDArray[np.int64]], tuple[slice, slice | NDArray[np.int64]]]:
    """Return along rows and columns what has something under its middle, and what that is."""
    return (
        _matching(onto.origin_y, onto, onto.rows, frame.origin_y, frame, frame.rows),
        _matching(onto.origin_x, onto, onto.cols, frame.origin_x, frame, frame.cols),
    )


def _matching(
    onto_origin: float, onto: GridFrame, onto_size: int, origin: float, frame: GridFrame, size: int
) -> tuple[slice, slice | NDArray[np.int64]]:
    """Return along one axis the cells that have something under their middle, and what that is."""
    middles = onto_origin - origin + (np.arange(onto_size) + 0.5) * onto.resolution
    under = np.floor(middles / frame.resolution).astype(np.int64)
    where = np.flatnonzero((under >= 0) & (under < size))
    if not len(where):
        return slice(0, 0), slice(0, 0)
    to, under = slice(int(where[0]), int(where[-1]) + 1), under[where]
    first, end = int(under[0]), int(under[-1]) + 1
    return to, slice(first, end) if onto.resolution == frame.resolution else under


def around(frames: Sequence[GridFrame]) -> GridFrame:
    """Return the least grid that holds several of one resolution."""
    resolution = frames[0].resolution
    extents = np.array([frame.extent for frame in frames])
    x, y = float(extents[:, 0].min()), float(extents[:, 2].min())
    rows = round((float(extents[:, 3].max()) - y) / resolution)
    cols = round((float(extents[:, 1].max()) - x) / resolution)
    return GridFrame(resolution, rows, cols, x, y)

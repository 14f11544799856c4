"""Tiles of one grid as they lie in another frame, by integer arithmetic."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vedette import _kernels
from vedette.kernels._arrays import cells_of


class TileGround(NamedTuple):
    """Where the cells of source and target lie, each in its own frame."""

    rows: int
    cols: int
    left: int  # x of the lower left corner [um]
    low: int  # y of it [um]
    cell: int  # side [um]


class TileMotion(NamedTuple):
    """Where the source's frame lies in the target's: turned, then moved."""

    x: int  # [um]
    y: int  # [um]
    cos: int  # [2^-24]
    sin: int  # [2^-24]


def render_tiles(
    ids: NDArray[np.int64],
    blocks: NDArray[np.uint8],
    wanted: NDArray[np.int64],
    ground: TileGround,
    motion: TileMotion,
) -> NDArray[np.uint8]:
    """Return ``(T, 1024)`` cells of the wanted tiles: each what the source has under its middle, or 0.

    Args:
        ids: ``(S,)`` of the source's tiles, increasing; all others are 0.
        blocks: ``(S, 1024)`` their cells.
        wanted: ``(T,)`` ids of tiles of the target.
        ground: both grids'; no side is longer than 8 km.
        motion: of the source in the target.
    """
    source = cells_of(ids), np.ascontiguousarray(blocks, dtype=np.uint8)
    return _kernels.render_tiles(source, cells_of(wanted), ground, motion)

"""What the kernel that renders tiles computes, cell by cell for all at once."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vedette.kernels.render import TileGround, TileMotion
from vedette.kernels.tiles import CELLS, SIDE, Tiling


def render_tiles(
    ids: NDArray[np.int64],
    blocks: NDArray[np.uint8],
    wanted: NDArray[np.int64],
    ground: TileGround,
    motion: TileMotion,
) -> NDArray[np.uint8]:
    """Twin of ``render.render_tiles``."""
    tiling = Tiling(ground.rows, ground.cols)
    whole = np.zeros((tiling.count, CELLS), np.uint8)
    whole[ids] = blocks
    top, left = tiling.corners(wanted)
    at = np.arange(CELLS)
    row, col = top[:, None] + at // SIDE, left[:, None] + at % SIDE
    # in halves of a micrometre: the middle of a cell lies between two
    x = 2 * ground.left + (2 * col + 1) * ground.cell - 2 * motion.x
    y = 2 * ground.low + (2 * row + 1) * ground.cell - 2 * motion.y
    u, v = (motion.cos * x + motion.sin * y) >> 24, (motion.cos * y - motion.sin * x) >> 24
    under_row = (v - 2 * ground.low) // (2 * ground.cell)
    under_col = (u - 2 * ground.left) // (2 * ground.cell)
    known = (row < ground.rows) & (col < ground.cols)
    known &= (under_row >= 0) & (under_row < ground.rows) & (under_col >= 0) & (under_col < ground.cols)
    out = np.zeros((len(wanted), CELLS), np.uint8)
    tiles, places = tiling.split((under_row * ground.cols + under_col)[known])
    out[known] = whole[tiles, places]
    return out

"""What the visibility kernels compute: which squares a segment touches, by separating axes in integers."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Mask = NDArray[np.bool_]


def touched(shape: tuple[int, int], start: int, end: int) -> Mask:
    """Mark the closed squares that the segment between two cell centres touches.

    A square is apart from a segment if they are apart along x, along y, or along the segment's normal: all
    four corners strictly on one side of its line.
    """
    rows, cols = np.indices(shape) * 2  # in half cells, so that corners are integers too
    y0, x0, y1, x1 = (2 * int(v) for cell in (start, end) for v in divmod(cell, shape[1]))
    apart_y = (rows - 1 > max(y0, y1)) | (rows + 1 < min(y0, y1))
    apart_x = (cols - 1 > max(x0, x1)) | (cols + 1 < min(x0, x1))
    corners = [(rows + dr, cols + dc) for dr in (-1, 1) for dc in (-1, 1)]
    sides = [np.sign((x1 - x0) * (row - y0) - (y1 - y0) * (col - x0)) for row, col in corners]
    apart_normal = np.abs(np.sum(sides, axis=0)) == 4
    mask: Mask = ~(apart_y | apart_x | apart_normal)
    return mask


def line_of_sight(blocked: Mask, from_cell: int, to_cells: NDArray[np.int64]) -> Mask:
    """Twin of ``visibility.line_of_sight``."""

    def sees(to_cell: int) -> bool:
        between = touched((blocked.shape[0], blocked.shape[1]), from_cell, to_cell)
        between.flat[[from_cell, to_cell]] = False
        return not np.any(between & blocked)

    return np.array([sees(int(cell)) for cell in to_cells], bool)


def visible_cells(solid: Mask, poses: Mask, range_cells: float) -> Mask:
    """Twin of ``visibility.visible_cells``: every cell against every pose."""
    seen = np.zeros(solid.shape, bool)
    free = np.argwhere(~solid)
    for pose in np.argwhere(poses & ~solid):
        near = free[np.sum((free - pose) ** 2, axis=1) <= range_cells**2]
        flat = near[:, 0] * solid.shape[1] + near[:, 1]
        start = int(pose[0] * solid.shape[1] + pose[1])
        seen.flat[flat[line_of_sight(solid, start, flat)]] = True
    return seen

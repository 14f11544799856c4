"""How far frontiers are from an area, if all that is unknown can be driven through."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vedette.kernels.distance import lengths_to
from vedette.maps import OCCUPIED, UNKNOWN, GridFrame
from vedette.maps.area import Area

MOST_SQUARE_METRES = 1e5  # of a box about window and area, beyond which no way is looked for


def ways_to(
    area: Area,
    frame: GridFrame,
    classes: NDArray[np.uint8],
    frontiers: tuple[NDArray[np.int64], NDArray[np.int64]],
    factor: int,
) -> NDArray[np.float64] | None:
    """Return ``(K,)`` the way [m] from each frontier to the middle of what is unknown of an area.

    Shortest paths over planning cells without a wall in them, in the window and the area's box; infinite
    where there is none.  docs/mapping.md (V149)

    Args:
        area: where somebody wants to get.
        frame: of the window.
        classes: ``(R, C)`` of the window.
        frontiers: cells and starts, as ``find_frontiers`` returns them.
        factor: side of a planning cell [cells].

    Returns:
        The ways; None where all of the area is known, nothing leads there, or it is too far off to look.
    """
    cells, starts = frontiers
    low_x, low_y, high_x, high_y = area.box
    x0, x1, y0, y1 = frame.extent
    if (max(high_x, x1) - min(low_x, x0)) * (max(high_y, y1) - min(low_y, y0)) > MOST_SQUARE_METRES:
        return None
    wide, map_there, corner = _around(area, frame, classes, factor)
    rows, cols = np.nonzero(area.holds(wide) & (map_there == UNKNOWN))
    if not len(rows):
        return None
    middle = int(np.argmin((rows - rows.mean()) ** 2 + (cols - cols.mean()) ** 2))
    blocks = map_there.reshape(wide.rows // factor, factor, wide.cols // factor, factor)
    open_ = ~(blocks == OCCUPIED).any(axis=(1, 3))
    source = rows[middle] // factor * open_.shape[1] + cols[middle] // factor
    row, col = np.divmod(cells[(starts[:-1] + starts[1:]) // 2], frame.cols)
    targets = (row + corner[0]) // factor * open_.shape[1] + (col + corner[1]) // factor
    ways = lengths_to(open_, int(source), targets, wide.resolution * factor).astype(np.float64)
    return ways if np.isfinite(ways).any() else None


def _around(
    area: Area, frame: GridFrame, classes: NDArray[np.uint8], factor: int
) -> tuple[GridFrame, NDArray[np.uint8], tuple[int, int]]:
    """Return the window grown by planning cells until it holds the area, its map, and its corner there."""
    side = frame.resolution * factor
    x0, x1, y0, y1 = frame.extent
    low_x, low_y, high_x, high_y = area.box
    left, low = (max(0, int(np.ceil(gap / side))) for gap in (x0 - low_x, y0 - low_y))
    right, high = (max(0, int(np.ceil(gap / side))) for gap in (high_x - x1, high_y - y1))
    rows, cols = -(-frame.rows // factor) + low + high, -(-frame.cols // factor) + left + right
    map_there = np.zeros((rows * factor, cols * factor), np.uint8)
    row, col = low * factor, left * factor
    map_there[row : row + frame.rows, col : col + frame.cols] = classes
    wide = GridFrame(frame.resolution, rows * factor, cols * factor, x0 - left * side, y0 - low * side)
    return wide, map_there, (row, col)

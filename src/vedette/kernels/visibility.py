"""Lines of sight between cell centres, exact: a segment is clear if it touches no blocked square.

A segment through the corner of a square touches it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vedette import _kernels
from vedette.kernels._arrays import Mask, cells_of, mask_bytes, truth


def visible_cells(solid: Mask, poses: Mask, range_cells: float) -> NDArray[np.bool_]:
    """Mark the cells, not solid, that a sensor sees from the centre of some pose cell.

    A pose sees a cell if the segment between their centres touches no solid square and is at most
    ``range_cells`` long. Every pose sees its own cell; poses in solid cells see nothing.

    Args:
        solid: ``(R, C)`` mask.
        poses: ``(R, C)`` mask of the cells where a sensor may be.
        range_cells: the sensor's range [cells].

    Returns:
        ``(R, C)`` mask.
    """
    return truth(_kernels.visible_cells(mask_bytes(solid), mask_bytes(poses), range_cells))


def line_of_sight(blocked: Mask, from_cell: int, to_cells: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Tell which cells the segment from one cell's centre reaches without touching a blocked square between.

    Args:
        blocked: ``(R, C)`` mask; the two cells at a segment's ends may be blocked.
        from_cell: flat index.
        to_cells: ``(K,)`` flat indices.

    Returns:
        ``(K,)`` truth values.
    """
    return _kernels.line_of_sight(mask_bytes(blocked), from_cell, cells_of(to_cells))

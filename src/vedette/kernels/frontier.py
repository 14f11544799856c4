"""Where a robot may stand, and where the known free space meets the unknown."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vedette import _kernels
from vedette.kernels._arrays import classes_of, truth


def traversable(classes: NDArray[np.uint8], radius_m: float, resolution: float) -> NDArray[np.bool_]:
    """Mark the free cells whose centre is at least ``radius_m`` from every square that is not free.

    Outside the grid is not free.

    Args:
        classes: ``(R, C)`` of UNKNOWN, FREE, OCCUPIED.
        radius_m: the robot's radius [m].
        resolution: cell side [m].

    Returns:
        ``(R, C)`` mask of the cells on which the robot's centre may be.
    """
    return truth(_kernels.traversable(classes_of(classes), radius_m, resolution))


def find_frontiers(
    classes: NDArray[np.uint8], min_cells: int, max_extent_cells: int
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Find the free cells with an unknown 4-neighbour, in 8-connected clusters.

    Clusters of fewer than ``min_cells`` cells are dropped. One whose bounding box is longer than
    ``max_extent_cells`` is bisected at the median of its longer side (rows, if equal), its cells sorted along
    that side, then by flat index; its halves likewise.

    Args:
        classes: ``(R, C)`` of UNKNOWN, FREE, OCCUPIED.
        min_cells: fewest cells of a cluster, before bisection.
        max_extent_cells: longest side of a cluster's bounding box [cells].

    Returns:
        ``cells``, ``(M,)`` flat indices, ascending in each cluster, and ``starts``, ``(K + 1,)``: cluster k
        is ``cells[starts[k]:starts[k + 1]]``. Clusters are in order of their smallest cell.
    """
    return _kernels.find_frontiers(classes_of(classes), min_cells, max_extent_cells)

"""Shortest 8-connected paths between traversable cells, without cutting corners.

A diagonal step needs both cells beside it traversable. It counts as 17/12 of a straight one, 0.17 % above the
square root of two; lengths are exact multiples of ``resolution / 12``, equal from either end.

A cell that is not traversable itself (a robot pushed too near a wall) joins the traversable cells within
three cells of it by straight lines.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vedette import _kernels
from vedette.kernels._arrays import Mask, cells_of, mask_bytes


def distance_field(traversable: Mask, source: int, resolution: float) -> NDArray[np.float32]:
    """Return the length [m] of the shortest path from ``source`` to every cell, infinity where there is none.

    Args:
        traversable: ``(R, C)`` mask.
        source: flat index.
        resolution: cell side [m].

    Returns:
        ``(R, C)`` lengths [m].
    """
    return _kernels.distance_field(mask_bytes(traversable), source, resolution)


def lengths_to(
    traversable: Mask, source: int, targets: NDArray[np.int64], resolution: float
) -> NDArray[np.float32]:
    """Return what ``distance_field`` holds at some cells; the work is that of what lies about them.

    Args:
        traversable: ``(R, C)`` mask.
        source: flat index.
        targets: ``(K,)`` flat indices.
        resolution: cell side [m].

    Returns:
        ``(K,)`` lengths [m].
    """
    return _kernels.lengths_to(mask_bytes(traversable), source, cells_of(targets), resolution)


def shortest_path(traversable: Mask, source: int, target: int, resolution: float) -> NDArray[np.int64]:
    """Return the cells of a shortest path: ``path_to`` on ``distance_field``, without looking at the rest.

    Args:
        traversable: ``(R, C)`` mask.
        source: flat index.
        target: flat index.
        resolution: cell side [m].

    Returns:
        ``(L,)`` flat indices, source first; empty if the target is unreachable.
    """
    return _kernels.shortest_path(mask_bytes(traversable), source, target, resolution)


def distance_matrix(
    traversable: Mask, cells: NDArray[np.int64], resolution: float, limit_m: float = np.inf
) -> NDArray[np.float32]:
    """Return the lengths [m] of the shortest paths between every two of ``cells``, symmetric.

    Args:
        traversable: ``(R, C)`` mask.
        cells: ``(K,)`` flat indices; any that is not traversable joins those near it.
        resolution: cell side [m].
        limit_m: longer paths are not searched for, and infinity.

    Returns:
        ``(K, K)`` lengths [m].
    """
    return _kernels.distance_matrix(mask_bytes(traversable), cells_of(cells), resolution, limit_m)


def path_to(field: NDArray[np.float32], traversable: Mask, target: int) -> NDArray[np.int64]:
    """Return the cells from a distance field's source to ``target``, by steepest descent of the field.

    Args:
        field: ``(R, C)`` [m], from ``distance_field`` on the same mask.
        traversable: ``(R, C)`` mask.
        target: flat index.

    Returns:
        ``(L,)`` flat indices, source first; empty if the target is unreachable.
    """
    heights = np.ascontiguousarray(field, dtype=np.float32)
    return _kernels.path_to(heights, mask_bytes(traversable), target)


def shortcut(traversable: Mask, path: NDArray[np.int64]) -> NDArray[np.int64]:
    """Drop the cells of a path that straight lines make needless.

    Greedy: each line goes on while every cell it touches is traversable. Steps of the path itself are kept as
    they are, whatever lies under them.

    Args:
        traversable: ``(R, C)`` mask.
        path: ``(L,)`` flat indices.

    Returns:
        ``(L2,)`` flat indices, the path's first and last included.
    """
    return _kernels.shortcut(mask_bytes(traversable), cells_of(path))

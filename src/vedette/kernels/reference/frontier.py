"""What the frontier kernels compute, said by brute force over the cells."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

UNKNOWN, FREE, OCCUPIED = 0, 1, 2


def traversable(classes: NDArray[np.uint8], radius_m: float, resolution: float) -> NDArray[np.bool_]:
    """Twin of ``frontier.traversable``: from each free cell, measure to every square that is not free."""
    margin = int(radius_m / resolution) + 2
    padded = np.pad(classes, margin, constant_values=OCCUPIED)
    rows, cols = np.nonzero(padded != FREE)
    open_cells = np.zeros(classes.shape, bool)
    for row, col in np.argwhere(classes == FREE):
        gap_y = np.maximum(np.abs(rows - margin - row) - 0.5, 0.0)
        gap_x = np.maximum(np.abs(cols - margin - col) - 0.5, 0.0)
        nearest = np.min(np.hypot(gap_x, gap_y)) * resolution
        open_cells[row, col] = nearest >= radius_m - 1e-9
    return open_cells


def frontier_mask(classes: NDArray[np.uint8]) -> NDArray[np.bool_]:
    """Mark the free cells with an unknown 4-neighbour."""
    unknown = np.pad(classes == UNKNOWN, 1)
    beside = unknown[:-2, 1:-1] | unknown[2:, 1:-1] | unknown[1:-1, :-2] | unknown[1:-1, 2:]
    mask: NDArray[np.bool_] = (classes == FREE) & beside
    return mask


def flood(cells: set[tuple[int, int]], start: tuple[int, int]) -> list[tuple[int, int]]:
    """Take from ``cells`` those 8-connected to ``start``, and return them in flat order."""
    cells.discard(start)
    found = [start]
    for row, col in found:
        around = {(row + dr, col + dc) for dr in (-1, 0, 1) for dc in (-1, 0, 1)} & cells
        cells -= around
        found.extend(around)
    return sorted(found)


def split(cells: list[tuple[int, int]], max_extent: int) -> list[list[tuple[int, int]]]:
    """Bisect at the median of the longer side, rows if equal, until no side is longer than ``max_extent``."""
    sides = [max(axis) - min(axis) + 1 for axis in zip(*cells, strict=True)]
    if max(sides) <= max_extent:
        return [sorted(cells)]
    longer = 0 if sides[0] >= sides[1] else 1
    ordered = sorted(cells, key=lambda cell: (cell[longer], cell))
    half = len(ordered) // 2
    return split(ordered[:half], max_extent) + split(ordered[half:], max_extent)


def find_frontiers(
    classes: NDArray[np.uint8], min_cells: int, max_extent_cells: int
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Twin of ``frontier.find_frontiers``."""
    left = {(int(row), int(col)) for row, col in np.argwhere(frontier_mask(classes))}
    parts: list[list[tuple[int, int]]] = []
    while left:
        cluster = flood(left, min(left))
        if len(cluster) >= min_cells:
            parts += split(cluster, max_extent_cells)
    parts.sort()
    cells = [row * classes.shape[1] + col for part in parts for row, col in part]
    starts = np.cumsum([0, *(len(part) for part in parts)])
    return np.array(cells, np.int64), starts.astype(np.int64)

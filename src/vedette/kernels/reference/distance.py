"""What the distance kernels compute, said with Dijkstra's algorithm on every allowed move."""

from __future__ import annotations

import heapq
import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from vedette.kernels.reference.visibility import touched

STRAIGHT, DIAGONAL, CONNECTION = 12, 17, 3

Mask = NDArray[np.bool_]
MOVES = ((0, 1), (1, 1), (1, 0), (1, -1), (0, -1), (-1, -1), (-1, 0), (-1, 1))


def moves_from(traversable: Mask, cell: int) -> Iterator[tuple[int, int]]:
    """Yield the cells one allowed move away, and the move's cost in 12ths of a cell."""
    rows, cols = traversable.shape
    row, col = divmod(cell, cols)
    for dr, dc in MOVES:
        r, c = row + dr, col + dc
        if (
            0 <= r < rows
            and 0 <= c < cols
            and traversable[r, c]
            and traversable[row, c]
            and traversable[r, col]
        ):
            yield r * cols + c, DIAGONAL if dr and dc else STRAIGHT


def connections(traversable: Mask, cell: int) -> dict[int, int]:
    """Return how a cell joins the traversable ones: itself, or straight lines to those within three cells."""
    if traversable.flat[cell]:
        return {cell: 0}
    cols = traversable.shape[1]
    row, col = divmod(cell, cols)
    lengths = {int(r * cols + c): math.hypot(r - row, c - col) for r, c in np.argwhere(traversable)}
    return {other: round(STRAIGHT * length) for other, length in lengths.items() if length <= CONNECTION}


def costs_from(traversable: Mask, source: int) -> dict[int, int]:
    """Return the cost in 12ths of a cell of every traversable cell that can be reached."""
    settled: dict[int, int] = {}
    queue = [(cost, cell) for cell, cost in connections(traversable, source).items()]
    heapq.heapify(queue)
    while queue:
        cost, cell = heapq.heappop(queue)
        if cell not in settled:
            settled[cell] = cost
            for other, step in moves_from(traversable, cell):
                heapq.heappush(queue, (cost + step, other))
    return settled


def distance_field(traversable: Mask, source: int, resolution: float) -> NDArray[np.float32]:
    """Twin of ``distance.distance_field``."""
    field = np.full(traversable.shape, np.inf, np.float32)
    for cell, cost in costs_from(traversable, source).items():
        field.flat[cell] = cost * resolution / STRAIGHT
    field.flat[source] = 0.0
    return field


def distance_matrix(
    traversable: Mask, cells: NDArray[np.int64], resolution: float, limit_m: float = math.inf
) -> NDArray[np.float32]:
    """Twin of ``distance.distance_matrix``."""
    matrix = np.full((len(cells), len(cells)), np.inf, np.float32)
    for i, source in enumerate(cells):
        costs = costs_from(traversable, int(source))
        for j, target in enumerate(cells):
            joins = connections(traversable, int(target)).items()
            lengths = [
                (costs[cell] + extra) * resolution / STRAIGHT for cell, extra in joins if cell in costs
            ]
            length = 0.0 if source == target else min(lengths, default=math.inf)
            if length <= limit_m + 1e-9:
                matrix[i, j] = length
    return matrix


def path_to(field: NDArray[np.float32], traversable: Mask, target: int) -> NDArray[np.int64]:
    """Twin of ``distance.path_to``."""
    path = [target] if np.isfinite(field.flat[target]) else []
    while path and field.flat[path[-1]] > 0:
        here = path[-1]
        height = float(field.flat[here])
        slopes = [
            ((height - float(field.flat[cell])) / (1.0 if step == STRAIGHT else math.sqrt(2.0)), cell)
            for cell, step in moves_from(traversable, here)
        ]
        steepest = max((slope for slope, _ in slopes), default=0.0)
        row, col = divmod(here, field.shape[1])
        near = np.argwhere(field == 0)
        near = near[np.max(np.abs(near - (row, col)), axis=1) <= CONNECTION]
        if steepest > 0:
            path.append(next(cell for slope, cell in slopes if slope == steepest))
        elif len(near):
            path.append(int(near[0][0] * field.shape[1] + near[0][1]))
        else:
            path = []
    return np.array(path[::-1], np.int64)


def shortcut(traversable: Mask, path: NDArray[np.int64]) -> NDArray[np.int64]:
    """Twin of ``distance.shortcut``."""
    shape = (traversable.shape[0], traversable.shape[1])
    kept = [int(cell) for cell in path[:1]]
    for i in range(2, len(path)):
        if np.any(touched(shape, kept[-1], int(path[i])) & ~traversable):
            kept.append(int(path[i - 1]))
    return np.array(kept + [int(cell) for cell in path[1:][-1:]], np.int64)

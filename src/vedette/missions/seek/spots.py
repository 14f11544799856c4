"""Where to stand to look for somebody, in what is known of a building."""

from __future__ import annotations

import heapq
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from vedette.domains.mapping.belief import MapBelief
from vedette.domains.mapping.stops import Ground

APART = 0.6  # between places that are considered, along either axis [m]
LEAST_ROOM = 0.4  # not yet searched, that a place must have in sight [m^2]
MOST_SPOTS = 24  # in a round
MOST_LOOKS = 400  # to find them

Look = Callable[[int], NDArray[np.int64]]  # from a cell, the planning cells in sight


def good_spots(
    belief: MapBelief, ground: Ground, unsearched: NDArray[np.float64], reach: float, look: Look
) -> list[int]:
    """Return the cells from which most is seen that the others do not see, greedily, the best first.

    Args:
        belief: the map.
        ground: of the robot.
        unsearched: ``(r, c)`` of the window's planning cells, room for somebody times the chance that all
            looks so far would have missed them [cells].
        reach: of a look [m].
        look: what is in sight of a cell.
    """
    left = unsearched.ravel().copy()
    least = LEAST_ROOM / belief.frame.resolution**2
    waiting = _bounds(belief, ground, unsearched, reach, least)
    chosen: list[int] = []
    looks = 0
    round_of: dict[int, int] = {}  # in which each was looked at last
    while waiting and len(chosen) < MOST_SPOTS and looks < MOST_LOOKS:
        bound, cell = heapq.heappop(waiting)
        if -bound < least:
            break
        if round_of.get(cell) == len(chosen):  # looked at since the last one was chosen, and still the best
            chosen.append(cell)
            left[look(cell)] = 0.0
            continue
        looks += 1
        round_of[cell] = len(chosen)
        heapq.heappush(waiting, (-float(left[look(cell)].sum()), cell))
    return chosen


def _bounds(
    belief: MapBelief, ground: Ground, unsearched: NDArray[np.float64], reach: float, least: float
) -> list[tuple[float, int]]:
    """Return a heap of places with more than is in sight of each: all that is unsearched in a square."""
    rows, cols = belief.frame.shape
    step = max(1, round(APART / belief.frame.resolution))
    row, col = np.meshgrid(np.arange(step // 2, rows, step), np.arange(step // 2, cols, step), indexing="ij")
    cells = (row * cols + col).ravel()
    cells = cells[np.isfinite(ground.field.ravel()[cells])]
    around = _in_squares(unsearched, int(reach / belief.planning.resolution) + 1)
    bound = around[cells // cols // belief.factor, cells % cols // belief.factor]
    heap = [(-float(most), int(cell)) for most, cell in zip(bound, cells, strict=True) if most >= least]
    heapq.heapify(heap)
    return heap


def _in_squares(numbers: NDArray[np.float64], half: int) -> NDArray[np.float64]:
    """Return the sum (r, c) of all numbers that are at most ``half`` rows and columns from each."""
    summed = np.pad(numbers.cumsum(axis=0).cumsum(axis=1), ((1, 0), (1, 0)))
    (top, bottom), (left, right) = (
        (np.maximum(np.arange(size) - half, 0), np.minimum(np.arange(size) + half + 1, size))
        for size in numbers.shape
    )
    across = summed[:, right] - summed[:, left]
    return np.asarray(across[bottom] - across[top])

"""Generate a maze: long detours, dead ends and a few loops."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vedette.maps.world import World
from vedette.sim.worlds.rect import Rect
from vedette.sim.worlds.size import WorldScale, world_frame

_CORRIDOR = 1.5  # least width [m]
_WALL = 0.2  # [m]
_LOOPS = 0.06  # share of the remaining walls that are opened as well
_STEPS = ((0, 1), (0, -1), (1, 0), (-1, 0))

Hall = tuple[int, int]  # row, column of a square between walls


def maze(
    rng: np.random.Generator, width: float = 30.0, height: float = 20.0, resolution: float = 0.1
) -> World:
    """Return a maze with corridors at least 1.4 m wide, every part connected, with some loops.

    Args:
        rng: where the variety comes from.
        width: in x [m], 10 to 400.
        height: in y [m], 10 to 400.
        resolution: cell side [m], 0.02 to 0.2.

    Raises:
        InputError: a size out of range, or more than 8000 cells a side.
    """
    frame = world_frame(width, height, resolution)
    cells = WorldScale(resolution)
    wall = cells(_WALL)
    rows = _lines(frame.rows, cells(_CORRIDOR), wall)
    cols = _lines(frame.cols, cells(_CORRIDOR), wall)
    solid = np.ones(frame.shape, np.bool_)
    for (row, col), (row_to, col_to) in _passages(rng, len(rows) - 1, len(cols) - 1):
        hall = Rect(
            rows[min(row, row_to)] + wall,
            cols[min(col, col_to)] + wall,
            rows[max(row, row_to) + 1],
            cols[max(col, col_to) + 1],
        )
        solid[hall.slices] = False
    return World(frame, solid, "maze")


def _lines(size: int, corridor: int, wall: int) -> NDArray[np.int64]:
    """Return where walls begin, evenly spread, the first at 0 and the last ending at ``size``."""
    count = (size - wall) // (corridor + wall)
    return np.arange(count + 1) * (size - wall) // count


def _passages(rng: np.random.Generator, rows: int, cols: int) -> list[tuple[Hall, Hall]]:
    """Return a random spanning tree over the squares, by depth-first search, and some edges more."""
    start = (int(rng.integers(rows)), int(rng.integers(cols)))
    seen, stack = {start}, [start]
    passages: set[tuple[Hall, Hall]] = set()
    while stack:
        ways = [hall for hall in _beside(stack[-1], rows, cols) if hall not in seen]
        if not ways:
            stack.pop()
            continue
        hall = ways[rng.integers(len(ways))]
        passages.add((min(stack[-1], hall), max(stack[-1], hall)))
        seen.add(hall)
        stack.append(hall)
    every = [(a, b) for a in np.ndindex(rows, cols) for b in _beside((a[0], a[1]), rows, cols) if a < b]
    closed = [edge for edge in every if edge not in passages]
    loops = rng.choice(len(closed), max(1, round(_LOOPS * len(closed))), replace=False)
    return sorted(passages) + [closed[i] for i in loops]


def _beside(hall: Hall, rows: int, cols: int) -> list[Hall]:
    near = [(hall[0] + step[0], hall[1] + step[1]) for step in _STEPS]
    return [(row, col) for row, col in near if 0 <= row < rows and 0 <= col < cols]

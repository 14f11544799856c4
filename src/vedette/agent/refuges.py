"""Where a robot goes to let another one pass."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vedette.agent.intents import GAP, Intent, apart
from vedette.kernels.distance import distance_field, path_to, shortcut
from vedette.kernels.motion import block_discs

ROOM = 0.15  # between a refuge's rim and the rim of the one that passes [m]
WINDOW = 5.0  # half side of the square around a robot in which it looks for a refuge [m]
NEARER = 0.02  # a robot may come this much nearer than it stands while it gets out of the way [m]
TRIES = 12  # refuges examined, cheapest first
APART = 0.4  # between two of them [m]
RETREAT = 1.0  # half side of the square within which a robot draws back for want of a refuge [m]
DRAW_BACK = 0.1  # room that it must gain by each metre of doing so [m]


def refuge(
    traversable: NDArray[np.bool_],
    resolution: float,
    me: Intent,
    mate: Intent,
    bystanders: Sequence[Intent],
    further: float,
) -> NDArray[np.float64] | None:
    """Path to the refuge that costs me the least detour and that I reach without meeting the mate, if any.

    ``further``: room that I leave the mate beyond what it needs [m].
    """
    rows, cols = _box(traversable.shape, resolution, me.x, me.y, WINDOW)
    corner = np.array((cols.start, rows.start)) * resolution
    window = np.ascontiguousarray(traversable[rows, cols])
    if not window.size:  # nothing is known here yet, as by a robot that has just been started anew
        return None
    discs = [(o.x - corner[0], o.y - corner[1], me.radius + o.radius + GAP) for o in (mate, *bystanders)]
    here = _flat(window.shape, resolution, np.array((me.x, me.y)) - corner)
    open_ = block_discs(window, resolution, discs)
    way = mate.foreseen - corner
    from_me = distance_field(open_, here, resolution)
    cost = from_me.astype(np.float64)
    room = me.radius + mate.radius + ROOM + further
    clear = block_discs(open_, resolution, [(*p, room) for p in way])
    cost[~clear] = np.inf
    if len(me.path) and np.isfinite(cost).any():
        goal = _flat(window.shape, resolution, me.path[-1] - corner)
        # Ties: as far on my way as possible, to wait at the door and not in the far corner.
        cost += 1.01 * distance_field(window, goal, resolution)
    for passing in (mate.foreseen, replace(mate, path=np.empty((0, 2))).foreseen):
        tries = cost.copy()
        for _ in range(TRIES):
            cell = int(np.argmin(tries))
            if not np.isfinite(tries.flat[cell]):
                break
            path = _path(from_me, open_, resolution, cell, corner, me)
            if _meets_not(replace(me, path=path), passing, me.radius + mate.radius + GAP / 2):
                return path
            x, y = path[-1] - corner
            tries = np.where(block_discs(np.isfinite(tries), resolution, [(x, y, APART)]), tries, np.inf)
    return None


def retreat(
    traversable: NDArray[np.bool_],
    resolution: float,
    me: Intent,
    way: NDArray[np.float64],
    others: Sequence[Intent],
) -> NDArray[np.float64] | None:
    """Path to where I am farthest from a mate's foreseen ``way``, for want of a refuge; None: I am there.

    In a crowd nobody can get out of the way at once. When everybody draws back a little, those at its rim
    can, and the others after them.
    """
    rows, cols = _box(traversable.shape, resolution, me.x, me.y, RETREAT)
    corner = np.array((cols.start, rows.start)) * resolution
    window = np.ascontiguousarray(traversable[rows, cols])
    if not window.size:  # nothing is known here yet, as by a robot that has just been started anew
        return None
    here = _flat(window.shape, resolution, np.array((me.x, me.y)) - corner)
    discs = [(o.x - corner[0], o.y - corner[1], me.radius + o.radius + GAP / 2) for o in others]
    open_ = block_discs(window, resolution, discs)
    open_.flat[here] = True
    from_me = distance_field(open_, here, resolution)
    y, x = ((np.arange(size) + 0.5) * resolution for size in window.shape)
    to_way = [np.hypot(x - p[0], (y - p[1])[:, None]) for p in way - corner]
    gain = np.where(np.isfinite(from_me), np.min(to_way, axis=0) - DRAW_BACK * from_me, -np.inf)
    best = int(np.argmax(gain))
    if gain.flat[best] < np.hypot(*(way - (me.x, me.y)).T).min() + resolution:
        return None
    return _path(from_me, open_, resolution, best, corner, me)


def _path(
    from_me: NDArray[np.float32],
    open_: NDArray[np.bool_],
    resolution: float,
    cell: int,
    corner: NDArray[np.float64],
    me: Intent,
) -> NDArray[np.float64]:
    """Return my way to a cell of the window, ``(L, 2)`` [m]."""
    row, col = np.divmod(shortcut(open_, path_to(from_me, open_, cell)), open_.shape[1])
    path = np.column_stack(((col + 0.5) * resolution, (row + 0.5) * resolution)) + corner
    path[0] = me.x, me.y
    return path


def _meets_not(me: Intent, theirs: NDArray[np.float64], limit: float) -> bool:
    """Tell whether my motion keeps ``limit`` from theirs, or at least never comes nearer than now."""
    between = apart(me.foreseen, [theirs])[0]
    return bool(between.min() >= min(limit, between[0] - NEARER))


def _box(shape: tuple[int, ...], resolution: float, x: float, y: float, reach: float) -> tuple[slice, slice]:
    """Rows and columns of the cells within ``reach`` of the point, clipped to the grid."""
    low = np.floor((np.array((y, x)) - reach) / resolution).astype(int)
    high = np.floor((np.array((y, x)) + reach) / resolution).astype(int) + 1
    low, high = np.clip(low, 0, shape), np.clip(high, 0, shape)
    return slice(int(low[0]), int(high[0])), slice(int(low[1]), int(high[1]))


def _flat(shape: tuple[int, ...], resolution: float, p: NDArray[np.float64]) -> int:
    """Flat index of the cell that holds the point, or of the nearest cell to a point outside."""
    col, row = np.clip(np.floor(p / resolution).astype(int), 0, (shape[1] - 1, shape[0] - 1))
    return int(row) * shape[1] + int(col)

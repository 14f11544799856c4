"""Right of way in narrow places: who makes room for whom, and where to.

Robots that meet in the open pass each other by themselves (``vedette.kernels.motion.steer``). Where two
cannot pass side by side, one of them makes room: a standing robot for a moving one, the higher index for the
lower; but the other way round where the one that should has nowhere to go. The longer somebody is held up,
the more room everybody near gives. Each robot works this out for itself from what all beacon, twice a second.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vedette.kernels.distance import distance_field, path_to, shortcut

GAP = 0.1  # between two rims that pass [m]
ROOM = 0.15  # between a refuge's rim and the rim of the one that passes [m]
SLOWED = 2.0  # without progress for this long: not just about to pass [s]
SPREAD = 0.1  # further room for each second that somebody is held up beyond that [m/s]
MOST_SPREAD = 0.6  # [m]
CLOSE = 1.2  # centres nearer than this when slowed hinder each other, whatever the width [m]
HORIZON = 3.0  # of a beaconed path [m]
WINDOW = 5.0  # half side of the square around a robot in which it looks for a refuge [m]
NEARER = 0.02  # a robot may come this much nearer than it stands while it gets out of the way [m]
TICK = 0.2  # of the foreseen motion [s]
TRIES = 12  # refuges examined, cheapest first
APART = 0.4  # between two of them [m]


@dataclass(frozen=True, eq=False)
class Intent:
    """What a robot beacons of its motion; positions in metres from the grid's lower-left corner."""

    priority: int  # its index: lower goes first
    x: float
    y: float
    path: NDArray[np.float64]  # (L, 2) its next ~3 m, from where it is; empty: it stands still
    radius: float = 0.2  # [m]
    speed: float = 0.5  # [m/s]
    slowed: float = 0.0  # time without progress [s]

    @property
    def rank(self) -> tuple[bool, int]:
        """Lower goes first: moving before standing, then by priority."""
        return len(self.path) == 0, self.priority


def block_discs(
    traversable: NDArray[np.bool_], resolution: float, discs: Iterable[tuple[float, float, float]]
) -> NDArray[np.bool_]:
    """Return ``traversable`` ``(R, C)`` without the cells whose centre lies in a disc ``(x, y, r)`` [m].

    For a centre to keep clear of a body, ``r`` is the sum of both radii and the gap wanted.
    """
    free = traversable.copy()
    for x, y, r in discs:
        rows, cols = _box(traversable.shape, resolution, x, y, r)
        dx = (np.arange(cols.start, cols.stop) + 0.5) * resolution - x
        dy = (np.arange(rows.start, rows.stop) + 0.5) * resolution - y
        free[rows, cols] &= dx[None, :] ** 2 + dy[:, None] ** 2 >= r * r
    return free


def give_way(
    traversable: NDArray[np.bool_], resolution: float, me: Intent, others: Sequence[Intent]
) -> NDArray[np.float64] | None:
    """Return the path to a refuge if I must make room for a team-mate; None if not, or if there is no refuge.

    ``traversable`` ``(R, C)``: cells where my map allows my centre. ``me.path`` is where I want to go, even
    while I am making room. The path ``(L, 2)`` [m] starts where I am; a single point means: wait here.
    The mate has passed when a later call returns None.
    """
    near = [o for o in others if np.hypot(o.x - me.x, o.y - me.y) < 2.0 * HORIZON and len(o.path) > 0]
    for mate in sorted(near, key=lambda o: o.rank):
        if not _conflict(traversable, resolution, me, mate):
            continue
        if mate.rank > me.rank:
            bystanders = [o for o in others if o is not mate]
            if (
                max(me.slowed, mate.slowed) < 2.0 * SLOWED
                or _refuge(traversable, resolution, mate, me, bystanders) is not None
            ):
                continue
        refuge = _refuge(traversable, resolution, me, mate, [o for o in others if o is not mate])
        if refuge is not None:
            return refuge
    return None


def _conflict(traversable: NDArray[np.bool_], resolution: float, me: Intent, mate: Intent) -> bool:
    """Tell whether we meet head-on, or I stand in the mate's way, where two cannot pass side by side."""
    mine, theirs = _foresee(me), _foresee(mate)
    steps = max(len(mine), len(theirs))
    apart = np.hypot(*(_padded(mine, steps) - _padded(theirs, steps)).T)
    limit = me.radius + mate.radius + GAP + _spread(me, mate)
    if apart.min() >= limit:
        return False
    if max(me.slowed, mate.slowed) >= SLOWED and apart[0] < CLOSE:
        return True
    if not _opposed(mine, theirs, limit):
        return False
    place = min(int(np.argmax(apart < limit)), len(theirs) - 1)
    return _width(traversable, resolution, theirs, place) < limit + resolution


def _spread(me: Intent, mate: Intent) -> float:
    """Further room [m] between two robots: the longer a jam lasts, the more it is drawn apart."""
    return min(SPREAD * max(me.slowed - SLOWED, mate.slowed - SLOWED, 0.0), MOST_SPREAD)


def _opposed(mine: NDArray[np.float64], theirs: NDArray[np.float64], limit: float) -> bool:
    """Tell whether, within ``limit``, our ways oppose each other; to stand in a mate's way counts too."""
    if len(mine) < 2:
        return len(theirs) > 1
    a, b = np.diff(mine, axis=0), np.diff(theirs, axis=0)
    near = np.hypot(*(mine[:-1, None] - theirs[None, :-1]).transpose(2, 0, 1)) < limit
    dot = a @ b.T
    scale = np.hypot(*a.T)[:, None] * np.hypot(*b.T)[None, :]
    return bool((near & (dot < -0.3 * scale)).any())


def _width(traversable: NDArray[np.bool_], resolution: float, way: NDArray[np.float64], place: int) -> float:
    """Least width [m] open to centres, across ``way``, within half a metre of its point ``place``."""
    reach = np.hypot(*(way - way[place]).T) <= 0.5
    step = np.diff(way, axis=0, append=way[-1:] + (way[-1:] - way[-2:-1]))
    widths = [
        _ray(traversable, resolution, p, n) + _ray(traversable, resolution, p, -n)
        for p, n in zip(way[reach], np.column_stack((-step[reach, 1], step[reach, 0])), strict=True)
        if np.hypot(*n) > 0
    ]
    return min(widths, default=0.0)


def _ray(
    traversable: NDArray[np.bool_], resolution: float, p: NDArray[np.float64], direction: NDArray[np.float64]
) -> float:
    """Distance [m] from ``p`` along ``direction`` to the first cell that is not traversable, at most 1 m."""
    distances = np.arange(0.0, 1.0, resolution / 2)
    points = p + distances[:, None] * direction / np.hypot(*direction)
    open_ = _lookup(traversable, resolution, points)
    return float(distances[int(np.argmin(open_))]) if not open_.all() else 1.0


def _refuge(
    traversable: NDArray[np.bool_],
    resolution: float,
    me: Intent,
    mate: Intent,
    bystanders: Sequence[Intent],
) -> NDArray[np.float64] | None:
    """Path to the refuge that costs me the least detour and that I reach without meeting the mate."""
    rows, cols = _box(traversable.shape, resolution, me.x, me.y, WINDOW)
    corner = np.array((cols.start, rows.start)) * resolution
    window = np.ascontiguousarray(traversable[rows, cols])
    discs = [(o.x - corner[0], o.y - corner[1], me.radius + o.radius + GAP) for o in (mate, *bystanders)]
    here = _flat(window.shape, resolution, np.array((me.x, me.y)) - corner)
    open_ = block_discs(window, resolution, discs)
    way = _foresee(mate) - corner
    from_me = distance_field(open_, here, resolution)
    cost = from_me.astype(np.float64)
    if len(me.path):
        goal = _flat(window.shape, resolution, me.path[-1] - corner)
        # Ties: as far on my way as possible, to wait at the door and not in the far corner.
        cost += 1.01 * distance_field(window, goal, resolution)
    room = me.radius + mate.radius + ROOM + _spread(me, mate)
    clear = block_discs(open_, resolution, [(*p, room) for p in way])
    cost[~clear] = np.inf
    passing = _foresee(mate)
    standing = replace(mate, path=np.empty((0, 2)))
    for wait in (passing, _foresee(standing)):
        tries = cost.copy()
        for _ in range(TRIES):
            cell = int(np.argmin(tries))
            if not np.isfinite(tries.flat[cell]):
                break
            path = _points(window.shape, resolution, shortcut(open_, path_to(from_me, open_, cell))) + corner
            path[0] = (me.x, me.y)
            if _meets_not(replace(me, path=path), wait, me.radius + mate.radius + GAP / 2):
                return path
            x, y = path[-1] - corner
            tries = np.where(block_discs(np.isfinite(tries), resolution, [(x, y, APART)]), tries, np.inf)
    return None


def _meets_not(me: Intent, theirs: NDArray[np.float64], limit: float) -> bool:
    """Tell whether my motion keeps ``limit`` from theirs, or at least never comes nearer than now."""
    mine = _foresee(me)
    steps = max(len(mine), len(theirs))
    apart = np.hypot(*(_padded(mine, steps) - _padded(theirs, steps)).T)
    return bool(apart.min() >= min(limit, apart[0] - NEARER))


def _foresee(robot: Intent) -> NDArray[np.float64]:
    """Places ``(T, 2)`` every ``TICK`` seconds if the robot drives its path freely; one if it stands."""
    xy = np.empty((len(robot.path) + 1, 2))
    xy[0], xy[1:] = (robot.x, robot.y), robot.path
    if len(xy) == 1:
        return xy
    step = xy[1:] - xy[:-1]
    arc = np.zeros(len(xy))
    np.cumsum(np.sqrt((step * step).sum(axis=1)), out=arc[1:])
    along = np.arange(0.0, arc[-1] + robot.speed * TICK, robot.speed * TICK)
    way = np.empty((len(along), 2))
    way[:, 0], way[:, 1] = np.interp(along, arc, xy[:, 0]), np.interp(along, arc, xy[:, 1])
    return way


def _padded(way: NDArray[np.float64], steps: int) -> NDArray[np.float64]:
    return np.vstack((way, np.repeat(way[-1:], steps - len(way), axis=0)))


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


def _points(shape: tuple[int, ...], resolution: float, flat: NDArray[np.int64]) -> NDArray[np.float64]:
    row, col = np.divmod(flat, shape[1])
    return np.column_stack(((col + 0.5) * resolution, (row + 0.5) * resolution))


def _lookup(grid: NDArray[np.bool_], resolution: float, points: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Values of the cells that hold the points ``(n, 2)``; False outside."""
    col, row = np.floor(points / resolution).astype(int).T
    inside = (row >= 0) & (col >= 0) & (row < grid.shape[0]) & (col < grid.shape[1])
    values = np.zeros(len(points), dtype=np.bool_)
    values[inside] = grid[row[inside], col[inside]]
    return values

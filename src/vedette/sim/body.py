"""The simulated robots' bodies: discs that follow paths and touch neither walls nor each other."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from vedette.kernels import motion
from vedette.team import PlatformSpec

GUARD_OF_ROOM = 0.5  # of the room that a path has is kept to walls, the rest is for driving beside it
SENSING_RANGE = 3.0  # within which a robot feels other bodies' places and velocities [m]
CLEARANCE_RANGE = 0.5  # beyond a disc's rim, farther walls and discs are not measured [m]
ARRIVAL = 0.15  # from the path's end: there [m]
ARRIVAL_OF_RANGE = 0.1  # nearer for a lidar that sees less far, so much of its range ...
ARRIVAL_TIME = 0.12  # ... but no nearer than the robot drives in this time: steering is no finer [s]
ARRIVAL_IF_TAKEN = 0.6  # the same where another robot stands on the path's end [m]
FACING = 1e-6  # from the heading it was told to turn to: it faces there [rad]
PROGRESS = 0.1  # less path than this done is no progress [m]
SAME_GOAL = 0.3  # a new path that ends this near to the old one has the same goal [m]
COURTESY_TO_LATER = 0.1  # the gap one would rather keep to a robot of higher index [m]
COURTESY_TO_EARLIER = 0.3  # the same for a robot of lower index, which goes first [m]


@dataclass
class _Task:
    """A path being followed, and how far."""

    xy: NDArray[np.float64]  # (L, 2) [m], L >= 2
    arc: NDArray[np.float64]  # (L,) arc length [m]
    traversable: NDArray[np.bool_]  # (r, c) shared with the robot's own map
    first: tuple[int, int]  # row and column of the grid where that begins
    guard: float  # least clearance to walls [m]
    facing: float | None  # heading to turn to at the end [rad]
    done: float = 0.0  # arc length reached [m]
    offset: float = 0.0  # sideways offset being followed [m]
    turning: float = 0.0  # turn rate of a robot that turns on the spot [rad/s]
    best_left: float = np.inf  # remaining length at the last progress [m]
    idle: float = 0.0  # time since then [s]

    @property
    def left(self) -> float:
        """Remaining arc length [m]."""
        return float(self.arc[-1]) - self.done


@dataclass
class Bodies:
    """True motion of n disc robots; positions in metres from the grid's lower-left corner.

    Robots sense each other's place and velocity within 3 m, and walls close to their body, as a ring of
    proximity sensors would; for the rest they rely on the map that comes with each command.
    """

    solid: NDArray[np.bool_]  # (R, C) true walls
    resolution: float  # [m]
    specs: Sequence[PlatformSpec]
    poses: NDArray[np.float64]  # (n, 3) x, y [m], heading [rad]
    velocities: NDArray[np.float64] = field(init=False)  # (n, 2) vx, vy [m/s]
    travelled: NDArray[np.float64] = field(init=False)  # (n,) [m]
    alive: NDArray[np.bool_] = field(init=False)  # (n,)
    radii: NDArray[np.float64] = field(init=False)  # (n,) [m]
    collisions: NDArray[np.int64] = field(init=False)  # (n,) steps in which a contact stopped each robot
    min_clearance: NDArray[np.float64] = field(init=False)  # (n,) to walls and other discs so far [m]
    _tasks: list[_Task | None] = field(init=False)

    def __post_init__(self) -> None:
        n = len(self.specs)
        self.solid = np.ascontiguousarray(self.solid, dtype=np.bool_)
        self.poses = np.array(self.poses, dtype=np.float64).reshape(n, 3)
        self.velocities = np.zeros((n, 2))
        self.travelled = np.zeros(n)
        self.alive = np.ones(n, dtype=np.bool_)
        self.collisions = np.zeros(n, dtype=np.int64)
        self.min_clearance = np.full(n, CLEARANCE_RANGE)
        self._tasks = [None] * n
        self.radii = np.array([spec.radius for spec in self.specs])
        index = np.arange(n)
        earlier = index[None, :] < index[:, None]
        self._courtesy = np.where(earlier, COURTESY_TO_EARLIER, COURTESY_TO_LATER)

    def command(
        self,
        i: int,
        path: NDArray[np.float64] | None,
        traversable: NDArray[np.bool_] | None = None,
        first: tuple[int, int] = (0, 0),
        room: float = np.inf,
        facing: float | None = None,
    ) -> None:
        """Let robot ``i`` follow the polyline ``path`` ``(L, 2)`` [m]; None: stand still.

        ``traversable`` ``(r, c)``: cells where robot ``i``'s own map allows its centre, from row and column
        ``first`` on; held by reference, so that later changes count; None: every cell that is not solid.
        ``room`` [m]: that the path keeps to what is not known free; a robot keeps at least half of it to
        walls, of 5 cm and more 2.5 cm. ``facing``: heading [rad] to turn to on the spot at the end; None:
        any.
        """
        if path is None or not self.alive[i]:
            self._tasks[i] = None
            return
        xy = _without_repeats(np.asarray(path, dtype=np.float64).reshape(-1, 2), self.poses[i, :2])
        arc = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(xy, axis=0).T))))
        allowed = ~self.solid if traversable is None else traversable
        guard = min(motion.WALL_GUARD, GUARD_OF_ROOM * room)
        task = _Task(xy, arc, allowed, first, guard, facing, best_left=float(arc[-1]))
        old = self._tasks[i]
        if old is not None and np.hypot(*(old.xy[-1] - xy[-1])) < SAME_GOAL:
            task.idle, task.offset, task.turning = old.idle, old.offset, old.turning
        self._tasks[i] = task

    def step(self, dt: float) -> None:
        """Move every living robot, in index order, for ``dt`` seconds."""
        for i in range(len(self.specs)):
            if self.alive[i]:
                self._move(i, dt)

    def arrived(self, i: int) -> bool:
        """Tell whether robot ``i`` faces as told at its path's end, or near it while another stands there.

        A robot that was told to stand still has arrived.
        """
        task = self._tasks[i]
        return task is None or (self._at_end(i, task) and abs(self._askew(i, task)) < FACING)

    def _askew(self, i: int, task: _Task) -> float:
        """How far robot ``i`` has still to turn to face as told [rad]."""
        turn = 0.0 if task.facing is None else task.facing - float(self.poses[i, 2])
        return math.remainder(turn, math.tau)

    def _at_end(self, i: int, task: _Task) -> bool:
        end = task.xy[-1]
        x, y, _ = self.poses[i].tolist()
        away = math.hypot(x - end[0], y - end[1])
        spec = self.specs[i]
        near = min(ARRIVAL, max(ARRIVAL_OF_RANGE * spec.range, ARRIVAL_TIME * spec.speed))
        if away > ARRIVAL_IF_TAKEN or away <= near:
            return away <= near
        others = np.hypot(*(self.poses[:, :2] - end).T) < self.radii + self.specs[i].radius
        others[i] = False
        return bool(others.any())

    def stuck_for(self, i: int) -> float:
        """Time [s] since robot ``i`` last got 0.1 m nearer, along its path, to its path's end."""
        task = self._tasks[i]
        return 0.0 if task is None or self.arrived(i) else task.idle

    def kill(self, i: int) -> None:
        """Stop robot ``i``; its body stays as an obstacle."""
        self.alive[i] = False
        self.velocities[i] = 0.0
        self._tasks[i] = None

    def _move(self, i: int, dt: float) -> None:
        task, spec = self._tasks[i], self.specs[i]
        if task is None:
            self.velocities[i] = 0.0
            return
        if task.facing is not None and self._at_end(i, task):
            self._turn(i, task, dt)
            return
        x, y, heading = self.poses[i].tolist()
        limits = motion.Limits(spec.radius, spec.speed, spec.turn_rate, dt, task.guard)
        chosen = motion.steer(
            self.solid,
            task.traversable,
            task.first,
            self.resolution,
            (x, y, heading),
            task.xy,
            task.arc,
            (task.done, task.offset, task.turning),
            self._sensed(i),
            limits,
        )
        task.done, task.offset = chosen.arc, chosen.offset
        task.turning = 0.0 if chosen.speed > 0.0 else chosen.turn
        if task.left < task.best_left - PROGRESS:
            task.best_left, task.idle = task.left, 0.0
        else:
            task.idle += dt
        middle = heading + 0.5 * chosen.turn * dt
        vx, vy = chosen.speed * math.cos(middle), chosen.speed * math.sin(middle)
        if not self._admit(i, x + vx * dt, y + vy * dt):
            vx = vy = 0.0
        self.velocities[i] = vx, vy
        self.poses[i] = x + vx * dt, y + vy * dt, heading + chosen.turn * dt
        self.travelled[i] += math.hypot(vx, vy) * dt

    def _turn(self, i: int, task: _Task, dt: float) -> None:
        """Turn on the spot to face as told; nothing can be in a disc's way."""
        most = self.specs[i].turn_rate * dt
        self.velocities[i] = 0.0
        self.poses[i, 2] += min(max(self._askew(i, task), -most), most)
        task.idle = 0.0

    def _sensed(self, i: int) -> NDArray[np.float64]:
        """Rows ``x, y, vx, vy, radius, courtesy`` of the other bodies within 3 m of robot ``i``."""
        away = self.poses[:, :2] - self.poses[i, :2]
        near = (away * away).sum(axis=1) < SENSING_RANGE**2
        near[i] = False
        rows = np.empty((int(near.sum()), 6))
        rows[:, :2], rows[:, 2:4] = self.poses[near, :2], self.velocities[near]
        rows[:, 4], rows[:, 5] = self.radii[near], self._courtesy[i, near]
        return rows

    def _admit(self, i: int, x: float, y: float) -> bool:
        """Physics: record the clearance at a new place, and refuse the place on contact."""
        reach = self.radii[i] + CLEARANCE_RANGE
        gap = motion.clearance(self.solid, self.resolution, x, y, reach) - self.radii[i]
        apart = np.hypot(self.poses[:, 0] - x, self.poses[:, 1] - y) - self.radii - self.radii[i]
        apart[i] = np.inf
        gap = min(gap, float(apart.min()))
        if gap < 0.0:
            self.collisions[i] += 1
            return False
        self.min_clearance[i] = min(self.min_clearance[i], gap)
        return True


def _without_repeats(xy: NDArray[np.float64], here: NDArray[np.float64]) -> NDArray[np.float64]:
    """Drop consecutive equal points; a path of a single point starts ``here``."""
    if len(xy) == 1 or float(np.abs(xy - xy[0]).max()) < 1e-6:
        start = here if np.hypot(*(here - xy[0])) > 1e-6 else xy[0] - (1e-3, 0.0)
        return np.ascontiguousarray(np.vstack((start, xy[0])))
    keep = np.concatenate(([True], np.hypot(*np.diff(xy, axis=0).T) > 1e-9))
    return np.ascontiguousarray(xy[keep])

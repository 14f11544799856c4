"""Traffic: robots with the local planner and right of way exchange places through doors and corridors."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import pytest
from numpy.typing import NDArray

from vedette.agent.rightofway import Intent, block_discs, give_way
from vedette.kernels.distance import distance_field, path_to, shortcut
from vedette.sim.body import Bodies
from vedette.team import PlatformSpec

RESOLUTION = 0.1
DT = 0.1
EMPTY = np.empty((0, 2))


def inflated(solid: NDArray[np.bool_], radius: float = 0.2) -> NDArray[np.bool_]:
    """Cells whose centre is at least ``radius`` from every solid square; brute force."""
    reach = int(np.ceil(radius / RESOLUTION)) + 1
    padded = np.pad(solid, reach, constant_values=True)
    free = np.ones_like(solid)
    rows, cols = solid.shape
    for dr in range(-reach, reach + 1):
        for dc in range(-reach, reach + 1):
            gap = np.hypot(max(abs(dr) - 0.5, 0), max(abs(dc) - 0.5, 0)) * RESOLUTION
            if gap < radius - 1e-9:
                free &= ~padded[reach + dr : reach + dr + rows, reach + dc : reach + dc + cols]
    return free


def box(width: float, height: float) -> NDArray[np.bool_]:
    solid = np.zeros((round(height * 10), round(width * 10)), dtype=np.bool_)
    solid[[0, -1]] = solid[:, [0, -1]] = True
    return solid


def two_rooms() -> NDArray[np.bool_]:
    """9 x 6 m, a wall in the middle with a 0.9 m door."""
    solid = box(9, 6)
    solid[:, 44:46] = True
    solid[26:35, 44:46] = False
    return solid


def corridor(width: float = 1.2) -> NDArray[np.bool_]:
    """10 m of corridor between two rooms of 3 x 4 m."""
    solid = box(16, 4)
    half = round(width * 5)
    solid[:, 30:130] = True
    solid[20 - half : 20 + half, 30:130] = False
    return solid


def t_junction() -> NDArray[np.bool_]:
    """A 1.2 m corridor 10 m long with another one from its middle, 5 m long."""
    solid = np.ones((80, 120), dtype=np.bool_)
    solid[56:68, 10:110] = False
    solid[10:56, 54:66] = False
    return solid


def four_rooms() -> NDArray[np.bool_]:
    """10 x 10 m, a cross of walls with a 0.9 m door in each arm."""
    solid = box(10, 10)
    solid[:, 49:51] = solid[49:51, :] = True
    for low in (20, 70):
        solid[low : low + 9, 49:51] = solid[49:51, low : low + 9] = False
    return solid


@dataclass
class Traffic:
    """Robots that drive to their goals, each planning on the true map."""

    solid: NDArray[np.bool_]
    starts: list[tuple[float, float]]
    headings: float = 0.0
    trail: list[NDArray[np.float64]] = field(default_factory=list)

    def __post_init__(self) -> None:
        poses = np.array([(x, y, self.headings) for x, y in self.starts])
        self.n = len(poses)
        self.bodies = Bodies(self.solid, RESOLUTION, [PlatformSpec()] * self.n, poses)
        self.open = inflated(self.solid)
        self.time = 0.0
        self.goals: list[tuple[float, float] | None] = [None] * self.n
        self.fields: list[NDArray[np.float32] | None] = [None] * self.n
        self.paths: list[NDArray[np.float64]] = [EMPTY] * self.n
        self.making_room = [False] * self.n
        self.yields = np.zeros(self.n)

    def cell(self, x: float, y: float) -> int:
        return int(y / RESOLUTION) * self.open.shape[1] + int(x / RESOLUTION)

    def send(self, i: int, goal: tuple[float, float]) -> float:
        """Give robot ``i`` a goal; return the length of the unobstructed way [m]."""
        self.goals[i] = goal
        self.fields[i] = distance_field(self.open, self.cell(*goal), RESOLUTION, None)
        x, y, _ = self.bodies.poses[i]
        self.plan(i)
        return float(self.fields[i].flat[self.cell(x, y)])

    def route(self, i: int, open_: NDArray[np.bool_], to_goal: NDArray[np.float32]) -> NDArray[np.float64]:
        x, y, _ = self.bodies.poses[i]
        cells = shortcut(open_, path_to(to_goal, open_, self.cell(x, y)))[::-1]
        if len(cells) == 0:
            return EMPTY
        row, col = np.divmod(cells, open_.shape[1])
        path = (np.column_stack((col, row)) + 0.5) * RESOLUTION
        path[0] = (x, y)
        return path

    def intent(self, i: int, path: NDArray[np.float64]) -> Intent:
        x, y, _ = self.bodies.poses[i]
        return Intent(i, x, y, ahead(path, x, y), slowed=self.bodies.stuck_for(i))

    def plan(self, i: int) -> None:
        """One decision of robot ``i``'s agent: make room, or go on."""
        path = EMPTY
        if self.goals[i] is not None:
            path = self.route(i, self.open, self.fields[i])
            if self.bodies.stuck_for(i) > 4.0:
                path = self.detour(i, path)
        others = [self.intent(j, self.paths[j]) for j in range(self.n) if j != i and self.bodies.alive[j]]
        refuge = give_way(self.open, RESOLUTION, self.intent(i, path), others)
        self.making_room[i] = refuge is not None
        self.yields[i] += refuge is not None
        self.paths[i] = path if refuge is None else refuge
        if len(self.paths[i]) == 0:
            self.bodies.command(i, None)
        else:
            self.bodies.command(i, self.paths[i], self.open)

    def detour(self, i: int, path: NDArray[np.float64]) -> NDArray[np.float64]:
        """A way around robots that stand near, if there is one."""
        x, y, _ = self.bodies.poses[i]
        discs = [
            (*self.bodies.poses[j, :2], 0.5)
            for j in range(self.n)
            if j != i
            and not self.bodies.velocities[j].any()
            and np.hypot(*(self.bodies.poses[j, :2] - (x, y))) < 2.0
        ]
        free = block_discs(self.open, RESOLUTION, discs)
        to_goal = distance_field(free, self.cell(*self.goals[i]), RESOLUTION, None)
        around = self.route(i, free, to_goal)
        return path if len(around) == 0 else around

    def tick(self) -> None:
        count = round(self.time / DT)
        for i in range(self.n):
            if self.bodies.alive[i] and (count + 2 * i) % 5 == 0:
                self.plan(i)
        self.bodies.step(DT)
        self.time += DT
        self.trail.append(self.bodies.poses.copy())
        for i, goal in enumerate(self.goals):
            if goal is not None and not self.making_room[i] and self.bodies.arrived(i):
                self.goals[i] = None

    def drive(self, goals: dict[int, tuple[float, float]], limit: float) -> tuple[dict[int, float], dict[int, float]]:
        """Send robots and wait for all; return each one's time and unobstructed time [s]."""
        ideal = {i: self.send(i, goal) / 0.5 for i, goal in goals.items()}
        times: dict[int, float] = {}
        while len(times) < len(goals) and self.time < limit:
            self.tick()
            for i in goals:
                if self.goals[i] is None:
                    times.setdefault(i, self.time)
        return times, ideal


def ahead(path: NDArray[np.float64], x: float, y: float, reach: float = 3.0) -> NDArray[np.float64]:
    """The next ``reach`` metres of a path, from the point on it nearest to the robot."""
    if len(path) < 2:
        return path[:0]
    arc = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(path, axis=0).T))))
    samples = np.arange(0.0, arc[-1] + 0.05, 0.05)
    points = np.column_stack([np.interp(samples, arc, path[:, k]) for k in (0, 1)])
    start = int(np.argmin(np.hypot(*(points - (x, y)).T)))
    rest = points[start : start + round(reach / 0.05) : 4]
    return np.vstack(((x, y), rest, points[min(start + round(reach / 0.05), len(points) - 1)]))

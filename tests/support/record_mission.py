"""A pretended mission for the tests of the record: robots that wander from frontier to frontier."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Sequence
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from vedette.maps import FREE, OCCUPIED, UNKNOWN, GridFrame
from vedette.record.explore.log import ExploreLog, ExploreScene, ExploreSnapshot, RobotSample
from vedette.record.links import Link
from vedette.record.log import Sink
from vedette.team import PlatformSpec

Point = tuple[float, float]
_COARSE = 4  # cells of the way finder, a side


def rooms(rows: int, cols: int, pitch: int = 40) -> NDArray[np.bool_]:
    """Return solid cells of a building of square rooms with a door in every inner wall."""
    solid = np.zeros((rows, cols), bool)
    solid[::pitch], solid[:, ::pitch] = True, True
    for row in range(pitch // 2, rows, pitch):
        solid[row - 6 : row + 6, pitch:-pitch:pitch] = False
    for col in range(pitch // 2, cols, pitch):
        solid[pitch:-pitch:pitch, col - 6 : col + 6] = False
    solid[:2], solid[-2:], solid[:, :2], solid[:, -2:] = True, True, True, True
    return solid


def scan(
    solid: NDArray[np.bool_], frame: GridFrame, x: float, y: float, reach: float = 8.0
) -> NDArray[np.int64]:
    """Return the flat cells that a lidar at ``x, y`` sees, walls included."""
    angle = np.linspace(-np.pi, np.pi, 480, endpoint=False)[:, None]
    ahead = np.arange(0.0, reach, 0.7 * frame.resolution)[None, :]
    row = (
        ((y - frame.origin_y + ahead * np.sin(angle)) / frame.resolution).astype(int).clip(0, frame.rows - 1)
    )
    col = (
        ((x - frame.origin_x + ahead * np.cos(angle)) / frame.resolution).astype(int).clip(0, frame.cols - 1)
    )
    hit = solid[row, col]
    seen = np.cumsum(hit, axis=1) - hit == 0
    return np.unique((row * frame.cols + col)[seen])


def mission(
    solid: NDArray[np.bool_],
    specs: Sequence[PlatformSpec],
    rng: np.random.Generator,
    start: Point,
    resolution: float = 0.1,
    origin: Point = (0.0, 0.0),
    period: float = 1.0,
    limit: float = 200.0,
    kill: tuple[int, float] | None = None,
    radio: float | None = None,
) -> Iterator[ExploreSnapshot]:
    """Yield a snapshot every ``period`` seconds until all is seen; robot ``kill[0]`` dies at ``kill[1]``.

    ``radio``: robots within so many metres are linked; None: the network is ideal.
    """
    frame, planning = frames(solid, resolution, origin)
    classes = np.zeros(solid.shape, np.uint8)
    truth = np.where(solid, OCCUPIED, FREE).astype(np.uint8)
    ways = np.asarray(~_blocks(solid, _COARSE).any(axis=(1, 3)))
    at = [(start[0] + 0.7 * i, start[1], 0.0) for i in range(len(specs))]
    plans: list[list[Point]] = [[] for _ in specs]
    reachable = len(_fill(ways, _coarse_cell(at[0], frame))) * _COARSE**2
    driven = [0.0] * len(specs)
    t = 0.0
    while True:
        dead = {kill[0]} if kill and t >= kill[1] else set()
        for i, (x, y, _) in enumerate(at):
            if i not in dead:
                cells = scan(solid, frame, x, y, specs[i].range)
                classes.reshape(-1)[cells] = truth.reshape(-1)[cells]
        known = classes != UNKNOWN
        for i in range(len(specs)):
            if not plans[i] and i not in dead:
                plans[i] = _plan(ways, known, at[i], frame, rng)
        coverage = min(1.0, float((classes == FREE).sum()) / reachable)
        over = not any(plans)
        impact = _impact(frame, planning, [] if over else [p[-1] for p in plans if p], classes)
        robots = tuple(
            RobotSample(
                *at[i],
                state="dead" if i in dead else "driving" if plans[i] else "done",
                alive=i not in dead,
                path=np.array([at[i][:2], *plans[i]]) if plans[i] and i not in dead else np.empty((0, 2)),
                name=spec.name,
                goal=plans[i][-1] if plans[i] and i not in dead else None,
                driven=driven[i],
            )
            for i, spec in enumerate(specs)
        )
        entropy = float((~known).sum() * np.log(2.0))
        links = None if radio is None else tuple(linked(robots, radio))
        yield ExploreSnapshot(t, robots, coverage, float(known.mean()), entropy, classes, impact, links)
        if over or t >= limit:
            return
        t += period
        for i, spec in enumerate(specs):
            if i not in dead:
                came, at[i] = at[i], _drive(at[i], plans[i], spec.speed * period)
                driven[i] += float(np.hypot(at[i][0] - came[0], at[i][1] - came[1]))


def scene(name: str, frame: GridFrame, planning: GridFrame, robots: Sequence[str]) -> ExploreScene:
    """Return what stays the same all through a mission."""
    return ExploreScene(name=name, vehicles=tuple(robots), frame=frame, planning=planning)


def recorded(
    solid: NDArray[np.bool_],
    robots: int,
    seed: int,
    start: Point,
    sinks: Sequence[Sink[ExploreSnapshot]] = (),
    resolution: float = 0.1,
    origin: Point = (0.0, 0.0),
    kill: tuple[int, float] | None = None,
    limit: float = 200.0,
    period: float = 1.0,
    reach: float = 8.0,
    radio: float | None = None,
) -> ExploreLog:
    """Return the log of a pretended mission."""
    specs = [PlatformSpec(name=f"robot-{i + 1}", range=reach) for i in range(robots)]
    log = ExploreLog(scene("rooms", *frames(solid, resolution, origin), [spec.name for spec in specs]), sinks)
    rng = np.random.default_rng(seed)
    for snapshot in mission(solid, specs, rng, start, resolution, origin, period, limit, kill, radio):
        log.add(snapshot)
    return log


def linked(robots: Sequence[RobotSample], radio: float) -> Iterator[Link]:
    """Yield the links of living robots within ``radio`` [m]; the shortest ones make the trees."""
    living = [i for i, robot in enumerate(robots) if robot.alive]
    part = dict(zip(living, living, strict=True))
    pairs = [
        (float(np.hypot(robots[a].x - robots[b].x, robots[a].y - robots[b].y)), a, b)
        for a, b in combinations(living, 2)
    ]
    for distance, a, b in sorted(pair for pair in pairs if pair[0] <= radio):
        yield Link(a, b, part[a] != part[b], loss=(distance / radio) ** 2)
        joined = part[b]
        part.update({i: part[a] for i in living if part[i] == joined})


def frames(solid: NDArray[np.bool_], resolution: float, origin: Point) -> tuple[GridFrame, GridFrame]:
    """Return the map's frame and the planning frame of cells twice as large."""
    frame = GridFrame(resolution, solid.shape[0], solid.shape[1], origin[0], origin[1])
    return frame, frame.coarse(2)


def _blocks(grid: NDArray[np.bool_], side: int) -> NDArray[np.bool_]:
    rows, cols = grid.shape[0] // side, grid.shape[1] // side
    return grid[: rows * side, : cols * side].reshape(rows, side, cols, side)


def _coarse_cell(at: Sequence[float], frame: GridFrame) -> tuple[int, int]:
    row, col = frame.cell(at[0], at[1])
    return row // _COARSE, col // _COARSE


def _fill(ways: NDArray[np.bool_], source: tuple[int, int]) -> dict[tuple[int, int], tuple[int, int] | None]:
    """Return the cells that can be reached, each with the cell before it."""
    before: dict[tuple[int, int], tuple[int, int] | None] = {source: None}
    queue = deque([source])
    while queue:
        row, col = queue.popleft()
        for cell in ((row + 1, col), (row - 1, col), (row, col + 1), (row, col - 1)):
            inside = 0 <= cell[0] < ways.shape[0] and 0 <= cell[1] < ways.shape[1]
            if inside and ways[cell] and cell not in before:
                before[cell] = (row, col)
                queue.append(cell)
    return before


def _plan(
    ways: NDArray[np.bool_],
    known: NDArray[np.bool_],
    at: Sequence[float],
    frame: GridFrame,
    rng: np.random.Generator,
) -> list[Point]:
    """Return the way to one of the nearest cells beside the unknown."""
    seen = np.asarray(_blocks(known, _COARSE).all(axis=(1, 3)))
    before = _fill(ways, _coarse_cell(at, frame))
    work = [cell for cell in before if not seen[cell] and before[cell] is not None]
    if not work:
        return []
    cell: tuple[int, int] | None = work[int(rng.integers(min(len(work), 40)))]
    way: list[Point] = []
    while cell is not None:
        side = _COARSE * frame.resolution
        way.append((frame.origin_x + (cell[1] + 0.5) * side, frame.origin_y + (cell[0] + 0.5) * side))
        cell = before[cell]
    return way[-2::-1]


def _drive(at: tuple[float, float, float], plan: list[Point], distance: float) -> tuple[float, float, float]:
    """Move along the plan, using it up."""
    x, y, heading = at
    while plan and distance > 0:
        dx, dy = plan[0][0] - x, plan[0][1] - y
        ahead = float(np.hypot(dx, dy))
        heading = float(np.arctan2(dy, dx))
        step = min(ahead, distance)
        x, y = x + step * np.cos(heading), y + step * np.sin(heading)
        distance -= step
        if step >= ahead - 1e-9:
            plan.pop(0)
    return float(x), float(y), heading


def _impact(
    frame: GridFrame, planning: GridFrame, goals: Sequence[Point], classes: NDArray[np.uint8]
) -> NDArray[np.float32]:
    """Return a bell around every goal: as if the team would see less the farther from it."""
    x, y = planning.centres(np.arange(planning.size)).T
    miss = np.ones(planning.size)
    for goal in goals:
        miss *= 1.0 - np.exp(-(((x - goal[0]) ** 2 + (y - goal[1]) ** 2) / (2 * 2.0**2)))
    return (1.0 - miss).astype(np.float32).reshape(planning.shape)

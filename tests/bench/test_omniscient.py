"""A team that knows the world: its routes see what they are to see, are as long as told, and short."""

from __future__ import annotations

import heapq
import itertools
import math
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from bench import omniscient as bench_omniscient
from bench.omniscient import COMPLETE, EACH, ONE, run_case
from bench.watchman import KnownWorld, plan
from bench.ways import Case, Timed
from vedette.domains.mapping.stops import SURE_CLEARANCE
from vedette.kernels.distance import distance_field
from vedette.kernels.visibility import visible_cells
from vedette.maps import GridFrame
from vedette.maps.world import World, reachable_poses, standable
from vedette.sim.worlds import maze
from vedette.team import PlatformSpec

SPEC = PlatformSpec("robot-1", range=3.0)


def corridor(cells: int) -> World:
    """A straight corridor, 1.6 m wide."""
    solid = np.ones((18, cells), bool)
    solid[1:-1, 1:-1] = False
    return World(GridFrame(0.1, *solid.shape), solid, "corridor")


def team(*places: tuple[float, float]) -> tuple[list[PlatformSpec], np.ndarray]:
    specs = [PlatformSpec(f"robot-{number}", range=SPEC.range) for number in range(1, len(places) + 1)]
    return specs, np.array([(x, y, 0.0) for x, y in places])


def grid_length(open_: np.ndarray, a: int, b: int) -> float:
    """The shortest way over neighbouring cells, with true diagonals and without cutting corners [cells]."""
    cols = open_.shape[1]
    best, todo = {a: 0.0}, [(0.0, a)]
    while todo:
        so_far, cell = heapq.heappop(todo)
        if cell == b:
            return so_far
        row, col = divmod(cell, cols)
        for down, right in itertools.product((-1, 0, 1), repeat=2):
            there = (row + down) * cols + col + right
            if open_[row + down, col + right] and open_[row + down, col] and open_[row, col + right]:
                way = so_far + math.hypot(down, right)
                if way < best.get(there, math.inf):
                    best[there] = way
                    heapq.heappush(todo, (way, there))
    return math.inf


@pytest.fixture(scope="module")
def known() -> KnownWorld:
    world = maze(np.random.default_rng(3), 10.0, 10.0)
    return KnownWorld(world, *team(*[inside(world)] * 2))


def inside(world: World) -> tuple[float, float]:
    free = np.flatnonzero(standable(world, SPEC.radius + SURE_CLEARANCE))
    x, y = world.frame.centres(free[[len(free) // 2]])[0]
    return float(x), float(y)


@pytest.mark.parametrize("share", [0.9, COMPLETE])
def test_routes_see_the_share_that_they_are_planned_for(known: KnownWorld, share: float) -> None:
    routes = plan(known, share, 3, np.random.default_rng(0))
    found = known.seen(routes)
    assert found.mean() >= share
    assert known.known_after(routes, share) <= known.lengths(routes).max() + 1e-9
    assert known.known_after([[], []], share) == math.inf


def test_what_is_seen_lies_in_sight_of_the_way(known: KnownWorld) -> None:
    """By lines of sight between cells, which know no beams: a beam touches what no line to a centre does."""
    routes = plan(known, 0.9, 0, np.random.default_rng(0))
    world, poses = known.world, np.zeros(known.world.frame.shape, bool)
    for robot, route in enumerate(routes):
        nodes = [known.graph.stops + robot, *route]
        for a, b in itertools.pairwise(known.nodes[nodes].tolist()):
            poses |= _between(world, a, b, known.open)
    sure = visible_cells(world.solid, poses, SPEC.range / 0.1)
    counted = np.flatnonzero(known.number >= 0)
    assert np.mean(sure.ravel()[counted][known.seen(routes)]) > 0.97


def _between(world: World, a: int, b: int, open_: np.ndarray) -> np.ndarray:
    """All cells on ways that are hardly longer than the shortest one."""
    there, back = (distance_field(open_, cell, 0.1) for cell in (a, b))
    return np.asarray(there + back <= there.ravel()[b] * 1.03 + 0.1)


def test_lengths_are_those_of_the_shortest_ways_and_no_shorter_than_straight_ones(known: KnownWorld) -> None:
    routes = plan(known, 0.9, 1, np.random.default_rng(0))
    for robot, length in enumerate(known.lengths(routes)):
        nodes = known.nodes[[known.graph.stops + robot, *routes[robot]]].tolist()
        over_cells = [0.1 * grid_length(known.open, a, b) for a, b in itertools.pairwise(nodes)]
        straight = np.hypot(*np.diff(known.world.frame.centres(np.array(nodes)), axis=0).T).sum()
        assert straight - 1e-9 <= length <= sum(over_cells) + 1e-6
        assert length > 0.92 * sum(over_cells)  # what corners of eight directions cost at most is 8 %


def test_a_corridor_is_driven_until_its_end_is_in_sight() -> None:
    world = corridor(200)
    known = KnownWorld(world, *team((0.75, 0.85)))
    (length,) = known.lengths(plan(known, 1.0, 5, np.random.default_rng(0)))
    assert 19.9 - SPEC.range - 0.75 - 0.3 < length < 19.9 - SPEC.range - 0.75 + 0.8


def test_two_robots_part_in_the_middle_of_a_corridor() -> None:
    known = KnownWorld(corridor(200), *team((9.75, 0.85), (10.25, 0.85)))
    one, two = known.lengths(plan(known, 1.0, 5, np.random.default_rng(0)))
    assert one == pytest.approx(two, abs=0.6)
    assert one + two < 20.0 - 2 * SPEC.range


def test_of_a_handful_of_places_the_routes_are_the_best_there_are() -> None:
    world = maze(np.random.default_rng(5), 10.0, 10.0)
    x, y = inside(world)
    rng = np.random.default_rng(1)
    open_ = np.flatnonzero(reachable_poses(world, SPEC.radius + SURE_CLEARANCE, x, y))
    known = KnownWorld(world, *team((x, y), (x, y)), places=rng.choice(open_, 5, replace=False))
    everything = np.zeros(known.cells, bool)
    everything[known.sight.indices] = True
    for share in (0.5 * everything.mean(), everything.mean()):
        best = min(
            known.cost(routes)
            for count in range(6)
            for chosen in itertools.permutations(range(5), count)
            for cut in range(count + 1)
            if known.share(routes := [list(chosen[:cut]), list(chosen[cut:])]) >= share
        )
        found = plan(known, share, 20, np.random.default_rng(0))
        assert known.share(found) >= share
        assert known.cost(found) == pytest.approx(best, rel=0.02)


def test_the_same_seed_gives_the_same_plan(known: KnownWorld) -> None:
    once, again = (plan(known, 0.9, 3, np.random.default_rng(7)) for _ in range(2))
    assert once == again


def test_one_plan_is_told_beside_a_plan_for_each_share(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bench_omniscient, "ROUNDS", 0)
    monkeypatch.setitem(bench_omniscient.GENERATORS, "maze", lambda rng: maze(rng, 10.0, 10.0))
    each, one = (run_case(Case("maze", 2, way, 3), "abc") for way in (EACH, ONE))
    assert each.time_s == one.time_s
    assert each.coverage == one.coverage is not None
    assert one.t90_s is not None
    assert one.t90_s <= one.time_s
    planner = run_case(Case("maze", 2, "nearest", 3), "abc")
    assert planner.outcome == "complete"
    assert planner.time_s > each.time_s


def test_plans_are_compared_with_each_planner(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    ran: list[Case] = []

    def fake(case: Case, commit: str) -> Timed:
        ran.append(case)
        time = 50.0 if case.way in (EACH, ONE) else 100.0
        return Timed(*case.key, "complete", 1.0, time, time, time, 1.0, commit)

    monkeypatch.setattr(bench_omniscient, "run_case", fake)
    for seeds in ("0", "0,1"):
        options = ["--worlds", "cave", "--seeds", seeds, "--jobs", "1", "--out", str(tmp_path)]
        assert CliRunner().invoke(bench_omniscient.omniscient, options).exit_code == 0
    assert len(ran) == len(set(ran)) == 2 * 4
    rows = [
        line.split("|")[3:6]
        for line in (tmp_path / "omniscient.md").read_text().splitlines()
        if " / " in line
    ]
    assert [cell.strip() for cell in rows[0]] == [f"{EACH} / tours", "2", "0.50 (0.50-0.50)"]
    assert len(rows) == 4

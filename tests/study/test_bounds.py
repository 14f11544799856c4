"""What no team can pass: against exact shortest ways, an exhaustive search, and the formulas themselves."""

from __future__ import annotations

import heapq
import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.integrate import trapezoid

from vedette.kernels.visibility import visible_cells
from vedette.maps import GridFrame
from vedette.maps.world import World
from vedette.study.bounds import Limit, distances_to_centres, limit
from vedette.team import PlatformSpec

Point = tuple[float, float]


def world_of(solid: NDArray[np.bool_], resolution: float = 1.0) -> World:
    return World(GridFrame(resolution, *solid.shape), solid, "small")


def free_way(solid: NDArray[np.bool_], a: Point, b: Point) -> bool:
    """Tell whether a segment [cells; x, y] lies in the closed free squares: each piece between grid lines."""
    cuts = {0.0, 1.0}
    for axis in (0, 1):
        if a[axis] != b[axis]:
            low, high = sorted((a[axis], b[axis]))
            lines = range(math.ceil(low), math.floor(high) + 1)
            cuts |= {(line - a[axis]) / (b[axis] - a[axis]) for line in lines}
    parts = sorted(cuts)
    for before, after in itertools.pairwise(parts):
        s = (before + after) / 2
        x, y = a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1])
        near = {
            (row, col)
            for row in (math.ceil(y - 1e-9) - 1, math.floor(y + 1e-9))
            for col in (math.ceil(x - 1e-9) - 1, math.floor(x + 1e-9))
            if 0 <= row < solid.shape[0] and 0 <= col < solid.shape[1]
        }
        if all(solid[cell] for cell in near):
            return False
    return True


def exact_ways(solid: NDArray[np.bool_], start: Point) -> dict[tuple[int, int], float]:
    """Return the shortest ways of a point to the centres of free cells [cells], by the visibility graph."""
    rows, cols = solid.shape
    corners = [(float(x), float(y)) for y in range(rows + 1) for x in range(cols + 1)]
    centres = {(int(r), int(c)): (c + 0.5, r + 0.5) for r, c in np.argwhere(~solid)}
    points = [start, *corners, *centres.values()]
    best = {start: 0.0}
    waiting = [(0.0, start)]
    while waiting:
        length, at = heapq.heappop(waiting)
        if length > best[at]:
            continue
        for to in points:
            longer = length + math.dist(at, to)
            if longer < best.get(to, math.inf) and free_way(solid, at, to):
                best[to] = longer
                heapq.heappush(waiting, (longer, to))
    return {cell: best.get(centre, math.inf) for cell, centre in centres.items()}


@settings(deadline=None, max_examples=25)
@given(st.integers(0, 10**6))
def test_ways_on_the_grid_are_at_most_13_12ths_of_the_shortest(seed: int) -> None:
    rng = np.random.default_rng(seed)
    solid = rng.random((5, 6)) < 0.35
    solid[2, 3] = False
    x, y = 3 + rng.random(), 2 + rng.random()
    found = distances_to_centres(world_of(solid, 0.5), np.array([[0.5 * x, 0.5 * y, 0.0]]))
    for cell, way in exact_ways(solid, (x, y)).items():
        if math.isinf(way):
            assert math.isinf(found[cell])
        else:
            assert 12 / 13 * found[cell] <= 0.5 * (way + math.sqrt(2) / 4) + 1e-5
            assert found[cell] >= 0.5 * (way - math.sqrt(2) / 4) - 1e-5


def least_time(solid: NDArray[np.bool_], start: int, reach: float) -> float:
    """Return the length [cells] of the shortest way over cells' centres that sees all that can be seen."""
    rows, cols = solid.shape
    free = [int(cell) for cell in np.flatnonzero(~solid)]
    sees: dict[int, int] = {}
    for cell in free:
        pose = np.zeros(solid.shape, bool)
        pose.flat[cell] = True
        seen = np.flatnonzero(visible_cells(solid, pose, reach))
        sees[cell] = sum(1 << int(k) for k in seen)
    reachable = {start}
    waiting = [start]
    while waiting:
        at = waiting.pop()
        for to in neighbours(at, rows, cols):
            if to in sees and to not in reachable:
                reachable.add(to)
                waiting.append(to)
    everything = 0
    for cell in reachable:
        everything |= sees[cell]
    queue = [(0.0, start, sees[start])]
    best = {(start, sees[start]): 0.0}
    while queue:
        length, at, seen_so_far = heapq.heappop(queue)
        if seen_so_far == everything:
            return length
        for to in neighbours(at, rows, cols):
            if to in sees:
                state = to, seen_so_far | sees[to]
                if length + 1.0 < best.get(state, math.inf):
                    best[state] = length + 1.0
                    heapq.heappush(queue, (length + 1.0, *state))
    raise AssertionError("unreachable")


def neighbours(cell: int, rows: int, cols: int) -> list[int]:
    row, col = divmod(cell, cols)
    steps = ((0, 1), (0, -1), (1, 0), (-1, 0))
    return [(row + r) * cols + col + c for r, c in steps if 0 <= row + r < rows and 0 <= col + c < cols]


@pytest.mark.parametrize("seed", range(6))
def test_no_search_of_all_ways_is_faster_than_the_bound(seed: int) -> None:
    rng = np.random.default_rng(seed)
    solid = rng.random((4, 10)) < 0.3
    start = int(rng.choice(np.flatnonzero(~solid)))
    row, col = divmod(start, 10)
    spec = PlatformSpec(range=1.5, radius=0.3, speed=2.0)
    bound = limit(world_of(solid), [spec], np.array([[col + 0.5, row + 0.5, 0.0]]))
    assert bound.time() <= least_time(solid, start, 1.5) / 2.0 + 1e-6


def test_in_a_straight_corridor_the_bound_is_the_way_to_its_end() -> None:
    spec = PlatformSpec(range=5.0, speed=0.5)
    bound = limit(world_of(np.zeros((10, 1000), bool), 0.1), [spec], np.array([[0.05, 0.55, 0.0]]))
    least = (99.9 - 5.0) / 0.5
    assert 0.9 * least < bound.time() <= least


def test_the_limits_are_the_formulas() -> None:
    bound = Limit(np.full(400, 3.0), area=1.0, robots=2, speed=0.5, reach=4.0)
    swept = (400 - 2 * math.pi * 16) / (2 * 4 * 0.5 * 2)
    assert bound.time() == pytest.approx(swept)
    assert bound.coverable == 400.0
    far = Limit(np.linspace(0.0, 100.0, 101), area=0.01, robots=2, speed=0.5, reach=4.0)
    assert far.time() == pytest.approx((100.0 - 4.0) / 0.5)
    assert far.time(51 / 101) == pytest.approx((50.0 - 4.0) / 0.5)


@settings(deadline=None, max_examples=40)
@given(
    st.lists(st.floats(0.0, 50.0), min_size=1, max_size=60),
    st.integers(1, 4),
    st.floats(0.1, 2.0),
    st.floats(0.2, 5.0),
    st.floats(0.1, 4.0),
)
def test_times_are_the_inverse_of_coverage_and_the_area_is_its_integral(
    distances: list[float], robots: int, speed: float, reach: float, area: float
) -> None:
    bound = Limit(np.sort(np.array(distances)), area, robots, speed, reach)
    for share in (0.3, 0.9, 1.0):
        time = bound.time(share)
        known = math.floor(len(distances) * float(bound.coverage(np.array([time + 1e-9]))[0]) + 1e-6)
        assert known >= math.ceil(share * len(distances) - 1e-9)
        if time > 0.01:
            before = math.floor(len(distances) * float(bound.coverage(np.array([time - 0.005]))[0]) + 1e-9)
            assert before < math.ceil(share * len(distances) - 1e-9)
    times = np.linspace(0.0, bound.time() + 1e-6, 20_001)
    whole = np.floor(len(distances) * bound.coverage(times) + 1e-9) / len(distances)  # in whole cells
    assert bound.auc() == pytest.approx(float(trapezoid(1.0 - whole, times)), abs=1e-3 * (1 + times[-1]))


def test_where_nothing_can_be_seen_nothing_takes_time() -> None:
    bound = Limit(np.empty(0), 1.0, 1, 1.0, 1.0)
    assert bound.time() == bound.auc() == 0.0
    assert bound.coverage(np.array([0.0, 1.0])).tolist() == [1.0, 1.0]


def test_more_robots_apart_never_raise_the_bound() -> None:
    world = world_of(np.zeros((100, 300), bool), 0.1)
    spec = PlatformSpec(range=2.0)
    places = np.array([[1.0, 5.0, 0.0], [29.0, 5.0, 0.0], [15.0, 5.0, 0.0]])
    times = [limit(world, [spec] * n, places[:n]).time() for n in (1, 2, 3)]
    assert times[0] > times[1] > times[2]

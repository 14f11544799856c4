"""Coverage kernels against dense arrays, crossing intervals and all orders of all stops."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from vedette.domains.mapping import layers
from vedette.kernels import coverage
from vedette.kernels.coverage import LAYERS, CellWeights, Footprints, TourProblem
from vedette.kernels.distance import distance_field
from vedette.kernels.frontier import find_frontiers
from vedette.kernels.reference import coverage as reference
from vedette.kernels.reference.coverage import Sparse
from vedette.kernels.reference.tours import EagerTours
from vedette.maps import FREE, OCCUPIED, UNKNOWN

seeds = st.integers(0, 2**32 - 1)
CELLS = 30
ENDLESS = 2**63
END_PRICES = [(0.0, 0.0), (0.02, 0.0), (0.5, 0.001), (0.0, 0.05)]


def random_map(rng: np.random.Generator) -> NDArray[np.uint8]:
    """Unknown cells and obstacles anywhere among free ones, or beside a wide free space."""
    rows, cols = rng.integers(4, 26, 2)
    if rng.random() < 0.4:
        wide = np.zeros((rows + 14, cols + 14), np.uint8)
        wide[rng.integers(8) : -rng.integers(1, 8), rng.integers(8) : -rng.integers(1, 8)] = 1
        wide[tuple(rng.integers(0, wide.shape[axis], 3) for axis in (0, 1))] = 2
        return wide
    classes = (rng.random((rows, cols)) < rng.uniform(0.2, 0.95)).astype(np.uint8)
    classes[rng.random(classes.shape) < rng.uniform(0, 0.3)] = 2
    return classes


def porous_map(rng: np.random.Generator) -> NDArray[np.uint8]:
    """Free and unknown space behind walls with many holes, and speckle anywhere."""
    rows, cols = rng.integers(20, 45, 2)
    classes = np.full((rows, cols), FREE, np.uint8)
    classes[:, : rng.integers(1, cols)] = rng.choice([FREE, UNKNOWN])
    for _ in range(rng.integers(1, 5)):
        classes[rng.integers(rows)] = OCCUPIED
        classes[:, rng.integers(cols)] = OCCUPIED
    classes[rng.random(classes.shape) < rng.choice([0.05, 0.2])] = FREE
    classes[rng.random(classes.shape) < rng.choice([0.0, 0.05])] = rng.choice([UNKNOWN, OCCUPIED])
    return classes


def random_impact(rng: np.random.Generator) -> Sparse:
    keys = np.flatnonzero(rng.random(CELLS * LAYERS) < rng.choice([0.0, 0.02, 0.3]))
    misses = rng.choice([1, 2, 9, 64, 200, 255], len(keys))
    return keys.astype(np.uint32), misses.astype(np.uint8)


def random_worth(rng: np.random.Generator) -> CellWeights:
    """Draw the worth of cells in a window of the grid, of which a fifth are worth nothing."""
    rows = int(rng.choice([d for d in range(1, CELLS + 1) if CELLS % d == 0]))
    shape = rows, CELLS // rows
    low = [int(rng.integers(0, size)) for size in shape]
    size = [int(rng.integers(1, most - first + 1)) for most, first in zip(shape, low, strict=True)]
    window = np.where(rng.random(size) < 0.2, 0.0, rng.uniform(0, 3, size)).astype(np.float32)
    inside, last_col, last_row, corner = rng.uniform(0, 3, 4).tolist()
    return CellWeights(window, (low[0], low[1]), shape, (inside, last_col, last_row, corner))


def random_problem(rng: np.random.Generator, most_stops: int) -> TourProblem:
    """Draw stops in a plane with overlapping footprints, and legs up to a fifth shorter than first legs."""
    stops = int(rng.integers(1, most_stops + 1))
    rows = [np.flatnonzero(rng.random(CELLS) < rng.uniform(0.05, 0.5)) for _ in range(stops)]
    starts = np.cumsum([0, *map(len, rows)])
    misses = rng.choice([2, 5, 11, 33, 64, 255], starts[-1]).astype(np.uint8)
    places = rng.uniform(-40, 40, (stops, 2))
    first_leg = np.hypot(*places.T).astype(np.float32)
    legs = np.hypot(*(places[:, None] - places).T) * rng.uniform(0.8, 1.0)
    unreachable = rng.random(stops) < 0.1
    first_leg[unreachable] = np.inf
    legs[:, unreachable] = np.inf
    worth = [layers.rate(start=rng.uniform(1, 200)), layers.rate(), layers.plain()][rng.integers(3)]
    return TourProblem(
        CellWeights.whole(
            np.where(rng.random(CELLS) < 0.2, 0.0, rng.uniform(0, 3, CELLS)).astype(np.float32)
        ),
        worth.weights,
        worth.edges,
        random_impact(rng),
        Footprints(starts, np.concatenate(rows).astype(np.uint32), misses),
        first_leg,
        np.ascontiguousarray(legs, np.float32),
    )


def reply(problem: TourProblem, current: list[int], max_stops: int) -> tuple[list[int], float, float]:
    tour, gain, present = coverage.best_tour(problem, np.array(current, np.int64), max_stops)
    return tour.tolist(), gain, present


def random_tour(problem: TourProblem, rng: np.random.Generator, max_stops: int) -> list[int]:
    reachable = np.flatnonzero(np.isfinite(problem.first_leg))
    return [int(stop) for stop in rng.permutation(reachable)[: rng.integers(0, max_stops + 1)]]


Scene = tuple[NDArray[np.float32], int, NDArray[np.uint8], NDArray[np.int64], NDArray[np.int64], int]


def random_scene(rng: np.random.Generator) -> Scene:
    """Draw a map and its frontiers, a reach, a place and a field of ways [m] from there to some cells."""
    porous = rng.random() < 0.3
    classes = porous_map(rng) if porous else random_map(rng)
    share = rng.choice([0.001, 0.01] if porous else [0.1, 0.5, 1.0])
    stands = (classes == FREE) & (rng.random(classes.shape) < share)
    source = int(rng.integers(classes.size))  # the robot's own place may not be free
    stands.flat[source] = True
    way = distance_field(np.ones(classes.shape, bool), source, 0.1)
    if rng.random() < 0.5:
        way *= rng.uniform(1.0, 3.0, way.shape).astype(np.float32)  # by detours
    cells, starts = find_frontiers(classes, 1, int(rng.integers(2, 12)))
    reach = int(rng.integers(0, 40 if porous else 9))
    return np.where(stands, way, np.inf).astype(np.float32), source, classes, cells, starts, reach


@settings(deadline=None, max_examples=60)
@given(seeds)
def test_viewpoints_equal_trying_every_reachable_cell(seed: int) -> None:
    rng = np.random.default_rng(seed)
    field, source, classes, cells, starts, reach = random_scene(rng)
    most = int(rng.integers(1, 40))
    found = coverage.viewpoints(field, source, 0.1, classes, cells, starts, reach, most, ENDLESS)
    targets, views = reference.viewpoints(field, classes, cells, starts, reach)
    seen = np.flatnonzero(views >= 0)
    ways = field.ravel()[views[seen]]
    nearest = np.sort(seen[np.argsort(ways, kind="stable")[:most]])
    np.testing.assert_array_equal(found.clusters, nearest)
    np.testing.assert_array_equal(found.targets, targets[nearest])
    np.testing.assert_array_equal(found.views, views[nearest])
    missing = np.setdiff1d(seen, nearest)
    assert np.all(field.ravel()[views[missing]] >= found.horizon)
    assert len(found) == most or found.horizon == np.inf
    assert not found.cut_short


@settings(deadline=None, max_examples=60)
@given(seeds)
def test_viewpoints_within_the_horizon_of_limited_work_are_all_there(seed: int) -> None:
    rng = np.random.default_rng(seed)
    field, source, classes, cells, starts, reach = random_scene(rng)
    whole = coverage.viewpoints(field, source, 0.1, classes, cells, starts, reach, len(cells) + 1, ENDLESS)
    some = coverage.viewpoints(
        field, source, 0.1, classes, cells, starts, reach, int(rng.integers(1, 40)), int(rng.integers(0, 200))
    )
    assert whole.horizon == np.inf
    there = np.isin(whole.clusters, some.clusters)
    np.testing.assert_array_equal(whole.only(there).clusters, some.clusters)
    np.testing.assert_array_equal(whole.only(there).views, some.views)
    missing = field.ravel()[whole.only(~there).views]
    assert np.all(missing >= some.horizon)
    if not some.cut_short:
        assert np.all(missing >= field.ravel()[some.views].max(initial=0.0))


def test_work_that_is_done_leaves_the_farthest_frontiers_out() -> None:
    classes = np.full((9, 400), FREE, np.uint8)
    classes[4, ::9] = UNKNOWN
    field = distance_field(classes == FREE, 0, 0.1)
    cells, starts = find_frontiers(classes, 1, 12)
    scene = field, 0, 0.1, classes, cells, starts, 20
    whole = coverage.viewpoints(*scene, len(starts), ENDLESS)
    assert whole.horizon == np.inf
    assert len(whole) == len(starts) - 1
    nothing = coverage.viewpoints(*scene, len(starts), 0)
    assert len(nothing) == 0
    assert nothing.horizon == 0.0
    assert nothing.cut_short
    few = coverage.viewpoints(*scene, 3, ENDLESS)
    assert few.clusters.tolist() == [0, 1, 2]
    assert 0.0 < few.horizon < np.inf


@settings(deadline=None, max_examples=60)
@given(seeds, st.integers(1, 3), st.integers(0, 6))
def test_berths_equal_their_twin(seed: int, step: int, most: int) -> None:
    classes = random_map(np.random.default_rng(seed))
    berths = coverage.berths(classes, step, most)
    np.testing.assert_array_equal(berths, reference.berths(classes, step, most))


@settings(deadline=None, max_examples=60)
@given(seeds, st.booleans())
def test_footprints_equal_their_twin(seed: int, by_distance: bool) -> None:
    rng = np.random.default_rng(seed)
    classes = random_map(rng)
    views = rng.choice(np.flatnonzero(classes.ravel() != 2), 3)
    table = -np.sort(-rng.random((rng.integers(1, 5), rng.integers(1, 12)))).astype(np.float32)
    table[:, rng.integers(1, 12) :] = 0.0
    berths = coverage.berths(classes, int(rng.integers(1, 3)), int(rng.integers(1, 6)))
    scan = (
        views,
        rng.uniform(-4, 4, 3),
        rng.uniform(0.5, 25),
        rng.choice([0.7, 3.0, math.tau]),
        table,
        by_distance,
        int(rng.integers(16, 160)),
        int(rng.integers(1, 5)),
        np.float32(rng.uniform(0, 0.2)),
    )
    starts, cells, shares = coverage.footprints(classes, berths, *scan)
    twin_starts, twin_cells, twin_shares = reference.footprints(classes, berths, *scan)
    np.testing.assert_array_equal(starts, twin_starts)
    np.testing.assert_array_equal(cells, twin_cells)
    np.testing.assert_allclose(shares, twin_shares, rtol=1e-5)


@settings(deadline=None, max_examples=100)
@given(seeds, st.sampled_from([1, 7, LAYERS]))
def test_combine_equals_a_dictionary_of_saturating_sums(seed: int, layers: int) -> None:
    rng = np.random.default_rng(seed)
    nothing = np.empty(0, np.uint32), np.empty(0, np.uint8)
    a, b = (reference.combine(*random_impact(rng), *nothing, layers) for _ in range(2))
    together = coverage.combine(*a, *b, layers)
    for part, twin in zip(together, reference.combine(*a, *b, layers), strict=True):
        np.testing.assert_array_equal(part, twin, strict=True)
    for whole, alone in zip(coverage.combine(*a, *nothing, layers), a, strict=True):
        np.testing.assert_array_equal(whole, alone, strict=True)


@pytest.mark.parametrize("seed", range(10))
def test_what_follows_certainty_in_a_cell_changes_no_value_and_no_order_of_combining(seed: int) -> None:
    rng = np.random.default_rng(seed)
    nothing = np.empty(0, np.uint32), np.empty(0, np.uint8)
    raw = random_impact(rng)
    cut = reference.combine(*raw, *nothing)
    weights, layers = random_worth(rng), rng.uniform(0, 1, LAYERS)
    assert reference.value(weights, layers, cut) == reference.value(weights, layers, raw)
    a, b = (reference.combine(*random_impact(rng), *nothing) for _ in range(2))
    left = coverage.combine(*coverage.combine(*cut, *a), *b)
    right = coverage.combine(*cut, *coverage.combine(*b, *a))
    assert all(np.array_equal(x, y) for x, y in zip(left, right, strict=True))


@settings(deadline=None, max_examples=60)
@given(seeds)
def test_marginals_equal_differences_of_dense_values(seed: int) -> None:
    rng = np.random.default_rng(seed)
    problem = random_problem(rng, 1)
    own = [random_impact(rng) for _ in range(4)]
    starts = np.cumsum([0, *(len(keys) for keys, _ in own)])
    keys, misses = (np.concatenate(part) for part in zip(*own, strict=True))
    worth = (random_worth(rng), problem.layer_weights)
    gains = coverage.marginals(*worth, problem.others, starts, keys, misses)
    twins = reference.marginals(*worth, problem.others, starts, keys, misses)
    np.testing.assert_allclose(gains, twins, rtol=1e-9, atol=1e-9)


@settings(deadline=None, max_examples=100)
@given(seeds, st.integers(1, 6))
def test_the_gains_that_best_tour_tells_are_the_dense_values_of_its_tours(seed: int, max_stops: int) -> None:
    rng = np.random.default_rng(seed)
    problem = random_problem(rng, 8)
    current = random_tour(problem, rng, max_stops)
    tour, gain, present = reply(problem, current, max_stops)
    assert len(set(tour)) == len(tour) <= max_stops
    assert gain == pytest.approx(reference.tour_gain(problem, tour), rel=1e-4, abs=1e-4)
    assert present == pytest.approx(reference.tour_gain(problem, current), rel=1e-4, abs=1e-4)


@settings(deadline=None, max_examples=100)
@given(seeds, st.integers(1, 6))
def test_best_tour_is_no_worse_than_the_present_tour_and_any_single_stop(seed: int, max_stops: int) -> None:
    rng = np.random.default_rng(seed)
    problem = random_problem(rng, 8)
    _, gain, present = reply(problem, random_tour(problem, rng, max_stops), max_stops)
    singles = [reference.tour_gain(problem, [stop]) for stop in range(len(problem.first_leg))]
    # Ties inside a time layer fall to the shorter tour, by at most 1e-4 of the value.
    assert gain >= max(present, 0.0, *singles) * (1 - 1.1e-4) - 1e-4


def test_best_tour_comes_close_to_the_best_of_all_tours() -> None:
    ratios = []
    for seed in range(60):
        rng = np.random.default_rng(seed)
        problem = random_problem(rng, 5)
        _, gain, _ = reply(problem, [], 4)
        _, optimum = reference.best_tour(problem, 4)
        assert gain <= optimum * (1 + 1e-4) + 1e-4
        ratios.append(gain / optimum if optimum > 1e-3 else 1.0)
    assert np.mean(ratios) >= 0.999
    assert min(ratios) >= 0.97


def test_greedy_insertion_at_exact_prices_seldom_beats_best_tour_and_on_average_they_are_level() -> None:
    ratios = []
    for seed in range(300):
        problem = random_problem(np.random.default_rng(seed), 6)
        _, greedy = reference.greedy_tour(problem, 6)
        gain = reply(problem, [], 6)[1]
        ratios.append(greedy / gain if gain > 1e-3 else 1.0)
    assert np.mean(ratios) == pytest.approx(1.0, abs=1e-3)
    assert max(ratios) <= 1.21
    assert sum(ratio > 1.001 for ratio in ratios) <= 4


@settings(deadline=None, max_examples=100)
@given(seeds, st.integers(1, 4), st.sampled_from(END_PRICES))
def test_a_priced_tour_is_worth_what_it_shows_less_its_price_and_no_single_stop_is_worth_more(
    seed: int, max_stops: int, end_price: tuple[float, float]
) -> None:
    rng = np.random.default_rng(seed)
    problem = dataclasses.replace(random_problem(rng, 6), end_price=end_price)
    reached = np.flatnonzero(np.isfinite(problem.first_leg)).tolist()
    stay = max((float(problem.first_leg[stop]) for stop in reached), default=0.0)

    def net(tour: list[int]) -> float:
        end = float(reference.arrivals(problem, tour)[-1]) if tour else stay
        return reference.tour_gain(problem, tour) - end * (end_price[0] + end_price[1] * end / 2.0)

    tour, gain, _ = reply(problem, [], max_stops)
    assert gain == pytest.approx(net(tour), rel=1e-4, abs=1e-3)
    showing = [stop for stop in reached if reference.tour_gain(problem, [stop]) > 1e-3]
    assert bool(tour) or not showing  # staying never beats a tour that shows something
    assert gain >= max([net([stop]) for stop in showing], default=-np.inf) - 1e-3 * (1.0 + abs(gain))


def test_stops_that_cannot_be_reached_are_never_in_a_tour() -> None:
    for seed in range(40):
        problem = random_problem(np.random.default_rng(seed), 8)
        tour, _, _ = reply(problem, [], 6)
        assert np.isfinite(problem.first_leg[tour]).all()


def test_inside_a_time_layer_the_shorter_tour_wins() -> None:
    edges, weights = np.full(LAYERS, 1e3), np.eye(LAYERS)[-1]
    first_leg, legs = np.array([1, 3], np.float32), np.array([[0, 2], [2, 0]], np.float32)
    footprints = Footprints(np.array([0, 1, 2]), np.array([0, 1], np.uint32), np.array([64, 64], np.uint8))
    nothing = np.empty(0, np.uint32), np.empty(0, np.uint8)
    worth = CellWeights.whole(np.array([1.0, 1.0], np.float32))
    problem = TourProblem(worth, weights, edges, nothing, footprints, first_leg, legs)
    assert reply(problem, [1, 0], 2)[0] == [0, 1]


@settings(deadline=None, max_examples=60)
@given(seeds, st.integers(1, 4))
def test_no_tour_adds_more_than_the_bound_and_the_bound_equals_its_twin(seed: int, max_stops: int) -> None:
    problem = random_problem(np.random.default_rng(seed), 4)
    bound = coverage.most_any_tour_adds(problem, max_stops)
    _, optimum = reference.best_tour(problem, max_stops)
    assert bound >= optimum * (1 - 1e-5) - 1e-5
    assert bound == pytest.approx(reference.most_any_tour_adds(problem, max_stops), rel=1e-4, abs=1e-4)


def test_the_bound_holds_where_going_by_another_stop_is_the_shorter_way() -> None:
    rng = np.random.default_rng(0)
    problem = random_problem(rng, 1)
    first_leg, legs = np.array([4, 11], np.float32), np.array([[0, 1], [1, 0]], np.float32)
    footprints = Footprints(np.array([0, 1, 2]), np.array([0, 1], np.uint32), np.array([1, 255], np.uint8))
    problem = dataclasses.replace(
        problem,
        weights=CellWeights.whole(np.ones(CELLS, np.float32)),
        layer_weights=layers.rate().weights,
        others=(np.empty(0, np.uint32), np.empty(0, np.uint8)),
        footprints=footprints,
        first_leg=first_leg,
        legs=legs,
    )
    straight = sum(reference.tour_gain(problem, [stop]) for stop in (0, 1))
    assert reference.tour_gain(problem, [0, 1]) > straight
    assert coverage.most_any_tour_adds(problem, 2) >= reference.tour_gain(problem, [0, 1])


def test_a_frontier_whose_middle_nobody_can_see_is_seen_by_another_of_its_cells() -> None:
    classes = np.full((30, 60), OCCUPIED, np.uint8)
    classes[15:29, 1:59] = FREE  # a corridor,
    classes[14, 50:54] = FREE  # a door,
    classes[10:14, 10:54] = FREE  # and what was glimpsed through it of a room
    classes[1:10, 10:54] = UNKNOWN
    field = np.full(classes.shape, np.inf, np.float32)
    field[18:26, 1:59] = 1.0  # where the robot can stand
    cells = np.array([10 * 60 + col for col in range(10, 54)], np.int64)
    starts = np.array([0, len(cells)])
    found = coverage.viewpoints(field, 20 * 60 + 5, 0.1, classes, cells, starts, 20, 1, ENDLESS)
    (middle,), (view,) = found.targets, found.views
    assert view >= 0
    assert field.flat[view] == 1.0
    row, col = divmod(int(middle), 60)
    assert row == 10
    assert col > 45  # not the middle, which is behind the wall


@settings(deadline=None, max_examples=150)
@given(
    seeds,
    st.integers(1, 6),
    st.booleans(),
    st.sampled_from([(0.0, 0.0), (0.1, 0.0), (0.0, 0.5)]),
    st.sampled_from(END_PRICES),
)
def test_best_tour_prices_stops_only_where_they_can_matter_and_finds_what_pricing_all_finds(
    seed: int, max_stops: int, alike: bool, turning: tuple[float, float], end_price: tuple[float, float]
) -> None:
    rng = np.random.default_rng(seed)
    problem = random_problem(rng, 8)
    if alike:  # many a stop is worth as much as another, and as near
        misses = np.full_like(problem.footprints.misses, 11)
        marks = dataclasses.replace(problem.footprints, misses=misses)
        whole = CellWeights.whole(np.ones(CELLS, np.float32))
        near = np.where(np.isfinite(problem.first_leg), 2, np.inf).astype(np.float32)
        legs = np.where(np.isfinite(problem.legs), 4, np.inf).astype(np.float32)
        problem = dataclasses.replace(problem, weights=whole, footprints=marks, first_leg=near, legs=legs)
    problem = dataclasses.replace(problem, end_price=end_price)
    current = random_tour(problem, rng, max_stops)
    tour, gain, present = coverage.best_tour(problem, np.array(current, np.int64), max_stops, *turning)
    assert (tour.tolist(), gain, present) == EagerTours(problem, max_stops).best(current, *turning)

"""When a team turns from information to what it left behind, and which frontiers are worth a stop at all."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation

from tests.support.mapping_scenes import CORRIDOR, FRAME, SPEC, explored, placed
from vedette.domains.mapping import layers
from vedette.domains.mapping.baselines.cost_utility import expected_areas
from vedette.domains.mapping.belief import MapBelief, freeze
from vedette.domains.mapping.impact import MIN_SHARE
from vedette.domains.mapping.outlook import (
    RAYS,
    SIGHT,
    known_share,
    mean_promise,
    members_in_the_middle,
    promises,
)
from vedette.domains.mapping.planners import DEFAULT, PLANNERS, planner
from vedette.domains.mapping.platform import LEAST_AREA, LEFT_ALONE, MappingPlatform
from vedette.domains.mapping.price import EndPrice
from vedette.domains.mapping.sightings import empty_counts, measured_model
from vedette.domains.mapping.stops import (
    CLEARANCES,
    CLOSE_VIEW,
    ENOUGH,
    GAP,
    LEAST_SHARE,
    find_stops,
    survey,
)
from vedette.domains.mapping.tour import STAY
from vedette.domains.mapping.views import look
from vedette.kernels.coverage import LAYERS, CellWeights, Footprints, TourProblem, best_tour
from vedette.kernels.frontier import find_frontiers
from vedette.kernels.reference import coverage as reference_coverage
from vedette.kernels.reference.coverage import dense
from vedette.maps import FREE, OCCUPIED, UNKNOWN

ROOMS = [*CORRIDOR, (7.0, 7.1), (0.0, 4.0), (4.0, 4.0), (0.0, 10.0)]


def at_turn(turn: float, classes: NDArray[np.uint8] | None = None) -> MapBelief:
    """Return the belief of a round of a team that turns at this promise [m^2]."""
    return freeze(
        explored(CORRIDOR) if classes is None else classes,
        FRAME,
        reach=SPEC.range,
        extent=2.5,
        hidden=2.0,
        return_price=1.0,
        turn=turn,
        layers=layers.rate(start=5.0),
        counts=empty_counts(),
    )


def promised(belief: MapBelief) -> float:
    """Return what the frontiers of a belief promise on average [m^2]."""
    return mean_promise(of_each(belief), belief.frontier_starts)


def of_each(belief: MapBelief) -> NDArray[np.float64]:
    """Return what each frontier of a belief promises [m^2]."""
    frontiers = belief.frontier_cells, belief.frontier_starts
    about = belief.counts, belief.unknown, belief.factor
    return promises(belief.classes, belief.berths, belief.frame.resolution, frontiers, *about)


def test_the_mean_promise_is_that_of_looks_from_all_frontier_cells_by_the_twin() -> None:
    belief = at_turn(0.0)
    resolution, cols = belief.frame.resolution, belief.frame.cols
    reach = SIGHT / resolution
    table = measured_model(belief.counts, resolution, int(np.ceil(reach)), by_distance=True).table
    total = 0.0
    for low, high in zip(belief.frontier_starts[:-1], belief.frontier_starts[1:], strict=True):
        members = belief.frontier_cells[low:high]
        points = np.column_stack(np.divmod(members, cols))
        away = ((len(members) * points - points.sum(axis=0)) ** 2).sum(axis=1)
        middle = members[np.lexsort((members, away))[:1]]
        look = middle, np.zeros(1), reach, 2.0 * np.pi, table, True, RAYS, belief.factor, MIN_SHARE
        _, cells, shares = reference_coverage.footprints(belief.classes, belief.berths, *look)
        total += len(members) * float((shares * belief.unknown.ravel()[cells]).sum()) * resolution**2
    assert total > 0.0
    assert promised(belief) == pytest.approx(total / len(belief.frontier_cells), rel=1e-4)


def test_frontiers_promise_less_when_only_scraps_are_left() -> None:
    early, late = at_turn(0.0), at_turn(0.0, explored(ROOMS))
    assert promised(late) < promised(early)


def test_a_map_without_frontiers_promises_nothing() -> None:
    known = np.where(explored(ROOMS) == UNKNOWN, OCCUPIED, explored(ROOMS)).astype(np.uint8)
    assert promised(at_turn(0.0, known)) == 0.0
    assert promised(at_turn(0.0, np.zeros(FRAME.shape, np.uint8))) == 0.0


def test_a_team_turns_when_its_frontiers_promise_less() -> None:
    promise = promised(at_turn(0.0))
    assert not at_turn(promise).gathering
    assert at_turn(promise * 1.001).gathering
    assert at_turn(math.inf).gathering
    assert not at_turn(0.0).gathering


def test_the_known_share_is_the_shortest_tree_against_what_is_promised_over_a_swath() -> None:
    belief = at_turn(math.inf)
    places = [
        belief.frame.centres(belief.frontier_cells[low:high]).mean(axis=0)
        for low, high in itertools.pairwise(belief.frontier_starts)
    ]
    tree, joined, left = 0.0, places[:1], places[1:]
    while left:  # Prim
        away, k = min((math.dist(a, b), k) for a in joined for k, b in enumerate(left))
        tree += away
        joined.append(left.pop(k))
    hidden = of_each(belief).sum() / 6.0
    frontiers = belief.frontier_cells, belief.frontier_starts
    share = known_share(belief.frame, frontiers, of_each(belief))
    assert share == pytest.approx(tree / (tree + hidden))
    assert 0.0 < share < 1.0
    assert known_share(belief.frame, frontiers, 0.0 * of_each(belief)) == 1.0


def priced(classes: NDArray[np.uint8]) -> MapBelief:
    """Return the belief of a round in which the end of tours has a price of 1 m^2/s where all is known."""
    about = {"reach": SPEC.range, "extent": 2.5, "hidden": 0.5, "counts": empty_counts()}
    return freeze(classes, FRAME, end_price=EndPrice(1.0), layers=layers.fading(60.0, 10.0), **about)


def test_the_end_has_its_price_to_the_share_of_the_work_that_is_known() -> None:
    for places in (CORRIDOR, ROOMS):
        belief = priced(explored(places))
        share = known_share(belief.frame, (belief.frontier_cells, belief.frontier_starts), of_each(belief))
        assert belief.end_price.linear == pytest.approx(share * np.log(2.0) / FRAME.resolution**2)
    seen = explored(CORRIDOR)
    shallow = np.where((seen == UNKNOWN) & ~binary_dilation(seen == FREE, iterations=2), OCCUPIED, seen)
    assert priced(shallow.astype(np.uint8)).end_price.linear > 1.3 * priced(seen).end_price.linear


@pytest.mark.parametrize(("share", "order", "why"), [(0.0, [0, 1], "soonest"), (1.0, [1, 0], "shortest")])
def test_each_lean_wins_by_its_own_measure(share: float, order: list[int], why: str) -> None:
    """A room 20 s one way, a scrap 10 s the other: room first, more is known soon; else it ends sooner."""
    footprints = Footprints(np.array([0, 1, 2]), np.array([0, 1], np.uint32), np.array([255, 255], np.uint8))
    worth, time = np.array([30.0, 6.0], np.float32), layers.fading(60.0, 10.0)
    first_leg, legs = np.array([20, 10], np.float32), np.array([[0, 30], [30, 0]], np.float32)
    nothing = np.empty(0, np.uint32), np.empty(0, np.uint8)
    price = EndPrice(1.0).times(share)
    problem = TourProblem(
        CellWeights.whole(worth), time.weights, time.edges, nothing, footprints, first_leg, legs,
        (price.linear, price.quadratic),
    )  # fmt: skip
    tour, _, _ = best_tour(problem, np.empty(0, np.int64), 2)
    assert tour.tolist() == order
    known = {key: sum(w * math.exp(-t / 60.0) for w, t in zip(worth, at, strict=True))
             for key, at in (((0, 1), (20.0, 50.0)), ((1, 0), (40.0, 10.0)))}  # fmt: skip
    ends = {(0, 1): 50.0, (1, 0): 40.0}
    best = (
        max(known, key=lambda key: known[key]) if why == "soonest" else min(ends, key=lambda key: ends[key])
    )
    assert tuple(tour.tolist()) == best


@pytest.mark.parametrize("seed", range(10))
def test_the_member_in_the_middle_is_the_one_nearest_the_centroid(seed: int) -> None:
    classes = np.random.default_rng(seed).integers(0, 2, (17, 31)).astype(np.uint8)
    cells, starts = find_frontiers(classes, 1, 9)
    everywhere = np.zeros(classes.shape, np.float32)
    nearest, _ = reference_coverage.viewpoints(everywhere, classes, cells, starts, 0)
    assert members_in_the_middle(cells, starts, 31).tolist() == nearest.tolist()


def test_before_the_turn_a_round_is_that_of_the_papers_rate() -> None:
    before = at_turn(0.0)
    rate = PLANNERS["rate"]
    paper = freeze(
        explored(CORRIDOR),
        FRAME,
        reach=SPEC.range,
        extent=2.5,
        hidden=rate.hidden,
        return_price=rate.return_price,
        layers=rate.layers,
        counts=empty_counts(),
    )
    assert np.array_equal(dense(before.weights), dense(paper.weights))
    assert np.array_equal(before.layers.weights, paper.layers.weights)
    chosen = []
    for name, belief in (("rate", paper), ("information", before)):
        robot = PLANNERS[name].platform(SPEC)
        placed(robot, belief)
        chosen.append(robot.reply(belief, robot.impact(belief, STAY), STAY).stops.tolist())
    assert len(chosen[0]) == 1
    assert chosen[0] == chosen[1]


def test_after_the_turn_a_round_is_that_of_tours_at_the_price_of_the_way_back() -> None:
    after = at_turn(math.inf)
    assert dense(after.weights).sum() > dense(at_turn(0.0).weights).sum()
    robot = MappingPlatform(SPEC)
    placed(robot, after)
    assert len(robot.reply(after, robot.impact(after, STAY), STAY)) > 1


def test_a_tour_of_before_is_kept_as_far_as_a_robot_looks_ahead() -> None:
    after, before = at_turn(math.inf), at_turn(0.0)
    robot = MappingPlatform(SPEC)
    placed(robot, after)
    tour = robot.reply(after, robot.impact(after, STAY), STAY)
    placed(robot, before)
    kept = robot.carry_over(tour)
    assert len(tour) > 1
    assert kept.targets.tolist() == tour.targets[:1].tolist()


def test_before_the_turn_no_single_stop_adds_more_than_the_bound() -> None:
    belief = at_turn(0.0)
    robot = MappingPlatform(SPEC)
    placed(robot, belief)
    assert robot.stops is not None
    nothing = robot.impact(belief, STAY)
    worth = belief.layers.weights[::-1].cumsum()[::-1]
    most = 0.0
    for stop in np.flatnonzero(np.isfinite(robot.stops.first_leg)):
        impact = robot.impact(belief, robot.tour(np.array([stop])))
        seen = -np.expm1(impact.misses / -16.0)
        most = max(
            most,
            float((seen * dense(belief.weights)[impact.keys // LAYERS] * worth[impact.keys % LAYERS]).sum()),
        )
    assert robot.slack(belief, nothing) == pytest.approx(most, rel=1e-3)


def test_a_gap_that_no_body_fits_through_must_promise_more() -> None:
    belief = at_turn(math.inf)
    ground = survey(belief, SPEC, -0.5, 7.1, [], 0.05)
    model = MappingPlatform(SPEC).model(belief)
    longest = float(np.diff(belief.frontier_starts).max()) * belief.frame.resolution
    found = look(belief, ground, SPEC)
    wide = find_stops(belief, ground, SPEC, model, 0.0, found)
    stout = replace(SPEC, radius=0.5 * longest)  # the ground stays that of the other
    narrow = find_stops(belief, ground, stout, model, 0.0, found)
    least = min(LEAST_SHARE * int((belief.classes == FREE).sum()) * belief.frame.resolution**2, ENOUGH)
    areas = expected_areas(at_turn(0.0), wide)  # without prices
    assert areas.min() >= least - 0.02
    assert sorted(map(tuple, narrow.targets.tolist())) == sorted(
        map(tuple, wide.targets[areas >= GAP * least].tolist())
    )


def test_when_nothing_else_is_left_a_frontier_seen_too_slantingly_is_looked_at_from_close_by() -> None:
    x, y = -2.5, 6.8
    belief = at_turn(math.inf, explored([(x, y)]))
    robot = MappingPlatform(SPEC)
    model = robot.model(belief)
    ground = survey(belief, SPEC, x, y, [], CLEARANCES[0])
    far, near = (
        find_stops(belief, ground, SPEC, model, LEAST_AREA, look(belief, ground, SPEC, close=close))
        for close in (False, True)
    )
    assert np.hypot(*(near.targets - near.views).T).max() <= CLOSE_VIEW + belief.frame.resolution
    slanting = [target for target in near.targets if np.hypot(*(far.targets - target).T).min() > LEFT_ALONE]
    assert slanting
    robot.left_alone.avoided = [(*target, math.inf) for target in far.targets]
    placed(robot, belief, x, y)
    assert robot.stops is not None
    left = robot.stops.targets[np.isfinite(robot.stops.first_leg)]
    assert left.tolist() == [target.tolist() for target in slanting]


def test_the_named_objectives_differ_in_when_they_turn_and_in_the_price_of_coming_back() -> None:
    information, completion = PLANNERS["information"], PLANNERS["completion"]
    assert information.turn < PLANNERS[DEFAULT].turn == completion.turn
    assert information.return_price == PLANNERS[DEFAULT].return_price < completion.return_price


def test_a_robot_alone_plans_routes_by_default() -> None:
    assert planner(DEFAULT, robots=1) is PLANNERS["makespan"]
    assert planner(DEFAULT, robots=2) is PLANNERS[DEFAULT]
    assert planner(DEFAULT) is PLANNERS[DEFAULT]

"""A mapping robot: its tours' impacts and values, and which frontiers it goes back to."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from numpy.typing import NDArray

from tests.support.mapping_scenes import CORRIDOR, FRAME, RESOLUTION, SPEC, explored, frozen, placed
from vedette.domains.mapping import views
from vedette.domains.mapping.impact import NOTHING, Impact
from vedette.domains.mapping.layers import TimeLayers, plain, rate
from vedette.domains.mapping.objective import MappingObjective
from vedette.domains.mapping.platform import LEFT_ALONE, STICKINESS, MappingPlatform
from vedette.domains.mapping.stops import Stops, nearest_view, unknown_near
from vedette.domains.mapping.tour import STAY, Tour
from vedette.kernels import coverage
from vedette.kernels.coverage import LAYERS
from vedette.maps import FREE, OCCUPIED, UNKNOWN

OBJECTIVE = MappingObjective()


def ready(x: float = -0.5, max_stops: int = 6) -> MappingPlatform:
    platform = MappingPlatform(SPEC, max_stops=max_stops)
    placed(platform, frozen(), x)
    return platform


def stops_of(platform: MappingPlatform) -> Stops:
    assert platform.stops is not None
    return platform.stops


def random_team(rng: np.random.Generator, platform: MappingPlatform) -> Impact:
    """What others might have promised: parts of this robot's own footprints, and more."""
    cells = np.unique(stops_of(platform).footprints.cells)
    keys = np.flatnonzero(rng.random(len(cells) * LAYERS) < 0.1)
    keys = cells[keys // LAYERS].astype(np.int64) * LAYERS + keys % LAYERS
    return Impact(keys.astype(np.uint32), rng.integers(1, 80, len(keys)).astype(np.uint8))


def random_tour(rng: np.random.Generator, platform: MappingPlatform) -> Tour:
    return platform.tour(rng.permutation(len(stops_of(platform)))[: rng.integers(1, 7)])


@pytest.mark.parametrize("worth", [rate(start=5.0), rate(start=40.0), rate(), plain()])
def test_the_kernel_values_a_tour_as_the_objective_values_its_impact(worth: TimeLayers) -> None:
    belief = dataclasses.replace(frozen(), layers=worth)
    platform = ready()
    stops = stops_of(platform)
    for seed in range(25):
        rng = np.random.default_rng(seed)
        others, tour = random_team(rng, platform), random_tour(rng, platform)
        problem = coverage.TourProblem(
            belief.weights,
            belief.layers.weights,
            belief.layers.edges,
            others.sparse,
            stops.footprints,
            stops.first_leg,
            stops.legs,
        )
        _, _, gain = coverage.best_tour(problem, tour.stops, 6)
        team = OBJECTIVE.combine(others, platform.impact(belief, tour))
        assert gain == pytest.approx(
            OBJECTIVE.value(belief, team) - OBJECTIVE.value(belief, others), rel=1e-4
        )


def test_arrivals_at_a_layers_edge_fall_into_the_same_layer_for_kernel_and_impact() -> None:
    belief, platform = frozen(), ready(max_stops=2)
    stops, edge = stops_of(platform), np.float32(belief.layers.edges[0])
    for first in np.arange(0.1, float(edge), 0.1, dtype=np.float32):
        second = edge - first
        if first + second == edge < np.float64(first) + np.float64(second):
            break  # the arrival is at the edge in single precision, and past it in double
    else:
        pytest.fail("no such legs")
    first_leg, legs = np.full_like(stops.first_leg, first), np.full_like(stops.legs, second)
    platform.stops = dataclasses.replace(stops, first_leg=first_leg, legs=legs)
    tour = platform.tour(np.array([0, 5]))
    assert belief.layers.layer(float(tour.arrivals[1])) == 0


def test_no_tour_adds_more_than_the_slack() -> None:
    belief, platform = frozen(), ready()
    for seed in range(25):
        rng = np.random.default_rng(seed)
        others = random_team(rng, platform)
        best = platform.reply(belief, others, STAY)
        for tour in (best, random_tour(rng, platform)):
            team = OBJECTIVE.combine(others, platform.impact(belief, tour))
            gain = OBJECTIVE.value(belief, team) - OBJECTIVE.value(belief, others)
            assert platform.slack(belief, others) >= gain * (1 - 1e-5)


def test_a_robot_turns_away_from_its_stop_if_and_only_if_another_gains_clearly_more() -> None:
    belief, platform = frozen(), ready(max_stops=1)
    singles = [platform.tour(np.array([stop])) for stop in range(len(stops_of(platform)))]
    found = set()
    for seed in range(10):
        others = random_team(np.random.default_rng(seed), platform)
        gains = OBJECTIVE.values(belief, others, [platform.impact(belief, tour) for tour in singles])
        gains -= OBJECTIVE.value(belief, others)
        for tour, gain in zip(singles, gains, strict=True):
            if abs(gains.max() / gain - 1.0 - STICKINESS) > 1e-3:  # not on the edge
                kept = platform.reply(belief, others, tour) is tour
                assert kept == (gains.max() <= gain * (1.0 + STICKINESS))
                found.add(kept)
    assert found == {False, True}


def test_a_tour_ends_before_the_first_stop_that_cannot_be_reached() -> None:
    platform = ready()
    first_leg, legs = stops_of(platform).first_leg.copy(), stops_of(platform).legs.copy()
    first_leg[3] = legs[:, 3] = np.inf
    platform.stops = dataclasses.replace(stops_of(platform), first_leg=first_leg, legs=legs)
    tour = platform.tour(np.array([2, 5, 3, 1]))
    assert tour.stops.tolist() == [2, 5]
    assert tour.arrivals.tolist() == [first_leg[2], np.float32(first_leg[2] + legs[2, 5])]
    assert len(platform.tour(np.array([3]))) == 0


def test_carrying_over_keeps_places_and_order_and_leaves_out_what_vanished() -> None:
    platform = ready()
    old = platform.tour(np.array([2, 13, 4, 16]))
    shift = np.array([[0.05, 0], [30, 0], [0, -0.05], [0, 0.02]])
    moved = dataclasses.replace(old, targets=old.targets + shift)
    placed(platform, frozen(), x=0.5)
    again = platform.carry_over(moved)
    assert again.stops.tolist() == [old.stops[0], old.stops[2], old.stops[3]]
    assert again.arrivals[0] == stops_of(platform).first_leg[old.stops[0]] != old.arrivals[0]
    assert len(platform.carry_over(STAY)) == 0


def test_carrying_over_skips_a_stop_that_cannot_be_reached_any_more() -> None:
    platform = ready()
    old = platform.tour(np.array([2, 4, 13]))
    x, y = old.targets[1]
    platform.left_alone.avoided.append((x, y, 99.0))
    placed(platform, frozen())
    assert platform.carry_over(old).stops.tolist() == [2, 13]


def reachable_near(platform: MappingPlatform, x: float, y: float) -> NDArray[np.bool_]:
    stops = stops_of(platform)
    near = np.hypot(stops.targets[:, 0] - x, stops.targets[:, 1] - y) < 0.4
    return np.isfinite(stops.first_leg[near])


def test_a_frontier_that_a_visit_did_not_change_stays_given_up_until_the_map_near_it_changes() -> None:
    platform, classes = ready(), explored(CORRIDOR)
    x, y = stops_of(platform).targets[2].tolist()
    unknown = int(stops_of(platform).unknown[2])
    platform.left_alone.visited.append((x, y, unknown, 0.4))
    for _ in range(3):
        placed(platform, frozen(classes))
        assert not reachable_near(platform, x, y).any()
        stops = stops_of(platform)
        near = np.hypot(*(stops.targets - (x, y)).T) < 0.4
        assert near.any()
        assert (stops.legs[:, near] == np.inf).all()  # from no other stop either
        assert platform.reply(frozen(classes), NOTHING, STAY).stops.tolist().count(2) == 0
    row, col = FRAME.cell(x, y)
    window = classes[row - 6 : row + 7, col - 6 : col + 7]
    far_unknown = np.argwhere(window == UNKNOWN)
    far_unknown = far_unknown[np.argsort(-np.hypot(*(far_unknown - 6).T))][: unknown // 8 + 3]
    window[tuple(far_unknown.T)] = FREE
    placed(platform, frozen(classes))
    assert not platform.left_alone.given_up
    assert reachable_near(platform, x, y).all()
    assert len(reachable_near(platform, x, y))


def test_a_frontier_whose_visit_changed_the_map_is_not_given_up() -> None:
    platform = ready()
    x, y = stops_of(platform).targets[2].tolist()
    platform.left_alone.visited.append((x, y, 2 * int(stops_of(platform).unknown[2]), 0.4))
    placed(platform, frozen())
    assert not platform.left_alone.given_up
    assert reachable_near(platform, x, y).all()


def test_a_frontier_that_a_look_from_afar_did_not_change_is_looked_at_from_as_near_as_can_be() -> None:
    platform = ready()
    stops = stops_of(platform)
    apart = np.hypot(*(stops.targets - stops.views).T)
    k = int(np.argmax(np.where(np.isfinite(stops.first_leg), apart, 0.0)))
    assert apart[k] > 2.0
    (x, y), unknown = stops.targets[k].tolist(), int(stops.unknown[k])
    platform.left_alone.visited.append((x, y, unknown, apart[k]))
    placed(platform, frozen())
    assert not platform.left_alone.given_up
    assert [(spot.x, spot.y) for spot in platform.left_alone.closer] == [(x, y)]
    now = stops_of(platform)
    near = np.hypot(*(now.targets - (x, y)).T) < 0.5
    assert (np.hypot(*(now.targets - now.views)[near].T) <= nearest_view(SPEC, RESOLUTION) + RESOLUTION).all()
    others = np.hypot(*(stops.targets - (x, y)).T) >= 0.5
    np.testing.assert_array_equal(now.views[~near], stops.views[others])
    platform.left_alone.visited.append((x, y, unknown, 0.9))  # nearer it could not get
    placed(platform, frozen())
    assert [(spot.x, spot.y) for spot in platform.left_alone.given_up] == [(x, y)]


def test_a_frontier_too_narrow_for_the_body_is_given_up_after_a_look_from_within_a_metre() -> None:
    classes, platform = explored(CORRIDOR), ready()
    assert (classes[43, 36:46] == OCCUPIED).all()
    assert (classes[44, 36:46] == FREE).all()
    for cells, narrow in ((3, True), (6, False)):  # of a gap in the wall; the body is four across
        classes[43, 38 : 38 + cells] = UNKNOWN
        x, y = FRAME.centres(np.array([44 * FRAME.cols + 38 + cells // 2]))[0].tolist()
        for afar, given_up in ((1.5, False), (0.9, narrow), (0.4, True)):
            platform.left_alone.given_up.clear()
            platform.left_alone.closer.clear()
            platform.left_alone.visited.append((x, y, unknown_near(classes, FRAME, x, y), afar))
            placed(platform, frozen(classes))
            assert bool(platform.left_alone.given_up) == given_up, (cells, afar)
            assert bool(platform.left_alone.closer) != given_up


def test_a_visit_is_judged_where_no_frontier_is_left_at_all() -> None:
    platform, classes = ready(), np.where(explored(CORRIDOR) == UNKNOWN, OCCUPIED, explored(CORRIDOR))
    classes[40:43, 38] = UNKNOWN  # behind the wall
    x, y = FRAME.centres(np.array([44 * FRAME.cols + 38]))[0].tolist()
    platform.left_alone.visited.append((x, y, unknown_near(classes, FRAME, x, y), 0.9))
    belief = frozen(classes)
    assert not len(belief.frontier_cells)
    placed(platform, belief)
    assert len(platform.left_alone.given_up) == 1


def test_an_avoided_frontier_is_left_alone_for_its_time() -> None:
    platform = ready()
    x, y = stops_of(platform).targets[2].tolist()
    platform.left_alone.avoided.append((x, y, 20.0))
    placed(platform, frozen(), now=19.9)
    assert not reachable_near(platform, x, y).any()
    placed(platform, frozen(), now=20.0)
    assert reachable_near(platform, x, y).all()
    assert not platform.left_alone.avoided


def by_way(platform: MappingPlatform) -> NDArray[np.float64]:
    """Return the frontiers of the stops that can be visited, ``(N, 2)``, by how far it is to them."""
    stops = stops_of(platform)
    order = np.argsort(stops.first_leg, kind="stable")
    return stops.targets[order][np.isfinite(stops.first_leg[order])]


def test_a_robot_whose_nearest_stops_are_no_good_takes_those_after_them(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    belief, whole = frozen(), by_way(ready())
    assert len(whole) > 8
    monkeypatch.setattr(views, "MOST_STOPS", 3)
    platform = MappingPlatform(SPEC)
    placed(platform, belief)
    assert by_way(platform).tolist() == whole[:3].tolist()
    platform.left_alone.avoided = [(*target, np.inf) for target in whole[:3]]
    placed(platform, belief)
    taken = by_way(platform)
    left = [target for target in whole[3:] if np.hypot(*(whole[:3] - target).T).min() >= LEFT_ALONE]
    assert 0 < len(taken) <= 3
    np.testing.assert_array_equal(taken, left[: len(taken)])
    assert not platform.cut_short


def test_a_round_that_is_cut_short_promises_no_bound_and_the_next_one_works_more(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    belief, whole = frozen(), by_way(ready())
    monkeypatch.setattr(views, "MOST_WORK", 1)
    platform = MappingPlatform(SPEC)
    platform.left_alone.avoided = [(*target, np.inf) for target in whole[:-1]]
    rounds = 0
    while platform.stops is None or not len(by_way(platform)):
        placed(platform, belief)
        assert platform.cut_short
        assert platform.slack(belief, NOTHING) == np.inf
        rounds += 1
    assert rounds > 2
    monkeypatch.undo()
    placed(platform, belief)
    assert not platform.cut_short
    assert platform.slack(belief, NOTHING) < np.inf


def test_a_robot_with_nothing_to_see_stays() -> None:
    classes = np.where(explored(CORRIDOR) == UNKNOWN, 2, explored(CORRIDOR)).astype(np.uint8)
    belief, platform = frozen(classes), MappingPlatform(SPEC)
    placed(platform, belief)
    assert len(stops_of(platform)) == 0
    assert platform.reply(belief, NOTHING, STAY) is STAY
    assert platform.impact(belief, STAY) == NOTHING
    assert platform.slack(belief, NOTHING) == 0.0

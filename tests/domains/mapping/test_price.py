"""The price of a tour: an integer of its impact that adds, travels, is taken off, and is checked."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.support.explorers import explorer
from tests.support.mapping_scenes import SPEC, frozen, placed
from vedette.domains.mapping.belief import LN2
from vedette.domains.mapping.impact import (
    NOTHING,
    PRICE_STEPS,
    Impact,
    MapImpactCodec,
    discounted,
    moved,
)
from vedette.domains.mapping.objective import MappingObjective
from vedette.domains.mapping.planners import planner
from vedette.domains.mapping.platform import MappingPlatform
from vedette.domains.mapping.price import DEAREST, FREE, LATEST, EndPrice
from vedette.domains.mapping.tour import STAY
from vedette.errors import InputError
from vedette.kernels.coverage import LAYERS
from vedette.testing import check_objective

seeds = st.integers(0, 2**32 - 1)
OBJECTIVE = MappingObjective()
DEAR = EndPrice(2.0, 0.07)


def priced(rng: np.random.Generator, cells: int) -> Impact:
    keys = np.flatnonzero(rng.random(cells * LAYERS) < rng.choice([0.0, 0.003, 0.1]))
    misses = rng.integers(1, 256, len(keys)).astype(np.uint8)
    return Impact(keys.astype(np.uint32), misses, int(rng.choice([0, 1, 5 * PRICE_STEPS, 2**40])))


@settings(deadline=None, max_examples=30)
@given(seeds)
def test_prices_add_and_are_taken_off_whatever_is_shown(seed: int) -> None:
    rng, belief = np.random.default_rng(seed), frozen()
    impacts = [priced(rng, 200) for _ in range(4)]
    check_objective(OBJECTIVE, belief, [NOTHING, *impacts], tolerance=1e-6)
    for impact in impacts:
        shown = Impact(*impact.sparse)
        assert OBJECTIVE.value(belief, impact) == OBJECTIVE.value(belief, shown) - impact.price / PRICE_STEPS
        assert OBJECTIVE.gross(belief, impact) == pytest.approx(OBJECTIVE.value(belief, shown), abs=1e-3)


@settings(deadline=None, max_examples=60)
@given(seeds, st.sampled_from([1, 30, 257]))
def test_a_price_travels_and_an_impact_without_one_is_no_longer_than_before(seed: int, cells: int) -> None:
    codec, impact = MapImpactCodec(cells), priced(np.random.default_rng(seed), cells)
    free = codec.encode(Impact(*impact.sparse))
    payload = codec.encode(Impact(*impact.sparse, impact.price))  # which nobody holds: it has to be read
    assert codec.decode(payload) == impact
    assert codec.decode(free) == Impact(*impact.sparse)
    assert len(payload) == len(free) + (7 if impact.price else 0)
    assert len(payload) <= codec.bound


def test_what_is_no_price_is_refused() -> None:
    codec = MapImpactCodec(10)
    data = codec.encode(Impact(NOTHING.keys, NOTHING.misses, 9))
    for wrong in (data[:-7] + bytes(7), data[:-1], data + b"\0"):
        with pytest.raises(ValueError, match="impact"):
            codec.decode(wrong)
    with pytest.raises(OverflowError):
        codec.encode(Impact(NOTHING.keys, NOTHING.misses, -9))


def test_a_price_stays_where_claims_count_less_or_planes_move() -> None:
    impact, belief = Impact(np.array([7], np.uint32), np.array([64], np.uint8), 30), frozen()
    assert discounted(impact, 3).price == 30
    assert moved(impact, belief.planning, replace(belief.planning, cols=3)).price == 30
    assert OBJECTIVE.clip(belief, impact, ()).price == 30


def test_an_end_price_is_linear_and_quadratic_in_seconds_and_rises_no_more_after_an_hour() -> None:
    assert [DEAR.of(t) for t in (0.0, 10.0)] == [0, round((20.0 + 3.5) * PRICE_STEPS)]
    assert DEAR.of(LATEST) == DEAR.of(1e9) > DEAR.of(LATEST - 1.0)
    assert FREE.of(100.0) == 0


@pytest.mark.parametrize("robots", [1, 3])
def test_a_price_that_nobody_can_have_is_refused_and_all_that_robots_have_pass(robots: int) -> None:
    def at(price: int) -> Impact:
        return replace(NOTHING, price=price)

    for price in (0, DEAR.of(47.0), robots * DEAR.of(LATEST)):
        DEAR.check(at(price), robots)
    for wrong in (robots * DEAR.of(LATEST) + 1, -1):
        with pytest.raises(ValueError, match="has a price"):
            DEAR.check(at(wrong), robots)
    FREE.check(NOTHING, robots)
    with pytest.raises(ValueError, match="has a price"):
        FREE.check(at(1), robots)


def test_a_tour_costs_by_its_end_and_to_stay_as_much_as_the_farthest_single_stop() -> None:
    belief = replace(frozen(), end_price=DEAR)
    robot = MappingPlatform(SPEC, max_stops=6)
    placed(robot, belief)
    assert robot.stops is not None
    assert robot.leads_anywhere
    legs = robot.stops.first_leg
    order = np.argsort(legs, kind="stable")[:2]
    tour = robot.tour(order)
    assert robot.impact(belief, tour).price == DEAR.of(float(tour.arrivals[-1])) > 0
    assert robot.impact(belief, STAY).price == DEAR.of(float(legs[np.isfinite(legs)].max()))
    assert not len(robot.impact(belief, STAY).keys)
    assert robot.impact(replace(belief, end_price=FREE), STAY) == NOTHING


def test_a_mission_admits_what_its_own_robots_do_whatever_they_know_and_nothing_dearer() -> None:
    mission = explorer()
    mission.planner = replace(mission.planner, end_price=DEAR)
    most = DEAR.times(LN2 / mission.frame.resolution**2)
    share = mission.freeze(0.0).end_price.linear / most.linear
    assert 0.0 <= share <= 1.0  # of the work left, that is known
    belief = replace(frozen(), end_price=most)
    robot = MappingPlatform(SPEC, max_stops=6)
    placed(robot, belief)
    assert robot.stops is not None
    impact = robot.impact(belief, robot.tour(np.argsort(robot.stops.first_leg, kind="stable")[:2]))
    assert impact.price > 0
    mission.admit(belief, impact, 1)
    for price in (-1, most.of(LATEST) + 1):
        with pytest.raises(ValueError, match="has a price"):
            mission.admit(belief, replace(impact, price=price), 1)


def test_a_price_beyond_all_measure_is_the_dearest_and_so_many_of_them_are_written() -> None:
    codec = MapImpactCodec(4)
    for price in (EndPrice(1e12, 1e12), EndPrice(1e300, 1e300)):
        assert price.of(100.0) == DEAREST
        many = Impact(NOTHING.keys, NOTHING.misses, 1024 * price.of(100.0))
        assert codec.decode(codec.encode(many)) == many


@pytest.mark.parametrize("wrong", [-1.0, float("nan"), float("inf"), True, "2"])
def test_what_is_no_end_price_is_refused_in_a_line(wrong: Any) -> None:
    with pytest.raises(InputError, match="end_price: quadratic must be a number >= 0; got"):
        EndPrice(0.0, wrong)


def test_a_planner_whose_end_price_is_none_is_refused_in_a_line() -> None:
    with pytest.raises(InputError, match=r"has 2\.0 as end_price, not an EndPrice"):
        planner("tests.support.priced_planner:WRONG")

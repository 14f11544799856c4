"""Flights that keep out of no-go areas: against paths drawn so finely that nothing can be missed."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vedette.forbidden import NOWHERE, Forbidden, Turning, steered
from vedette.maps.area import Area
from vedette.vehicle import drive

SQUARE = Forbidden((Area(((100.0, -30.0), (160.0, -30.0), (160.0, 30.0), (100.0, 30.0))),))
VEHICLE = Turning(20.0, 0.5)  # 40 m
PLACES = st.tuples(st.floats(-60.0, 60.0), st.floats(-60.0, 60.0), st.floats(-math.pi, math.pi))


def finely(pose: np.ndarray, rates: np.ndarray, dt: float) -> np.ndarray:
    """Where a flight leads (N, 2), and once round the circle after it, every 0.1 m or so."""
    parts = math.ceil(VEHICLE.speed * dt / 0.1)
    flown = drive(pose, np.repeat(rates, parts), VEHICLE.speed, dt / parts)
    end = flown[-1] if len(flown) else pose
    around = drive(end, np.full(2600, VEHICLE.turn_rate), VEHICLE.speed, 0.005)
    return np.vstack((pose[None], flown, around))[:, :2]


@settings(max_examples=60, deadline=None)
@given(PLACES, st.lists(st.sampled_from((-0.5, -0.25, 0.0, 0.5)), min_size=1, max_size=8))
def test_a_flight_that_is_allowed_never_enters_nor_does_the_circle_after_it(
    pose: tuple[float, float, float], rates: list[float]
) -> None:
    at, turns = np.array(pose), np.array(rates)
    away = SQUARE.distance(finely(at, turns, 1.0))
    if SQUARE.allows(at, turns[None], VEHICLE, 1.0)[0]:
        assert away.min() > 0.0
    elif (
        away.min() > 3.0 * VEHICLE.margin
    ):  # and nothing is refused that keeps well away, but for round trips
        end = drive(at, turns, VEHICLE.speed, 1.0)[-1]
        middle = end[:2] + VEHICLE.radius * np.array((-math.sin(end[2]), math.cos(end[2])))
        assert SQUARE.distance(middle[None])[0] <= VEHICLE.radius + VEHICLE.margin


def test_what_does_not_keep_out_is_replaced_and_what_is_fixed_stays() -> None:
    pose = np.array((0.0, 0.0, 0.0))
    ahead, away = np.zeros(6), np.full(6, -0.5)
    kept = SQUARE.kept_out(pose, np.stack((ahead, away)), VEHICLE, 1.0)
    np.testing.assert_array_equal(kept, [away, away])
    only = SQUARE.kept_out(pose, ahead[None], VEHICLE, 1.0, fixed=2)
    np.testing.assert_array_equal(only, [[0.0, 0.0, 0.5, 0.5, 0.5, 0.5]])
    np.testing.assert_array_equal(NOWHERE.kept_out(pose, ahead[None], VEHICLE, 1.0), ahead[None])


@settings(max_examples=60, deadline=None)
@given(st.tuples(st.floats(-20.0, 220.0), st.floats(-90.0, 90.0), st.floats(-math.pi, math.pi)))
def test_an_escape_leads_out_and_its_circle_stays_out(pose: tuple[float, float, float]) -> None:
    at = np.array(pose)
    rates, step = SQUARE.escape(at, VEHICLE)
    away = SQUARE.distance(finely(at, rates, step))
    out = int(np.argmax(away > 0.0))
    assert (away[out:] > 0.0).all() or away[0] > 0.0
    assert SQUARE.allows(drive(at, rates, VEHICLE.speed, step)[-1], np.zeros((1, 0)), VEHICLE, 1.0)[0]


@settings(max_examples=60, deadline=None)
@given(PLACES, st.tuples(st.floats(-300.0, 300.0), st.floats(-300.0, 300.0)))
def test_a_vehicle_gets_to_any_place_even_one_within_its_circles(
    pose: tuple[float, float, float], place: tuple[float, float]
) -> None:
    found = steered(np.array(pose), [np.array(place)], VEHICLE)
    assert found is not None
    rates, step = found
    assert (np.abs(rates) <= VEHICLE.turn_rate).all()
    end = drive(np.array(pose), rates, VEHICLE.speed, step)[-1] if len(rates) else np.array(pose)
    assert np.hypot(*(end[:2] - place)) <= 0.2 * VEHICLE.radius
    assert (
        len(rates) * step * VEHICLE.speed <= np.hypot(*np.subtract(pose[:2], place)) + 14.0 * VEHICLE.radius
    )


def test_a_way_round_keeps_its_distance_and_is_the_shortest_of_such() -> None:
    here, there = np.array((0.0, 0.0)), np.array((260.0, 0.0))
    way = SQUARE.round(here, there, 10.0)
    assert len(way) > 2
    legs = [np.linspace(a, b, 200) for a, b in itertools.pairwise(way)]
    assert SQUARE.distance(np.concatenate(legs)).min() > 0.0
    length = sum(float(np.hypot(*(b - a))) for a, b in itertools.pairwise(way))
    assert 2.0 * math.hypot(100.0, 30.0) + 60.0 <= length < 300.0
    assert len(SQUARE.round(here, np.array((0.0, 200.0)), 10.0)) == 2
    assert SQUARE.round(here, np.array((130.0, 0.0)), 10.0) == []  # into the area


def test_inside_is_told_from_outside() -> None:
    assert SQUARE.holds(130.0, 0.0)
    assert not SQUARE.holds(90.0, 0.0)
    assert not NOWHERE.holds(0.0, 0.0)
    assert not NOWHERE
    assert SQUARE


@pytest.mark.parametrize("speed", [0.5, 60.0])
def test_places_that_are_looked_at_lie_no_farther_apart_than_twice_the_margin(speed: float) -> None:
    vehicle = Turning(speed, 0.3)
    assert vehicle.spacing <= 2.0 * vehicle.margin

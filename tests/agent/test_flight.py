"""Flights: turn-rate plans end to end, in pieces, early or late, and the circle where there is none."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from vedette.agent import Pace
from vedette.agent.flight import FlightPlan, Itinerary, start_step
from vedette.errors import InputError

times = st.integers(0, 300).map(lambda tenths: tenths * 0.1)


def random_flight(rng: np.random.Generator) -> Itinerary:
    """A flight that a few plans joined one after another, some late, some overlapping, with gaps."""
    flight, now = Itinerary(0.4), 0.0
    for _ in range(int(rng.integers(0, 5))):
        now += float(rng.integers(0, 40)) * 0.1
        start = round(max(now + float(rng.uniform(-2.0, 3.0)), 0.0), 1)
        rates = rng.uniform(-1.0, 1.0, int(rng.integers(1, 6)))
        flight = flight.joined(FlightPlan(start, float(rng.choice([0.3, 1.0, 2.0])), rates), now)
    return flight


def integrated(
    flight: Itinerary, pose: NDArray[np.float64], speed: float, begin: float, end: float
) -> NDArray[np.float64]:
    """The same by small steps of the differential equation, the rate looked up at the middle of each."""
    steps = max(round((end - begin) / 1e-2), 0)
    x, y, heading = pose
    for k in range(steps):
        time, dt = begin + (k + 0.5) * 1e-2, 1e-2
        [(rate, _)] = flight.held(time, time + 1e-6)
        middle = heading + 0.5 * rate * dt
        x, y, heading = x + speed * dt * np.cos(middle), y + speed * dt * np.sin(middle), heading + rate * dt
    return np.array((x, y, heading))


@settings(deadline=None, max_examples=30)
@given(seed=st.integers(0, 10**6), begin=times, length=times)
def test_a_flight_is_the_integral_of_its_turn_rates(seed: int, begin: float, length: float) -> None:
    rng = np.random.default_rng(seed)
    flight, pose = random_flight(rng), rng.uniform(-1.0, 1.0, 3)
    end = begin + min(length, 10.0)
    np.testing.assert_allclose(
        flight.fly(pose, 3.0, begin, end), integrated(flight, pose, 3.0, begin, end), atol=2e-3
    )


@settings(deadline=None, max_examples=60)
@given(seed=st.integers(0, 10**6), begin=times, pieces=st.lists(times, max_size=8))
def test_flying_in_pieces_is_flying_at_once(seed: int, begin: float, pieces: list[float]) -> None:
    rng = np.random.default_rng(seed)
    flight, start = random_flight(rng), rng.uniform(-1.0, 1.0, 3)
    pose, time = start, begin
    for piece in pieces:
        pose, time = flight.fly(pose, 3.0, time, time + 0.1 * piece), time + 0.1 * piece
    np.testing.assert_allclose(pose, flight.fly(start, 3.0, begin, time), atol=1e-9)


@settings(deadline=None, max_examples=60)
@given(seed=st.integers(0, 10**6), now=times, late=st.floats(-3.0, 3.0))
def test_a_plan_holds_from_its_start_or_from_when_it_came_and_nothing_changes_before(
    seed: int, now: float, late: float
) -> None:
    rng = np.random.default_rng(seed)
    before = random_flight(rng)
    plan = FlightPlan(max(now - late, 0.0), 1.0, rng.uniform(-1.0, 1.0, 4))
    after = before.joined(plan, now)
    since = max(plan.start, now)
    for time in np.arange(now, now + 8.0, 0.0625) + 1e-3:
        [(rate, _)] = after.held(time, time + 1e-6)
        if time < since - 1e-6:
            [(expected, _)] = before.held(time, time + 1e-6)
        else:
            k = int((time - plan.start) // 1.0)
            expected = plan.turn_rates[k] if k < 4 else before.loiter
        assert rate == expected
        assert after.planned(time) == (rate != before.loiter)


def test_without_a_plan_a_vehicle_stays_on_a_circle() -> None:
    flight, pose = Itinerary(0.5), (3.0, 4.0, 0.0)
    radius = 10.0 / 0.5
    away = [np.hypot(*(flight.fly(pose, 10.0, 0.0, t)[:2] - (3.0, 4.0 + radius))) for t in range(1, 40)]
    np.testing.assert_allclose(away, radius, rtol=1e-9)


def test_a_flight_to_a_time_that_has_passed_leads_nowhere() -> None:
    assert Itinerary(0.5).fly((1.0, 2.0, 3.0), 10.0, 5.0, 4.0).tolist() == [1.0, 2.0, 3.0]


def test_a_flight_forgets_plans_that_are_over() -> None:
    flight = Itinerary(0.5)
    for now in range(100):
        flight = flight.joined(FlightPlan(now + 1.0, 1.0, np.zeros(3)), float(now))
    assert len(flight.plans) <= 3


@settings(deadline=None, max_examples=100)
@given(ms=st.integers(0, 10**8), lead=st.floats(0.0, 5.0), step=st.sampled_from([0.1, 0.5, 1.0, 3.0]))
def test_the_start_step_is_the_first_that_begins_in_time(ms: int, lead: float, step: float) -> None:
    k = start_step(ms / 1000.0, lead, step)
    assert k * step >= ms / 1000.0 + lead - 1e-6
    assert (k - 1) * step < ms / 1000.0 + lead


def test_a_round_frozen_on_a_step_may_start_on_it() -> None:
    assert [start_step(0.1 * k, 0.0, 0.1) for k in range(1000)] == list(range(1000))


@given(ticks=st.lists(st.integers(0, 200), min_size=1, max_size=30).map(sorted))
def test_at_most_one_round_begins_on_each_beat(ticks: list[int]) -> None:
    pace, last, begun = Pace.each(2.0), -1e9, []
    for tick in ticks:
        if pace.on_beat(last, 0.1 * tick):
            last = 0.1 * tick
            begun.append(tick // 20)
    assert begun == sorted(set(begun))
    assert set(begun) == {tick // 20 for tick in ticks}


@pytest.mark.parametrize("field", ["interval", "period", "beat"])
@pytest.mark.parametrize("value", [-1.0, np.nan, np.inf])
def test_a_pace_that_is_no_time_is_refused(field: str, value: float) -> None:
    with pytest.raises(InputError, match=field):
        Pace(**{field: value})

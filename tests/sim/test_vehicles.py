"""Whole missions of vehicles: all plan for the same steps, and whatever is lost nobody is without a plan."""

from __future__ import annotations

from functools import reduce

import numpy as np
import pytest
from numpy.typing import NDArray

from tests.support.flight_team import LEAD, SPEED, STEP, TURN_RATE, FlightTeam, flight_team
from vedette.agent import State
from vedette.agent.body import TICK
from vedette.agent.effects import Drive, Fly
from vedette.agent.flight import FlightPlan, start_step
from vedette.errors import InputError
from vedette.negotiation import SCHEMES
from vedette.outcome import Outcome
from vedette.sim.vehicles import Vehicles


def flown(n: int, **setup: object) -> FlightTeam:
    """A team at the end of its mission."""
    team = flight_team(n, **setup)  # type: ignore[arg-type]
    team.run()
    return team


def others_of(team: FlightTeam, i: int) -> NDArray[np.float64]:
    """What the living team-mates of a vehicle have decided on, combined."""
    impacts = [team.simulation.agents[k].rounds.impact for k in team.simulation.living if k != i]
    return reduce(np.multiply, impacts)


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("delay", [0.01, 0.06])
def test_every_round_all_plan_for_the_same_steps(scheme: str, delay: float) -> None:
    team = flown(4, scheme=scheme, link_delay=delay)
    t0s = [mission.t0s for mission in team.missions]
    assert all(each == t0s[0] for each in t0s)
    starts = [sorted(mission.departures) for mission in team.missions]
    assert all(each == starts[0] for each in starts)
    assert set(starts[0]) == {start_step(t0, LEAD, STEP) for t0 in t0s[0]}
    assert min(agent.rounds.decisions for agent in team.simulation.agents) >= 12


def test_with_links_that_are_fast_enough_the_team_plans_anew_every_second() -> None:
    team = flown(4, max_time=20.05)
    assert np.floor(team.missions[0].t0s).tolist() == list(range(21))


def test_a_vehicle_is_where_it_foresaw_when_its_plan_starts() -> None:
    team = flown(4)
    compared = 0
    for i, mission in enumerate(team.missions):
        for step, foreseen in mission.departures.items():
            if (i, step) in team.flown.poses:
                expected = team.flown.poses[i, step]
                np.testing.assert_allclose((foreseen.x, foreseen.y, foreseen.heading), expected, atol=1e-6)
                compared += 1
    assert compared > 80


def test_vehicles_that_start_together_spread_over_what_there_is_to_see() -> None:
    team = flown(3, max_time=40.0)
    places = np.array([team.simulation.pose(i)[:2] for i in range(3)])
    groups = team.missions[0].points.reshape(3, -1, 2).mean(axis=1)
    away = np.hypot(*(groups[:, None] - places).transpose(2, 0, 1))
    assert sorted(away.argmin(axis=1).tolist()) == [0, 1, 2]  # each has a group to itself
    assert away.min(axis=1).max() < 20.0


def test_replies_are_to_exactly_what_the_living_team_mates_do() -> None:
    team = flown(4, max_time=20.95)  # between two rounds
    for i in range(4):
        against = team.missions[i].against
        assert against is not None
        np.testing.assert_allclose(against, others_of(team, i), rtol=1e-12)


@pytest.mark.parametrize("victim", [0, 2])
def test_a_dead_vehicles_impact_vanishes_and_its_mates_take_over(victim: int) -> None:
    team = flown(3, kills=((victim, 12.0),), max_time=60.95)
    living = [i for i in range(3) if i != victim]
    assert team.simulation.living == living
    for i in living:
        mission, own = team.missions[i], team.simulation.agents[i].rounds.impact
        left = float(mission.worth @ (1.0 - own * others_of(team, i)))
        assert mission.values[-1] == pytest.approx(left, rel=1e-12)
        assert team.simulation.agents[i].rounds.decisions > 40
    x, y, heading = np.subtract(team.vehicles.pose(victim), team.flown.poses[victim, 11])
    assert np.hypot(x, y) <= SPEED + 1e-9  # it flew on for a second at most
    assert abs(np.angle(np.exp(1j * heading))) <= TURN_RATE + 1e-9
    assert max(step for i, step in team.flown.poses if i == victim) < 12


@pytest.mark.parametrize("loss", [0.02, 0.1])
def test_whatever_is_lost_every_vehicle_flies_within_its_limits(loss: float) -> None:
    team = flight_team(4, link_loss=loss, link_delay=0.05, kills=((3, 20.0),), max_time=60.0)
    headings: list[list[float]] = []
    places: list[list[tuple[float, float]]] = []

    def look() -> None:
        poses = [team.simulation.pose(i) for i in range(3)]
        headings.append([pose[2] for pose in poses])
        places.append([pose[:2] for pose in poses])

    assert team.simulation.run(look, TICK) is Outcome.TIME_LIMIT
    assert np.abs(np.diff(headings, axis=0)).max() <= TURN_RATE * TICK + 1e-9
    moved = np.linalg.norm(np.diff(places, axis=0), axis=2)
    assert moved.max() <= SPEED * TICK + 1e-9
    assert moved.min() >= SPEED * TICK * np.sinc(TURN_RATE * TICK / 2 / np.pi) - 1e-9
    np.testing.assert_allclose(team.vehicles.travelled[:3], SPEED * 60.0)
    assert min(team.simulation.agents[i].rounds.decisions for i in range(3)) >= 1
    assert all(agent.dropped == 0 for agent in team.simulation.agents)
    for i in range(3):  # what the agent foresees and what is flown are the same
        pose = team.behaviour(i).flight.held(60.0, 61.0)
        assert [rate for rate, _ in pose] == [rate for rate, _ in team.vehicles.flight(i).held(60.0, 61.0)]


def test_alone_a_vehicle_still_plans() -> None:
    team = flown(2, max_time=10.0, kills=((0, 3.3),))
    assert team.behaviour(1).state is State.FLYING


def test_a_vehicle_that_hears_nobody_circles_for_a_while_and_then_plans_alone() -> None:
    cut = flight_team(2, max_time=4.0)
    cut.fall_silent()
    cut.run()
    assert [agent.state for agent in cut.simulation.agents] == [State.FLYING, State.WAITING]
    places = np.array([cut.flown.poses[1, step][:2] for step in range(4)])
    assert np.ptp(places, axis=0).max() <= 2.0 * SPEED / TURN_RATE + 1e-9
    late = flight_team(2, max_time=25.0)
    states = []

    def look() -> None:
        if late.simulation.now >= 5.0:
            late.fall_silent()
            states.append(late.behaviour(1).state)

    late.simulation.run(look, TICK)
    circling = states.index(State.CIRCLING)
    assert State.FLYING in states[:circling]
    assert State.FLYING in states[circling:]


def test_sensors_report_at_the_end_of_every_step() -> None:
    team = flown(2, max_time=10.05)
    for mission in team.missions:
        assert [seen.data for seen in mission.seen] == list(range(11))
        np.testing.assert_allclose([seen.time for seen in mission.seen], np.arange(11) * STEP)


def test_the_mission_is_complete_when_two_rounds_say_so() -> None:
    team = flight_team(3, ends_at=10.0)
    assert team.run() is Outcome.COMPLETE
    assert 11.0 <= team.simulation.now <= 13.0
    assert all(agent.state is State.DONE for agent in team.simulation.agents)


def test_the_world_may_end_the_mission_too() -> None:
    team = flight_team(2, over=lambda now: Outcome.COMPLETE if now >= 7.0 else None)
    assert team.run() is Outcome.COMPLETE
    assert team.simulation.now == pytest.approx(7.0)


def test_a_team_of_vehicles_that_dies_is_lost() -> None:
    assert flight_team(2, kills=((0, 2.0), (1, 3.0))).run() is Outcome.TEAM_LOST


def test_the_same_seed_gives_the_same_flight_and_another_seed_another() -> None:
    first, second, other = (flown(3, link_loss=0.1, seed=seed) for seed in (1, 1, 2))
    assert first.vehicles.poses.tobytes() == second.vehicles.poses.tobytes()
    assert first.simulation.network.bytes_sent == second.simulation.network.bytes_sent
    assert first.vehicles.poses.tobytes() != other.vehicles.poses.tobytes()


@pytest.mark.parametrize("step", [0.0, 0.05, 0.25, -1.0, np.nan])
def test_a_step_that_the_simulator_does_not_tick_is_refused(step: float) -> None:
    with pytest.raises(InputError, match="step"):
        Vehicles([(0.0, 0.0, 0.0)], 1.0, 1.0, step, lambda i, pose, now: None)


def test_what_a_vehicle_cannot_do_is_refused() -> None:
    vehicles = Vehicles([(0.0, 0.0, 0.0)], 1.0, 0.5, 1.0, lambda i, pose, now: None)
    with pytest.raises(ValueError, match="turns at most"):
        vehicles.carry_out(0, Fly(FlightPlan(0.0, 1.0, np.array([0.6]))), 0.0)
    with pytest.raises(AssertionError, match="vehicles do not drive"):
        vehicles.carry_out(0, Drive(None), 0.0)

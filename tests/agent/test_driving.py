"""Driving: one stop after another, work released when stuck, room made for others, and the way home."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from tests.support.agent_team import FRAME, Team, ground, state, toy, toy_agent, toy_team
from vedette import Tree
from vedette.agent import State
from vedette.agent.driving import ON_ITS_WAY, YIELD_LIMIT, Driver
from vedette.agent.effects import Drive, Route
from vedette.agent.events import Arrived, Event, Pose, Stuck
from vedette.agent.mates import Mate
from vedette.kernels.motion import remaining
from vedette.team import PlatformSpec


def driving_team(n: int = 2) -> Team:
    """A team whose robots have all been given a goal."""
    team, _, _ = toy_team(Tree.chain(n))
    for agent in team.agents:
        toy(agent).goals = [(2.0, 2.0), (3.0, 2.0), (2.0, 3.0), (3.0, 3.0)]
    team.run_round()
    team.run(0.2)
    assert all(state(agent) is State.DRIVING for agent in team.agents)
    return team


def last_goal(drive: Drive) -> tuple[float, ...] | None:
    """Where a drive ends; None: it stands."""
    return None if drive.route is None else tuple(drive.route.path[-1].tolist())


def test_a_decision_is_driven_at_once() -> None:
    team = driving_team()
    for robot, agent in enumerate(team.agents):
        assert last_goal(team.driven[robot][-1]) == toy(agent).goal()


def test_arrival_leads_to_the_next_stop_or_to_waiting_and_asks_for_a_round() -> None:
    team = driving_team()
    agent, before = team.agents[1], team.decisions()
    team.tell(1, Arrived())
    assert state(agent) is State.IDLE
    assert last_goal(team.driven[1][-1]) is None
    team.run(2.5)
    assert team.decisions()[1] > before[1]
    assert state(agent) is State.DRIVING


def test_a_stuck_robot_releases_its_work_at_once_and_has_a_new_decision_within_two_rounds() -> None:
    team = driving_team()
    agent, before = team.agents[0], team.decisions()
    team.tell(0, Stuck())
    assert (agent.state, toy(agent).released, toy(agent).strategy) == (State.STUCK, 1, None)
    assert last_goal(team.driven[0][-1]) is None
    team.run(2.5)
    assert team.decisions()[0] > before[0]
    assert state(agent) is State.DRIVING


def test_work_that_cannot_be_reached_is_released() -> None:
    team = driving_team()
    agent = team.agents[0]
    toy(agent).no_way = True
    team.tell(0, Stuck())
    team.run(2.0)
    assert state(agent) is State.IDLE
    assert toy(agent).strategy is None
    toy(agent).no_way = False
    team.run(8.0)
    assert state(agent) is State.DRIVING


def test_a_robot_that_somebody_keeps_from_work_gives_it_back_at_once_and_asks_for_some_when_it_may() -> None:
    team = driving_team()
    agent, before = team.agents[0], team.decisions()
    team.kept = {0}
    team.run(0.2)
    assert (state(agent), toy(agent).strategy, toy(agent).released) == (State.PAUSED, None, 0)
    assert last_goal(team.driven[0][-1]) is None
    team.run(2.5)
    assert team.decisions()[0] > before[0]
    assert state(agent) is State.PAUSED
    team.kept = set()
    team.run(2.5)
    assert state(agent) is State.DRIVING


@pytest.mark.parametrize("event", [Arrived(), Stuck()])
def test_events_that_nobody_waits_for_do_nothing(event: Event) -> None:
    agent = toy_agent(0, [np.ones(12)], np.ones(12))
    team = Team([agent], Tree.chain(1))
    team.tell(0, event)  # not even a pose has come
    team.run(2.0)
    assert state(agent) is State.IDLE
    team.tell(0, event)
    assert state(agent) is State.IDLE
    assert toy(agent).released == 0


def home_team() -> Team:
    """Two robots that drove off and are now told that the mission is over."""
    team, _, belief = toy_team(Tree.chain(2))
    for agent in team.agents:
        ground(agent).return_home = True
        ground(agent).home = (2.0, 2.0)
    belief[:] = 0.0
    team.run(8.0)
    return team


def test_a_finished_robot_drives_home_and_is_done_there() -> None:
    team = home_team()
    agent = team.agents[0]
    assert state(agent) is State.RETURNING
    assert last_goal(team.driven[0][-1]) == (2.0, 2.0)
    ground(agent).home = (1.1, 1.1)  # as if it had driven: it is there now
    team.tell(0, Arrived())
    assert agent.done


def test_a_robot_near_home_whose_place_is_taken_waits_and_tries_again() -> None:
    team = home_team()
    agent = team.agents[0]
    team.tell(0, Arrived())
    assert state(agent) is State.RETURNING
    assert last_goal(team.driven[0][-1]) is None
    team.run(3.5)
    assert last_goal(team.driven[0][-1]) == (2.0, 2.0)


def test_a_robot_that_finds_no_way_home_stays_where_it_is_in_the_end() -> None:
    team = home_team()
    agent = team.agents[0]
    toy(agent).no_way = True
    team.tell(0, Stuck())
    assert state(agent) is State.RETURNING
    team.run(40.0)
    assert agent.done


def test_a_robot_that_is_done_stays_done_when_it_has_to_make_room_too_long() -> None:
    team, _, belief = toy_team(Tree.chain(2))
    belief[:] = 0.0
    team.run(8.0)
    agent = team.agents[0]
    ground(agent).driver.refuge = np.array([(1.0, 1.0)])
    ground(agent).driver.yielding_since = team.now
    team.tell(0, Stuck())
    assert agent.done
    assert not ground(agent).driver.yielding


def corridor(width: int = 8) -> NDArray[np.bool_]:
    """A corridor along x through the map, ``width`` cells of it passable."""
    passable = np.zeros(FRAME.shape, np.bool_)
    passable[10 : 10 + width] = True
    passable[10:25, 15:25] = True  # a niche to wait in
    return passable


def mate(robot: int, x: float, y: float, to_x: float, heard: float) -> Mate:
    """A team-mate that drives along x."""
    return Mate(robot, x, y, 0.0, (0, 0, round(100 * (to_x - x)), 0), 0.0, 0.2, 0.5, heard)


def test_the_higher_index_makes_room_in_a_corridor_and_goes_on_when_the_mate_has_passed() -> None:
    passable = corridor(5)
    driver = Driver(1, PlatformSpec())
    wanted = Route(np.array([(2.0, 1.25), (0.3, 1.25)]), passable, FRAME)
    driver.go(wanted)
    drive = driver.look_out(Pose(2.0, 1.25, np.pi), [mate(0, 0.8, 1.25, 3.7, 0.0)], wanted, 0.0)
    assert drive is not None
    assert driver.yielding
    assert drive.route is not None
    assert drive.route.path[-1][1] > 1.6  # in the niche
    drive = driver.look_out(Pose(2.0, 2.1, 0.0), [mate(0, 3.5, 1.25, 3.9, 5.0)], wanted, 5.0)
    assert drive == Drive(wanted) or (drive is not None and drive.route is wanted)
    assert not driver.yielding


def test_a_robot_that_makes_room_again_at_the_same_place_has_done_so_all_along() -> None:
    driver = Driver(1, PlatformSpec())
    wanted = Route(np.array([(2.0, 1.25), (0.3, 1.25)]), corridor(5), FRAME)

    def meet(x: float, now: float) -> None:
        driver.look_out(Pose(x, 1.25, np.pi), [mate(0, x - 1.2, 1.25, x + 1.7, now)], wanted, now)
        assert driver.yielding

    def part(x: float, now: float) -> None:
        driver.look_out(Pose(x, 1.25, np.pi), [mate(0, 4.5, 1.25, 4.9, now)], wanted, now)
        assert not driver.yielding

    driver.go(wanted)
    meet(2.0, 0.0)
    part(2.0, 5.0)
    meet(1.9, 8.0)
    assert driver.yielding_since == 3.0
    part(1.9, 10.0)
    assert driver._yielded_before(np.array((1.9, 1.25)) + ON_ITS_WAY) == 0.0


def test_no_room_is_made_for_a_mate_that_has_been_silent() -> None:
    driver = Driver(1, PlatformSpec())
    wanted = Route(np.array([(2.0, 1.25), (0.3, 1.25)]), corridor(5), FRAME)
    driver.go(wanted)
    late = 10.0
    assert driver.look_out(Pose(2.0, 1.25, np.pi), [mate(0, 0.8, 1.25, 3.7, 0.0)], wanted, late) is None


def test_a_robot_that_makes_room_too_long_looks_for_other_work() -> None:
    team = driving_team()
    agent = team.agents[0]
    ground(agent).state = State.YIELDING
    ground(agent).driver.refuge = np.array([(1.0, 1.0)])
    ground(agent).driver.yielding_since = team.now - YIELD_LIMIT - 1.0
    team.run(0.6)
    assert toy(agent).released == 1


@settings(deadline=None, max_examples=100)
@given(seed=st.integers(0, 10**6), length=st.floats(0.0, 5.0))
def test_what_remains_of_a_path_begins_nearest_and_has_the_length_asked_for(seed: int, length: float) -> None:
    rng = np.random.default_rng(seed)
    path = rng.uniform(0.0, 4.0, size=(int(rng.integers(2, 8)), 2))
    x, y = rng.uniform(0.0, 4.0, size=2)
    rest = remaining(path, x, y, length)
    dense = np.vstack([a + np.linspace(0, 1, 200)[:, None] * (b - a) for a, b in itertools.pairwise(path)])
    nearest = np.hypot(*(dense - (x, y)).T).min()
    assert np.hypot(*(rest[0] - (x, y))) == pytest.approx(nearest, abs=0.03)
    assert np.hypot(*np.diff(rest, axis=0).T).sum() <= length + 1e-9
    everything = remaining(path, x, y, np.inf)
    np.testing.assert_array_equal(everything[-1], path[-1])


def test_no_robot_waits_longer_than_five_seconds_for_a_decision_while_the_mission_lasts() -> None:
    team, _, _ = toy_team(Tree.random(6, seed=2))
    times: list[list[float]] = [[] for _ in team.agents]
    for _ in range(300):
        before = team.decisions()
        team.run(0.1)
        for robot, (now, then) in enumerate(zip(team.decisions(), before, strict=True)):
            if now > then:
                times[robot].append(team.now)
    assert max(np.diff([0.0, *each, team.now]).max() for each in times) <= 5.0

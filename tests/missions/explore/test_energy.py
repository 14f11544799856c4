"""Energy: a robot plans no farther than it can come home from, and does come home."""

from __future__ import annotations

import numpy as np
import pytest

from tests.support.small_missions import small_office
from vedette.domains.mapping.budget import RESERVE, RESERVE_SHARE, WayLeft
from vedette.errors import InputError
from vedette.maps import GridFrame
from vedette.outcome import Outcome, together
from vedette.run import Explore
from vedette.team import PlatformSpec

HOME = 0.31  # [m]


def team(*energies: float) -> list[PlatformSpec]:
    """Robots with so much energy each [m]."""
    return [PlatformSpec(name=f"robot-{i + 1}", energy=energy) for i, energy in enumerate(energies)]


def from_home(mission: Explore) -> np.ndarray:
    """How far everybody is from its start [m]."""
    away: np.ndarray = np.hypot(*(mission.poses[:, :2] - mission.simulation.starts[:, :2]).T)
    return away


@pytest.mark.parametrize("energy", [15.0, 25.0])
def test_a_robot_alone_comes_home_with_what_it_has_and_says_that_work_is_left(energy: float) -> None:
    mission = Explore(small_office(), team(energy))
    result = mission.run()
    assert result.outcome is Outcome.SPENT
    assert result.turned_back == ("robot-1",)
    assert result.path_m["robot-1"] <= energy
    assert result.path_m["robot-1"] > 0.5 * energy
    assert from_home(mission)[0] <= HOME


def test_the_others_finish_the_work_of_one_that_has_turned_back() -> None:
    mission = Explore(small_office(), team(10.0, 1e6))
    result = mission.run()
    assert result.outcome is Outcome.COMPLETE
    assert result.turned_back == ("robot-1",)
    assert from_home(mission)[0] <= 1.0  # home, but for room that it may have made
    assert result.coverage is not None
    assert result.coverage > 0.97


def test_who_has_plenty_does_as_if_nobody_had_said_how_much() -> None:
    plenty, endless = (Explore(small_office(), team(energy)).run() for energy in (9e5, 1e6))
    assert plenty.time_s == endless.time_s
    assert plenty.turned_back == ()


def test_watt_hours_are_a_way_by_what_a_metre_costs() -> None:
    assert PlatformSpec(energy=30.0, drain=0.5).way == 60.0
    assert PlatformSpec().way == float("inf")
    with pytest.raises(InputError, match=r"drain must be 0\.001 to 10000 Wh/m; got 0"):
        PlatformSpec(drain=0.0)


def test_a_place_is_affordable_if_the_way_there_and_home_and_the_reserve_are_left() -> None:
    frame = GridFrame(1.0, 1, 20)
    budget = WayLeft(20.0)
    for x in (0.5, 1.5, 2.5):
        budget.move(x, 0.5)
    budget.look(frame, np.ones(frame.shape, np.bool_))
    assert (budget.home, budget.used, budget.left) == ((0.5, 0.5), 2.0, 18.0)
    places = np.array([(x + 0.5, 0.5) for x in range(20)])
    ways = np.abs(places[:, 0] - 2.5)
    home = places[:, 0] - 0.5
    expected = ways + RESERVE + (1.0 + RESERVE_SHARE) * home <= 18.0
    np.testing.assert_array_equal(budget.affords(places, ways), expected)
    assert 3 < expected.sum() < 20


def test_a_team_of_which_all_have_turned_back_has_left_work() -> None:
    assert together([Outcome.SPENT, Outcome.SPENT]) is Outcome.SPENT
    assert together([Outcome.SPENT, Outcome.COMPLETE]) is Outcome.COMPLETE
    assert together([Outcome.SPENT, Outcome.ORDERED]) is Outcome.SPENT
    assert together([Outcome.SPENT, Outcome.UNREACHED]) is Outcome.UNREACHED

"""Many robots and little room: nobody is left standing, and missions end soon after the last that is seen."""

from __future__ import annotations

import pytest

from bench.crowds import Crowd, CrowdResult, run_crowd
from tests.support.small_missions import robots, run, two_rooms


@pytest.mark.parametrize(("team", "seed"), [(3, 0), (3, 5), (3, 7), (5, 1)])
def test_a_team_in_a_small_room_with_one_narrow_way_on_is_done_within_a_minute(team: int, seed: int) -> None:
    _, report = run(two_rooms(0.45, 0.05), robots(team), seed=seed)
    summary = report.summary
    assert summary.outcome.value == "complete"
    assert summary.coverage >= 0.995
    assert summary.collisions == 0
    assert summary.time_s <= 60.0


def check_crowd(result: CrowdResult) -> None:
    assert result.outcome == "complete"
    assert result.coverage >= 0.99
    assert result.collisions == 0
    assert result.never_left == 0
    assert result.standing_s <= 40.0


@pytest.mark.slow
@pytest.mark.parametrize("world", ["office", "cave", "maze"])
@pytest.mark.parametrize("seed", [0, 1])
def test_all_of_twenty_robots_leave_their_start_and_stand_for_40_s_at_most_in_the_end(
    world: str, seed: int
) -> None:
    check_crowd(run_crowd(Crowd(world, 20, seed), "test"))


@pytest.mark.slow
def test_all_of_forty_robots_leave_their_start() -> None:
    check_crowd(run_crowd(Crowd("cave", 40, 0), "test"))

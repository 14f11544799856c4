"""Hard days of real processes: stopped for minutes, killed in the middle of a round, late, on a full disk.

Each prints a line of the table in ``docs/how-to/faults.md``.
"""

from __future__ import annotations

import os
import signal
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from tests.support.net_processes import (
    Chain,
    Diary,
    Fault,
    Mission,
    freeze,
    misbehaving,
    plan_of,
    root,
    run,
)
from tests.support.small_missions import room_with_a_wall, small_office
from vedette.net.launch import TeamProcesses
from vedette.outcome import Outcome
from vedette.sim.worlds import office

pytestmark = pytest.mark.slow

ROOT, INNER, LEAF = 2, 1, 0  # of three in a chain, the highest number becomes the root
MINUTES = 100.0  # [s]
UNHURRIED = 0.25  # times real time, at which twenty agents have room on two cores
ROOM = room_with_a_wall(0.1)


def tell(what: str, mission: Mission) -> None:
    """Print how a mission went."""
    summary, diary = mission.report.summary, mission.diary
    rounds = {i + 1: diary.last(i).rounds for i in sorted(diary.by_robot)}
    print(
        f"\n{what}: {summary.outcome} after {summary.time_s:.0f} s, {100 * summary.coverage:.1f} %, "
        f"lost {list(summary.lost)}, left {list(summary.left)}, rounds {rounds}"
    )


def check_whole(mission: Mission, robots: list[int]) -> None:
    """These are done, have the whole map, and hold the same one."""
    assert all(mission.diary.last(i).state == "done" for i in robots)
    assert mission.diary.agree(robots)
    assert mission.report.summary.coverage >= 0.99
    assert mission.report.summary.map_errors == 0


def test_the_root_is_stopped_for_minutes_and_takes_its_place_again(tmp_path: Path) -> None:
    struck: list[int] = []

    def strike(diary: Diary) -> None:
        struck.append(root(diary))
        freeze(root, MINUTES)(diary)

    faults = [Fault(0.3, "stop", strike)]
    mission = run(plan_of(ROOM, 3), tmp_path, faults, rest=MINUTES + 20.0)
    tell(f"SIGSTOP of the root for {MINUTES:.0f} s", mission)
    others = [i for i in range(3) if i not in struck]
    assert mission.report.summary.outcome is Outcome.UNHEARD  # it was not heard when the others were done
    assert mission.report.summary.lost == tuple(f"robot-{i + 1}" for i in struck)
    assert all(mission.diary.last(i).state == "done" for i in range(3))
    assert mission.report.summary.coverage >= 0.99  # in its map its body stands where it was stopped
    assert mission.diary.agree(others)
    assert mission.diary.agree(range(3))  # by now
    assert {mission.diary.last(i).size for i in range(3)} == {3}


@pytest.mark.parametrize("who", [ROOT, INNER, LEAF], ids=["root", "inner", "leaf"])
@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM], ids=lambda each: each.name)
def test_a_process_ends_in_the_middle_of_a_round(number: signal.Signals, who: int, tmp_path: Path) -> None:
    team = misbehaving(f"ends={number.name}", who, Chain)
    mission = run(plan_of(ROOM, 3), tmp_path, team=team)
    tell(f"{number.name} of robot {who + 1} of a chain in the middle of a round", mission)
    summary = mission.report.summary
    gone = summary.lost if number is signal.SIGKILL else summary.left
    assert gone == (f"robot-{who + 1}",)
    others = [i for i in range(3) if i != who]
    assert mission.survivors == others
    if who == INNER:  # nothing joins the two others any more
        assert summary.outcome in (Outcome.MAPS_DIFFER, Outcome.COMPLETE)
        assert all(mission.diary.last(i).state == "done" for i in others)
    else:
        assert summary.outcome is Outcome.COMPLETE
        check_whole(mission, others)


def test_all_but_one_are_killed_at_once_and_it_finishes_alone(tmp_path: Path) -> None:
    def strike(diary: Diary) -> None:
        for i in (1, 2):
            os.kill(diary.pid(i), signal.SIGKILL)

    mission = run(plan_of(ROOM, 3), tmp_path, [Fault(0.3, "kill", strike)])
    tell("kill -9 of all but one", mission)
    assert mission.report.summary.outcome is Outcome.COMPLETE
    assert mission.report.summary.lost == ("robot-2", "robot-3")
    check_whole(mission, [0])


def test_who_starts_late_joins_the_team_and_gets_the_whole_map(tmp_path: Path) -> None:
    mission = run(plan_of(small_office(), 3), tmp_path, team=misbehaving("late=12", ROOT))
    tell("one starts 12 s late", mission)
    assert mission.report.summary.outcome is Outcome.COMPLETE
    check_whole(mission, [0, 1, 2])


def test_twenty_processes_are_twenty_contributors_to_one_map(tmp_path: Path) -> None:
    mission = run(plan_of(office(np.random.default_rng(0)), 20, UNHURRIED), tmp_path, max_time=600.0)
    tell("a team of twenty", mission)
    assert mission.report.summary.outcome is Outcome.COMPLETE
    assert mission.diary.agree(range(20))
    assert mission.report.summary.coverage >= 0.99
    assert {mission.diary.last(i).size for i in range(20)} == {20}


class OnAFullDisk(TeamProcesses):
    """What the second robot says does not fit anywhere."""

    def log_of(self, robot: int) -> Path:
        """Return the file of what a robot's process says."""
        return Path("/dev/full") if robot == 1 else super().log_of(robot)


def test_a_robot_whose_disk_is_full_goes_on(tmp_path: Path) -> None:
    mission = run(plan_of(ROOM, 2), tmp_path, team=OnAFullDisk)
    tell("a full disk under a robot's log", mission)
    assert mission.report.summary.outcome is Outcome.COMPLETE
    check_whole(mission, [0, 1])


@pytest.mark.parametrize("seconds", [3600.0, -3600.0], ids=["ahead", "back"])
def test_a_clock_that_is_stepped_by_an_hour_changes_nothing_but_a_warning(
    seconds: float, tmp_path: Path
) -> None:
    mission = run(plan_of(small_office(), 3), tmp_path, team=misbehaving(f"stepped={seconds:g}", ROOT))
    tell(f"a clock that is stepped by {seconds:+g} s", mission)
    assert mission.report.summary.outcome is Outcome.COMPLETE
    check_whole(mission, [0, 1, 2])


def in_two_teams(first: Callable[[], Mission], second: Callable[[], Mission]) -> list[Mission]:
    """Run two missions at once."""
    with ThreadPoolExecutor(2) as pool:
        return [each.result() for each in (pool.submit(first), pool.submit(second))]


def test_two_teams_of_one_name_on_one_host_do_not_hear_each_other(tmp_path: Path) -> None:
    plan = plan_of(ROOM, 2)
    missions = in_two_teams(
        lambda: run(plan, tmp_path / "one"), lambda: run(plan, tmp_path / "two", team=Chain)
    )
    for mission in missions:
        tell("two teams of one name on one host", mission)
        assert mission.report.summary.outcome is Outcome.COMPLETE
        check_whole(mission, [0, 1])
        assert {mission.diary.last(i).size for i in (0, 1)} == {2}

"""Teams over real rclpy, in bodies that are none of ours; `make test-ros2` has an environment for it."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.support.ros2_beside import Beside
from tests.support.ros2_teams import TRIED, WRONG, living, plan, sound, tried
from tests.support.small_missions import TWO_ROOMS, drawn, small_maze, small_office
from vedette.align import FramePose
from vedette.maps import FREE, UNKNOWN, read_map
from vedette.outcome import Outcome

pytest.importorskip("rclpy", reason="`make test-ros2` has rclpy", exc_type=ImportError)


def test_robots_on_real_rclpy_explore_two_rooms_and_map_them_as_they_are(tmp_path: Path) -> None:
    drawn(TWO_ROOMS).save(tmp_path)
    out = tmp_path / "out"
    command = [sys.executable, "-m", "vedette", "team", "explore", str(tmp_path / "map.yaml"), "--ros2"]
    options = ["--json", "--robots", "2", "--speed", "3", "--max-time", "300", "--out", str(out)]
    ended = subprocess.run(
        [*command, *options],
        capture_output=True,
        text=True,
        timeout=TRIED,
        check=False,
        env=dict(os.environ),
    )
    assert ended.returncode == 0, (ended.stdout, ended.stderr)
    summary: dict[str, Any] = json.loads(ended.stdout)
    assert summary["outcome"] == "complete"
    assert summary["coverage"] is None
    _, told = read_map(out / "map.yaml")
    _, true = read_map(tmp_path / "map.yaml")
    known = told != UNKNOWN
    assert np.mean(told[known] != true[known]) <= WRONG
    assert np.mean(known[true == FREE]) >= 0.99
    said = (out / "agents" / "robots.log").read_text()
    assert said.count("collided: False") == 2, said


@pytest.mark.parametrize("evidence", ["scan", "map"])
def test_robots_whose_maps_lie_anywhere_find_how_they_lie_and_tell_it_on_tf(
    tmp_path: Path, evidence: str
) -> None:
    odd = {i: {"slam": evidence == "map"} for i in range(2)}
    settings = {i: {"evidence": evidence} for i in range(2)}
    team = plan(small_office(), 2, frames="unknown", oddities=odd, settings=settings)
    heard: list[tuple[str, str, float, float]] = []
    beside = Beside("robot2")
    try:
        beside.hear_frames(heard)
        ended = tried(team, tmp_path, befall=lambda now: beside.listen())
    finally:
        beside.close()
    assert ended.report.summary.outcome is Outcome.COMPLETE, ended.robots_said
    assert ended.report.summary.map_error_share <= 0.01
    assert ended.covered >= 0.99
    assert ended.robots_said.count("collided: False") == 2, ended.robots_said
    found = ended.report.summary.frames
    assert found is not None
    assert found.components == (("robot-1", "robot-2"),)
    assert found.error_m is not None
    assert found.error_m <= 0.1
    joints = [(x, y) for parent, child, x, y in heard if (parent, child) == ("team", "map")]
    one, other = (FramePose.of(*start) for start in team.starts.tolist())
    true = one.inverse().after(other)
    assert joints
    assert all(np.hypot(x - true.x, y - true.y) <= 0.5 for x, y in joints)
    assert np.hypot(joints[-1][0] - true.x, joints[-1][1] - true.y) <= 0.1
    assert not [parent for parent, *_ in heard if parent.startswith("team_")]


def test_a_robots_own_map_is_its_evidence_and_a_mistake_of_half_a_metre_and_five_degrees_is_undone(
    tmp_path: Path,
) -> None:
    odd = {"slam": True, "lost": [15.0, 0.4, 0.3, 5.0]}
    team = plan(drawn(TWO_ROOMS), 1, oddities={0: odd}, settings={0: {"evidence": "map"}})
    sound(tried(team, tmp_path), 1)


def test_who_stands_beside_a_robot_sees_the_teams_map_and_can_pause_recall_and_stop_it(
    tmp_path: Path,
) -> None:
    beside = Beside()
    try:
        with living(plan(small_maze(), 1, speed=2.0), tmp_path) as team:
            beside.until(lambda: beside.known > 500, "no map")
            beside.until(lambda: beside.speed > 0.1, "it does not drive")
            beside.say("pause")
            beside.until(lambda: beside.speed == 0.0, "it does not pause")
            assert beside.stays(lambda: beside.speed == 0.0)
            beside.say("resume")
            beside.until(lambda: beside.speed > 0.1, "it does not resume")
            beside.say("recall")
            beside.until(lambda: np.hypot(*beside.at) < 0.3 and beside.speed == 0.0, "it does not come back")
            beside.say("stop")
            beside.until(lambda: not team.runs(0), "the agent does not stop")
            assert team.processes[0].poll() == 0
    finally:
        beside.close()


@pytest.mark.slow
@pytest.mark.parametrize("robots", [3, 5])
def test_robots_see_each_other_and_map_none_of_them(tmp_path: Path, robots: int) -> None:
    sound(tried(plan(small_office(), robots), tmp_path), robots)


@pytest.mark.slow
def test_a_simulation_may_run_at_five_times_real_time_or_as_fast_as_it_can(tmp_path: Path) -> None:
    sound(tried(plan(drawn(TWO_ROOMS), 2, speed=5.0), tmp_path), 2)

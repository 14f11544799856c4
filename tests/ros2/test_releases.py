"""Agents of two releases of ROS 2 in one team; `make test-all` has both."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from tests.support.ros2_teams import plan, sound, tried
from tests.support.small_missions import TWO_ROOMS, drawn
from vedette.net.launch import TeamProcesses

pytest.importorskip("rclpy", reason="`make test-ros2` has rclpy", exc_type=ImportError)
JAZZY = os.environ.get("JAZZY", "")


class Mixed(TeamProcesses):
    """Whose second agent has the rclpy of Jazzy, and all others that of this process."""

    def _command(self, i: int) -> list[str]:
        command = super()._command(i)
        if i != 1:
            return command
        there = [f"LD_LIBRARY_PATH={JAZZY}/lib", f"AMENT_PREFIX_PATH={JAZZY}"]
        return ["env", "--unset=_ROS_WHEELS_BOOTSTRAP_COMPLETE", *there, f"{JAZZY}/bin/python", *command[1:]]


@pytest.mark.slow
@pytest.mark.skipif(not JAZZY, reason="JAZZY names no environment")
def test_agents_of_jazzy_and_of_kilted_explore_as_one_team(tmp_path: Path) -> None:
    ended = tried(plan(drawn(TWO_ROOMS), 2), tmp_path, team=Mixed)
    sound(ended, 2)
    assert min(ended.report.summary.path_m.values()) > 0.0

"""Robots, agents and networks that die over real rclpy, and come back."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest

from tests.support.relay import Relay
from tests.support.ros2_beside import Beside
from tests.support.ros2_teams import DOMAIN, TRIED, living, plan, sound, tried
from tests.support.small_missions import small_maze
from vedette.net.explore.ros2_plan import environment, strangers
from vedette.net.launch import TeamProcesses

pytest.importorskip("rclpy", reason="`make test-ros2` has rclpy", exc_type=ImportError)
pytestmark = pytest.mark.slow


def test_an_agent_that_is_killed_and_started_again_drives_again_and_the_check_finds_all_it_needs(
    tmp_path: Path,
) -> None:
    beside = Beside()
    try:
        with living(plan(small_maze(), 1, speed=2.0), tmp_path) as team:
            beside.until(lambda: beside.speed > 0.1, "it does not drive")
            team.signal(0, signal.SIGKILL)
            beside.until(lambda: not team.runs(0), "the agent lives")
            beside.until(lambda: beside.stays(lambda: beside.speed == 0.0), "its last goal has no end")
            around = {**os.environ, **environment(DOMAIN)}
            command = [sys.executable, "-m", "vedette", "ros2", "check"]
            checked = subprocess.run(
                [*command, str(tmp_path / "private" / "robot-1.yaml")],
                capture_output=True,
                text=True,
                timeout=TRIED,
                check=False,
                env=around,
            )
            assert checked.returncode == 0, checked.stdout
            assert "/robot1/navigate_to_pose is there" in checked.stdout
            beside.known = 0
            team.restart(0)
            beside.until(lambda: beside.speed > 0.1, "it does not drive again")
            beside.until(lambda: beside.known > 500, "it shows no map")
    finally:
        beside.close()


def test_a_robot_whose_software_dies_and_is_started_again_is_driven_on(tmp_path: Path) -> None:
    """All of it: scans, frames, clock and navigator; the robot is carried back to where it began."""
    beside = Beside()
    team, private, logs = plan(small_maze(), 1, speed=2.0), tmp_path / "private", tmp_path / "logs"
    private.mkdir()
    team.write(private)
    around = environment(DOMAIN)
    try:
        with ExitStack() as stack:
            with strangers(private, logs / "first.log", team.speed, around) as robots:
                processes = stack.enter_context(TeamProcesses(team, private, logs, None, around))
                beside.until(lambda: beside.known > 1500, "no map")
                robots.kill()
                robots.wait()
            beside.stays(lambda: True, 3.0)
            assert processes.runs(0)
            beside.speed = 0.0
            stack.enter_context(strangers(private, logs / "second.log", team.speed, around))
            beside.until(lambda: beside.speed > 0.1, "it does not drive again")
            known = beside.known
            beside.until(lambda: beside.known > known + 500, "it maps nothing more")
            assert processes.runs(0)
    finally:
        beside.close()


def test_a_network_that_is_gone_for_a_while_parts_robots_and_they_finish_together(tmp_path: Path) -> None:
    with Relay() as relay:

        class Relayed(TeamProcesses):
            """Whose second robot reaches the first by a line that can be cut."""

            def _links(self, i: int) -> dict[str, Any]:
                links = super()._links(i)
                if i == 1:
                    relay.leads_to(int(self.endpoints[0].rsplit(":", 1)[1]))
                    links["connect"] = [f"tls/127.0.0.1:{relay.port}"]
                return links

        cut: list[float] = []

        def befall(now: float) -> None:
            if not cut and now > 8.0:
                relay.cut()
                cut.append(time.monotonic())
            elif len(cut) == 1 and time.monotonic() > cut[0] + 8.0:
                relay.mend()
                cut.append(time.monotonic())

        ended = tried(plan(small_maze(), 2, speed=2.0), tmp_path, team=Relayed, befall=befall)
    assert len(cut) == 2
    assert ended.report.summary.apart_s > 0.0
    sound(ended, 2)

"""Teams over real rclpy, in bodies that are none of ours; `make test-ros2` has an environment for it."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.support.ros2_teams import DOMAIN, Tried, living, plan, tried
from tests.support.small_missions import TWO_ROOMS, drawn, small_maze
from vedette.maps import FREE, UNKNOWN, read_map
from vedette.net.explore.ros2_plan import environment
from vedette.outcome import Outcome

pytest.importorskip("rclpy", reason="`make test-ros2` has rclpy", exc_type=ImportError)

WRONG = 0.005  # of the known cells may be other ones in truth
TRIED = 240  # a test may take so long [s]


def sound(ended: Tried, robots: int, outcome: Outcome = Outcome.COMPLETE) -> None:
    summary = ended.report.summary
    assert summary.outcome is outcome, (summary, ended.robots_said)
    assert summary.coverage is None  # the robots do not know how large the building is
    assert ended.covered >= 0.99
    assert ended.wrong <= WRONG
    assert ended.robots_said.count("collided: False") == robots, ended.robots_said


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


def test_a_robots_own_map_is_its_evidence_and_a_mistake_of_half_a_metre_and_five_degrees_is_undone(
    tmp_path: Path,
) -> None:
    odd = {"slam": True, "lost": [15.0, 0.4, 0.3, 5.0]}
    team = plan(drawn(TWO_ROOMS), 1, oddities={0: odd}, settings={"evidence": "map"})
    sound(tried(team, tmp_path), 1)


class Beside:
    """Somebody who uses the robot's ROS, with nothing of Vedette."""

    def __init__(self) -> None:
        import rclpy
        from nav_msgs.msg import OccupancyGrid, Odometry
        from rclpy.executors import SingleThreadedExecutor
        from rclpy.qos import DurabilityPolicy, QoSProfile
        from std_srvs.srv import Trigger

        self.context = rclpy.Context()
        rclpy.init(context=self.context, domain_id=DOMAIN)
        self.node = rclpy.create_node("beside", namespace="robot1", context=self.context)
        self.executor = SingleThreadedExecutor(context=self.context)
        self.executor.add_node(self.node)
        self.trigger = Trigger
        self.known, self.speed, self.at = 0, 0.0, (0.0, 0.0)
        late = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.node.create_subscription(OccupancyGrid, "vedette/team_map", self.hear_map, late)
        self.node.create_subscription(Odometry, "odom", self.hear_odometry, 10)

    def hear_map(self, message: Any) -> None:
        self.known = int(np.count_nonzero(np.asarray(message.data) >= 0))

    def hear_odometry(self, message: Any) -> None:
        self.speed = abs(message.twist.twist.linear.x) + abs(message.twist.twist.angular.z)
        self.at = message.pose.pose.position.x, message.pose.pose.position.y

    def until(self, holds: Callable[[], bool], what: str, patience: float = 90.0) -> None:
        end = time.monotonic() + patience
        while not holds():
            assert time.monotonic() < end, what
            self.executor.spin_once(timeout_sec=0.1)

    def stays(self, holds: Callable[[], bool], span: float = 3.0) -> bool:
        end = time.monotonic() + span
        while time.monotonic() < end:
            self.executor.spin_once(timeout_sec=0.1)
            if not holds():
                return False
        return True

    def say(self, word: str) -> None:
        client = self.node.create_client(self.trigger, f"vedette/{word}")
        assert client.wait_for_service(timeout_sec=20.0), word
        said = client.call_async(self.trigger.Request())
        self.until(said.done, word)
        assert said.result().success

    def close(self) -> None:
        self.executor.shutdown()
        self.node.destroy_node()
        self.context.try_shutdown()


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


@pytest.mark.slow
@pytest.mark.parametrize(
    "odd",
    [
        {"upside_down": True, "mount": [0.1, 0.05, 20.0]},
        {"view": 180.0, "mount": [0.12, 0.0, 0.0]},
        {"prefix": "robot1/"},
        {"active_from": 20.0},
        {"rate": 2.0, "beams": 90},
    ],
    ids=["upside down and off centre", "half a view", "prefixed frames", "inactive for 20 s", "few beams"],
)
def test_an_odd_robot_maps_two_rooms_as_they_are(tmp_path: Path, odd: Mapping[str, Any]) -> None:
    sound(tried(plan(drawn(TWO_ROOMS), 1, oddities={0: odd}), tmp_path), 1)


@pytest.mark.slow
def test_three_robots_see_each_other_and_map_none_of_them(tmp_path: Path) -> None:
    sound(tried(plan(drawn(TWO_ROOMS), 3), tmp_path), 3)

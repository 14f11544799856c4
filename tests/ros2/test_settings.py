"""A robot's file with ``body.ros2``: what it may say, and one line for what it may not."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import pytest
from click.testing import CliRunner

from tests.support.small_missions import TWO_ROOMS, drawn
from vedette.cli import commands
from vedette.errors import InputError
from vedette.net.config import load_config
from vedette.ros2.settings import Ros2Settings

HEAD = "team: t\nrobot: 1\nlinks: {insecure: true}\n"


def written(folder: Path, body: str, more: str = "") -> Path:
    path = folder / "robot.yaml"
    path.write_text(f"{HEAD}body: {body}\n{more}")
    return path


def test_every_key_has_the_usual_default(tmp_path: Path) -> None:
    told = load_config(written(tmp_path, "{ros2: {}}")).body.ros2
    assert told == Ros2Settings()
    assert (told.scan, told.base_frame, told.odom_frame, told.map_frame, told.navigate_to_pose) == (
        "scan",
        "base_link",
        "odom",
        "map",
        "navigate_to_pose",
    )


@pytest.mark.parametrize(
    ("body", "more", "said"),
    [
        ("{ros2: {namespase: robot1}}", "", "did you mean 'namespace'"),
        ("{ros2: {namespace: 'robot 1'}}", "", "namespace"),
        ("{ros2: {scan: ''}}", "", "scan"),
        ("{ros2: {no_return: far}}", "", "no_return"),
        ("{ros2: {evidence: both}}", "", "evidence"),
        ("{ros2: {start: [1, 2]}}", "", "start"),
        ("{ros2: {}, map: map.yaml}", "", "body.map: is the world of a simulated robot"),
        ("{ros2: {evidence: map}}", "explore: {fusion: channel}\n", "cannot take back"),
        (
            "{ros2: {start: [1, 2, 90]}}",
            "explore: {frames: unknown}\n",
            "start: lies in a frame that nobody has",
        ),
    ],
)
def test_what_cannot_be_is_refused_in_one_line_that_names_it(
    tmp_path: Path, body: str, more: str, said: str
) -> None:
    with pytest.raises(InputError, match=said) as raised:
        load_config(written(tmp_path, body, more))
    assert "\n" not in str(raised.value)


def test_a_robots_own_map_may_be_its_only_frame(tmp_path: Path) -> None:
    told = load_config(written(tmp_path, "{ros2: {evidence: map}}", "explore: {frames: unknown}\n"))
    assert told.explore is not None
    assert told.explore.frames == "unknown"


@pytest.mark.skipif(importlib.util.find_spec("rclpy") is not None, reason="this Python has rclpy")
@pytest.mark.parametrize("command", [["agent"], ["ros2", "check"]])
def test_without_rclpy_one_line_says_how_to_get_it(tmp_path: Path, command: list[str]) -> None:
    ended = CliRunner().invoke(commands, [*command, str(written(tmp_path, "{ros2: {}}"))])
    assert isinstance(ended.exception, InputError)
    assert "no rclpy; start it where ROS 2 is set up" in str(ended.exception)


@pytest.mark.skipif(importlib.util.find_spec("rclpy") is not None, reason="this Python has rclpy")
def test_without_rclpy_no_team_is_shown_and_one_line_says_what_it_needs(tmp_path: Path) -> None:
    drawn(TWO_ROOMS).save(tmp_path)
    options = ["--ros2", "--robots", "1", "--out", str(tmp_path / "out")]
    ended = CliRunner().invoke(commands, ["team", "explore", str(tmp_path / "map.yaml"), *options])
    assert isinstance(ended.exception, InputError)
    assert "they need rclpy, nav2_msgs, tf2_msgs and the extra ros2-robots" in str(ended.exception)
    assert "\n" not in str(ended.exception)
    assert not (tmp_path / "out").exists()  # nothing of a mission that there was not

"""Why a goal was given up, by each release's own result."""

from __future__ import annotations

from dataclasses import dataclass

import pytest

from tests.support.ros2_doors import FakeDoor, at
from tests.support.ros2_routes import route
from vedette.agent.events import Pose, Stuck
from vedette.ros2.body import Ros2Body
from vedette.ros2.door import Answer, GoalStatus, Reason
from vedette.ros2.goals import ActionStatus
from vedette.ros2.reasons import reason_of
from vedette.ros2.settings import Ros2Settings
from vedette.team import PlatformSpec


@dataclass
class Humble:
    """Its ``NavigateToPose.Result`` has ``std_msgs/Empty result`` and nothing else."""

    result: object = None


@dataclass
class Jazzy:
    """A code."""

    error_code: int


@dataclass
class Kilted(Jazzy):
    """A code and words."""

    error_msg: str


@pytest.mark.parametrize(
    ("result", "said"),
    [
        (Humble(), ""),
        (Jazzy(0), ""),
        (Jazzy(9000), "code 9000"),
        (Jazzy(9002), "it lacks a transform, code 9002"),
        (Jazzy(208), "its planner finds no way, code 208"),
        (Kilted(105, ""), "the robot made no progress, code 105"),
        (Kilted(9003, "late\nby 3 s"), "it took too long, code 9003, late by 3 s"),
    ],
)
def test_each_releases_result_says_what_it_can_in_one_line(result: object, said: str) -> None:
    assert reason_of(result) == said


def test_a_robot_is_stuck_at_once_and_the_reason_is_shown_when_it_comes_if_it_still_matters() -> None:
    door = FakeDoor(at(1.0, 0.0))
    body = Ros2Body(PlatformSpec(), Ros2Settings(), door)
    body.sense(0.0)
    body.carry_out(route((0.0, 0.0), (0.0, 2.0)), 0.1)
    door.told = [Answer(1, accepted=True), GoalStatus(1, ActionStatus.ABORTED)]
    assert [type(event) for event in body.sense(0.2)] == [Pose, Stuck]
    assert body.goals.said == "the navigator gave the goal up"
    door.told = [Reason(1, "code 9000")]
    body.sense(0.3)
    assert body.goals.said == "the navigator gave the goal up: code 9000"
    body.carry_out(route((0.0, 0.0), (0.0, 1.0)), 0.4)
    door.told = [Answer(2, accepted=True), GoalStatus(2, ActionStatus.SUCCEEDED), Reason(1, "late")]
    body.sense(0.5)
    assert body.goals.said == ""

"""A robot's real body, from its file."""

from __future__ import annotations

from collections.abc import Callable

from vedette.agent import Agent
from vedette.net.config import AgentConfig
from vedette.net.names import robot_name
from vedette.ros2.body import Ros2Body
from vedette.ros2.robot import ros2_body
from vedette.ros2.showing import showing


def real_robot(config: AgentConfig) -> Ros2Body:
    """Return the robot that a file describes, as soon as it tells what is needed.

    Raises:
        InputError: it does not.
    """
    assert config.body.ros2 is not None
    return ros2_body(config.body.spec(robot_name(config.robot - 1)), config.body.ros2)


def shows(config: AgentConfig, body: Ros2Body) -> Callable[[Agent], Callable[[float], None]]:
    """Return what shows the robot's agent to those beside the robot."""
    return showing(body, robot_name(config.robot - 1))

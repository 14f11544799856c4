"""A robot's real body, from its file."""

from __future__ import annotations

from vedette.net.config import AgentConfig
from vedette.net.names import robot_name
from vedette.ros2.body import Ros2Body
from vedette.ros2.robot import ros2_body

RESOLUTION = 0.1  # of the map [m]


def real_robot(config: AgentConfig) -> Ros2Body:
    """Return the robot that a file describes, as soon as it tells what is needed.

    Raises:
        InputError: it does not.
    """
    assert config.body.ros2 is not None
    return ros2_body(config.body.spec(robot_name(config.robot - 1)), config.body.ros2)

"""A robot's real body, from its file."""

from __future__ import annotations

from math import ceil

from vedette.maps import GridFrame
from vedette.net.config import AgentConfig
from vedette.net.names import robot_name
from vedette.ros2.body import Ros2Body
from vedette.ros2.robot import ros2_body

RESOLUTION = 0.1  # of the map [m]
ROUNDING = 1e-6  # less of a cell is none


def real_robot(config: AgentConfig) -> Ros2Body:
    """Return the robot that a file describes, as soon as it tells what is needed.

    Raises:
        InputError: it does not.
    """
    assert config.body.ros2 is not None
    return ros2_body(config.body.spec(robot_name(config.robot - 1)), config.body.ros2)


def real_frame(config: AgentConfig) -> GridFrame:
    """Return the grid of the team's map."""
    assert config.body.ros2 is not None
    left, lower, right, upper = config.body.ros2.area
    side = config.body.resolution or RESOLUTION
    rows, cols = (ceil(length / side - ROUNDING) for length in (upper - lower, right - left))
    return GridFrame(side, rows, cols, left, lower)

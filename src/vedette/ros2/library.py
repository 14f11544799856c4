"""The robot's own rclpy and messages: imported when a body is made, not before."""

from __future__ import annotations

import importlib
from typing import Any

from vedette.errors import InputError

HOW = "start it where ROS 2 is set up: source /opt/ros/<distro>/setup.bash"


def ros(name: str) -> Any:
    """Return a module of the robot's ROS.

    Raises:
        InputError: this Python does not have it; the line says how to get it.
    """
    try:
        return importlib.import_module(name)
    except ImportError as error:
        missing = error.name if isinstance(error, ModuleNotFoundError) else f"{name}: {error}"
        raise InputError(f"body.ros2: this Python has no {missing}; {HOW}") from None

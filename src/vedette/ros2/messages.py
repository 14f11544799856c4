"""Messages of ROS as plain values, whichever library has read them: their fields go by the same names."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from vedette.ros2.door import Joint
from vedette.ros2.scans import LaserSweep
from vedette.ros2.transforms import matrix


def seconds(stamp: Any) -> float:
    """Return a ``builtin_interfaces/Time`` [s]."""
    return float(stamp.sec) + 1e-9 * float(stamp.nanosec)


def sweep_of(message: Any) -> LaserSweep:
    """Return a ``sensor_msgs/LaserScan``."""
    return LaserSweep(
        message.header.frame_id,
        seconds(message.header.stamp),
        message.angle_min,
        message.angle_increment,
        message.time_increment,
        message.range_min,
        message.range_max,
        np.asarray(message.ranges, np.float64),
    )


def joints_of(message: Any, *, fixed: bool) -> Iterator[Joint]:
    """Yield the transforms of a ``tf2_msgs/TFMessage``; one whose quaternion is 0 is left out."""
    for told in message.transforms:
        t, q = told.transform.translation, told.transform.rotation
        quaternion = (q.x, q.y, q.z, q.w)
        if any(quaternion):
            T = matrix((t.x, t.y, t.z), quaternion)
            yield Joint(told.header.frame_id, told.child_frame_id, seconds(told.header.stamp), T, fixed)

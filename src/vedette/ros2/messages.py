"""Messages of ROS as plain values, whichever library has read them: their fields go by the same names."""

from __future__ import annotations

from collections.abc import Iterator
from math import hypot
from typing import Any

import numpy as np

from vedette.ros2.door import Deviation, Grid, Joint, Patch
from vedette.ros2.scans import LaserSweep
from vedette.ros2.transforms import Matrix, deviations, matrix

MOST_SIDE = 1e3  # of a map's cell [m]
MOST_METRES = 2.1e7  # from the origin of its frame to a map
LEAST_LENGTH = 1e-6  # of a quaternion that turns, and one part in its most [1]


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
    """Yield the transforms of a ``tf2_msgs/TFMessage``; what makes no sense is left out."""
    for told in message.transforms:
        T = _transform(told.transform.translation, told.transform.rotation)
        if T is not None:
            yield Joint(told.header.frame_id, told.child_frame_id, seconds(told.header.stamp), T, fixed)


def deviation_of(message: Any) -> Deviation:
    """Return how sure a ``geometry_msgs/PoseWithCovarianceStamped`` is."""
    return Deviation(*deviations(message.pose.covariance))


def grid_of(message: Any) -> Grid | None:
    """Return a ``nav_msgs/OccupancyGrid``; None: it makes no sense."""
    info, cells = message.info, np.asarray(message.data, np.int8)
    T = _transform(info.origin.position, info.origin.orientation, upright=True)
    if T is None or not 0.0 < info.resolution <= MOST_SIDE or len(cells) != info.height * info.width:
        return None
    return Grid(message.header.frame_id, info.resolution, T, cells.reshape(info.height, info.width))


def patch_of(message: Any) -> Patch | None:
    """Return a ``map_msgs/OccupancyGridUpdate``; None: it makes no sense."""
    cells = np.asarray(message.data, np.int8)
    if len(cells) != message.height * message.width:
        return None
    return Patch(message.y, message.x, cells.reshape(message.height, message.width))


def _transform(at: Any, turn: Any, *, upright: bool = False) -> Matrix | None:
    """Return a translation and a rotation as a matrix; None where it is none, or leads nowhere.

    A quaternion of next to no length is none, nor is one of millions; where such things are to be
    ``upright``, as maps are, one of zeros turns nothing.
    """
    place, quaternion = (at.x, at.y, at.z), (turn.x, turn.y, turn.z, turn.w)
    if upright and not any(quaternion):
        quaternion = (0.0, 0.0, 0.0, 1.0)
    if not np.isfinite((*place, *quaternion)).all() or max(map(abs, place)) > MOST_METRES:
        return None
    return matrix(place, quaternion) if LEAST_LENGTH < hypot(*quaternion) < 1.0 / LEAST_LENGTH else None

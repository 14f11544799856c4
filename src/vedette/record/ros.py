"""ROS 2 messages of what the record holds, encoded in CDR without a ROS installation (rosbags)."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rosbags.typesys import Stores, get_typestore

from vedette.maps import FREE, OCCUPIED, UNKNOWN, GridFrame

FRAME_ID = "map"

_OCCUPANCY = np.full(256, -1, np.int8)  # cell class -> nav_msgs/OccupancyGrid value
_OCCUPANCY[[UNKNOWN, FREE, OCCUPIED]] = -1, 0, 100


class RosMessages:
    """Build and encode messages; ``stamp`` is a time [ns], poses are in the frame ``frame_id``."""

    def __init__(self, frame_id: str = FRAME_ID) -> None:
        """Load the message definitions of ROS 2 Humble; later releases have the same ones."""
        self.frame_id = frame_id
        self._store = get_typestore(Stores.ROS2_HUMBLE)

    def definition(self, kind: str) -> str:
        """Return the full text (``ros2msg``) of a message type, the types it needs included."""
        return str(self._store.generate_msgdef(kind, ros_version=2)[0])

    def encode(self, message: Any) -> bytes:
        """Return the CDR bytes of a message."""
        return bytes(self._store.serialize_cdr(message, message.__msgtype__))

    def number(self, value: float) -> Any:
        """Return a ``std_msgs/Float64``."""
        return self._make("std_msgs/msg/Float64", float(value))

    def text(self, value: str) -> Any:
        """Return a ``std_msgs/String``."""
        return self._make("std_msgs/msg/String", value)

    def pose(self, stamp: int, x: float, y: float, heading: float) -> Any:
        """Return a ``geometry_msgs/PoseStamped`` at ``x, y`` [m] with ``heading`` [rad]."""
        return self._make("geometry_msgs/msg/PoseStamped", self._header(stamp), self._pose(x, y, heading))

    def path(self, stamp: int, points: NDArray[np.float64]) -> Any:
        """Return a ``nav_msgs/Path`` through ``(k, 2)`` points [m]; those on a straight line are left out."""
        points = corners(points)
        along = np.diff(points, axis=0, append=points[-1:])
        headings = np.arctan2(along[:, 1], along[:, 0])
        if len(headings) > 1:
            headings[-1] = headings[-2]
        poses = [self.pose(stamp, x, y, h) for (x, y), h in zip(points, headings, strict=True)]
        return self._make("nav_msgs/msg/Path", self._header(stamp), poses)

    def transforms(self, stamp: int, poses: Iterable[tuple[str, float, float, float]]) -> Any:
        """Return a ``tf2_msgs/TFMessage`` from the map to each ``(frame, x, y, heading)``."""
        return self._make(
            "tf2_msgs/msg/TFMessage",
            [
                self._make(
                    "geometry_msgs/msg/TransformStamped",
                    self._header(stamp),
                    child,
                    self._make(
                        "geometry_msgs/msg/Transform",
                        self._make("geometry_msgs/msg/Vector3", float(x), float(y), 0.0),
                        self._turn(heading),
                    ),
                )
                for child, x, y, heading in poses
            ],
        )

    def map_grid(self, stamp: int, frame: GridFrame, classes: NDArray[np.uint8]) -> Any:
        """Return a ``nav_msgs/OccupancyGrid`` of cell classes: free 0, occupied 100, unknown -1."""
        return self._grid(stamp, frame, _OCCUPANCY[classes])

    def share_grid(self, stamp: int, frame: GridFrame, share: NDArray[np.float32]) -> Any:
        """Return a ``nav_msgs/OccupancyGrid`` of numbers in 0..1 as per cent."""
        return self._grid(stamp, frame, np.rint(np.clip(share, 0.0, 1.0) * 100).astype(np.int8))

    def _make(self, kind: str, *values: Any) -> Any:
        return self._store.types[kind](*values)

    def _header(self, stamp: int) -> Any:
        time = self._make("builtin_interfaces/msg/Time", *divmod(stamp, 1_000_000_000))
        return self._make("std_msgs/msg/Header", time, self.frame_id)

    def _turn(self, heading: float) -> Any:
        half = 0.5 * heading
        return self._make("geometry_msgs/msg/Quaternion", 0.0, 0.0, float(np.sin(half)), float(np.cos(half)))

    def _pose(self, x: float, y: float, heading: float) -> Any:
        point = self._make("geometry_msgs/msg/Point", float(x), float(y), 0.0)
        return self._make("geometry_msgs/msg/Pose", point, self._turn(heading))

    def _grid(self, stamp: int, frame: GridFrame, values: NDArray[np.int8]) -> Any:
        header = self._header(stamp)
        origin = self._pose(frame.origin_x, frame.origin_y, 0.0)
        info = self._make(
            "nav_msgs/msg/MapMetaData", header.stamp, frame.resolution, frame.cols, frame.rows, origin
        )
        return self._make("nav_msgs/msg/OccupancyGrid", header, info, values.reshape(-1))


def corners(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the ends of a ``(k, 2)`` polyline and the points where it turns by more than about 1e-6 rad."""
    points = np.asarray(points, dtype=np.float64).reshape(-1, 2)
    if len(points) < 3:
        return points
    before, after = np.diff(points, axis=0)[:-1], np.diff(points, axis=0)[1:]
    cross = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    dot = (before * after).sum(axis=1)
    return points[np.concatenate(([True], ~((np.abs(cross) <= 1e-6 * dot) & (dot > 0)), [True]))]


def ros_names(names: Sequence[str]) -> list[str]:
    """Return a valid and distinct ROS name for each robot: ``robot-1`` becomes ``robot_1``."""
    taken: set[str] = set()
    valid = []
    for name in names:
        stem = re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_") or "robot"
        stem = f"robot_{stem}" if stem[0].isdigit() else stem
        choice, number = stem, 1
        while choice in taken:
            number += 1
            choice = f"{stem}_{number}"
        taken.add(choice)
        valid.append(choice)
    return valid

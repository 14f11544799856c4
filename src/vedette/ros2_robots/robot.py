"""One robot's node: what it tells of its place and of its map, with the mistakes that are asked for."""

from __future__ import annotations

import importlib
from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass
from math import cos, pi, radians, sin
from typing import Any

import numpy as np
from builtin_interfaces.msg import Time
from geometry_msgs.msg import TransformStamped
from nav_msgs.msg import OccupancyGrid, Odometry
from numpy.typing import NDArray
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data
from sensor_msgs.msg import LaserScan
from tf2_msgs.msg import TFMessage

from vedette.ros2_robots.building import Building
from vedette.ros2_robots.lidar import LidarModel, Look
from vedette.ros2_robots.mapper import Mapper
from vedette.ros2_robots.navigator import Navigator, Pose

STEP = 0.05  # of the simulation [s]
MAP_PERIOD = 1.0  # [s]


def quaternion(yaw: float, roll: float = 0.0) -> tuple[float, float, float, float]:
    """Return x, y, z, w of a turn about z after one about x [rad]."""
    return (
        cos(yaw / 2) * sin(roll / 2),
        sin(yaw / 2) * sin(roll / 2),
        sin(yaw / 2) * cos(roll / 2),
        cos(yaw / 2) * cos(roll / 2),
    )


def seen_from(frame: Pose, at: Pose) -> Pose:
    """Return a place of the world in a frame that lies in it."""
    dx, dy, c, s = at[0] - frame[0], at[1] - frame[1], cos(frame[2]), sin(frame[2])
    return c * dx + s * dy, c * dy - s * dx, at[2] - frame[2]


def in_world(frame: Pose, at: Pose) -> Pose:
    """Return a place of a frame in the world."""
    c, s = cos(frame[2]), sin(frame[2])
    return frame[0] + c * at[0] - s * at[1], frame[1] + s * at[0] + c * at[1], frame[2] + at[2]


@dataclass(eq=False)
class RobotNode:
    """One robot's node; its map's and its odometry's frames lie where it started, but for SLAM's mistakes."""

    spec: Mapping[str, Any]
    start: Pose
    node: Node
    navigator: Navigator
    building: Building
    next_map: float = 0.0

    def __post_init__(self) -> None:
        node = self.node
        self._tf = node.create_publisher(TFMessage, "tf", 100)
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self._static = node.create_publisher(TFMessage, "tf_static", latched)
        self._odom = node.create_publisher(Odometry, "odom", 10)
        self._scan = node.create_publisher(LaserScan, "scan", qos_profile_sensor_data)
        self._map = node.create_publisher(OccupancyGrid, "map", latched) if self.spec["slam"] else None
        self._mapper, self._updates = Mapper(self.building), None
        self._told: NDArray[np.int8] | None = None  # the map that was told last
        self._lay: Any = None  # where that lay
        if self.spec["updates"]:
            self._update_type = importlib.import_module("map_msgs.msg").OccupancyGridUpdate
            self._updates = node.create_publisher(self._update_type, "map_updates", 10)
        self._lidar = LidarModel(self.spec, f"{self.spec['prefix']}laser", STEP)
        self._late: deque[tuple[float, TransformStamped]] = deque()  # until when they are held back [s]
        x, y, yaw = self.spec["mount"]
        roll = pi if self.spec["upside_down"] else 0.0
        mount = self._joint("base_link", "laser", (x, y, radians(yaw)), Time(), roll)
        self._static.publish(TFMessage(transforms=[mount]))

    def _joint(self, parent: str, child: str, at: Pose, stamp: Time, roll: float = 0.0) -> TransformStamped:
        told, prefix = TransformStamped(), self.spec["prefix"]
        told.header.frame_id, told.header.stamp, told.child_frame_id = prefix + parent, stamp, prefix + child
        told.transform.translation.x, told.transform.translation.y = at[0], at[1]
        q = told.transform.rotation
        q.x, q.y, q.z, q.w = quaternion(at[2], roll)
        return told

    def map_frame(self, now: float) -> Pose:
        """Return where the frame of the robot's map lies in the world."""
        until, dx, dy, turn = self.spec["lost"]
        return in_world(self.start, (dx, dy, radians(turn))) if now < until else self.start

    def tell(self, now: float, stamp: Time, at: Pose, moving: tuple[float, float], look: Look) -> None:
        """Publish where the robot is, and now and then what its lidar sees, which costs most of the time."""
        here = seen_from(self.start, at)
        drift = self._joint("map", "odom", seen_from(self.map_frame(now), self.start), stamp)
        self._late.append((now + self.spec["late"], drift))
        due = [self._late.popleft()[1] for _ in range(sum(until <= now for until, _ in self._late))]
        self._tf.publish(TFMessage(transforms=[*due, self._joint("odom", "base_link", here, stamp)]))
        odometry, prefix = Odometry(), self.spec["prefix"]
        odometry.header.frame_id, odometry.header.stamp = f"{prefix}odom", stamp
        odometry.child_frame_id = f"{prefix}base_link"
        odometry.pose.pose.position.x, odometry.pose.pose.position.y = here[0], here[1]
        q = odometry.pose.pose.orientation
        q.x, q.y, q.z, q.w = quaternion(here[2])
        odometry.twist.twist.linear.x, odometry.twist.twist.angular.z = moving
        self._odom.publish(odometry)
        turned = self._lidar.sweep(now, stamp, look)
        if turned is not None:
            self._scan.publish(turned[0])
            if self._map is not None:
                x, y, yaw = self.spec["mount"]
                self._mapper.look(*in_world(at, (x, y, radians(yaw))), turned[1])
        if self._map is not None and now >= self.next_map:
            self.next_map += MAP_PERIOD
            self._tell_map(self._map, self._own_map(now, stamp))

    def _tell_map(self, topic: Any, told: OccupancyGrid) -> None:
        """Publish the robot's map, or while it lies where it lay only the rows that have changed."""
        cells = np.asarray(told.data, np.int8).reshape(told.info.height, told.info.width)
        lies = told.info.origin == self._lay
        if self._updates is None or self._told is None or not lies:
            topic.publish(told)
        elif (rows := np.flatnonzero((cells != self._told).any(axis=1))).size:
            update = self._update_type(header=told.header, y=int(rows[0]), width=told.info.width)
            changed = cells[rows[0] : rows[-1] + 1]
            update.height, update.data = len(changed), changed.ravel().tolist()
            self._updates.publish(update)
        self._told, self._lay = cells, told.info.origin

    def _own_map(self, now: float, stamp: Time) -> OccupancyGrid:
        told, building = OccupancyGrid(), self.building
        told.header.frame_id, told.header.stamp = f"{self.spec['prefix']}map", stamp
        told.info.resolution = building.resolution
        told.info.height, told.info.width = building.solid.shape
        x, y, yaw = seen_from(self.map_frame(now), (building.left, building.lower, 0.0))
        told.info.origin.position.x, told.info.origin.position.y = x, y
        q = told.info.origin.orientation
        q.x, q.y, q.z, q.w = quaternion(yaw)
        told.data = self._mapper.occupancy.ravel().tolist()
        return told

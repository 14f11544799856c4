"""Robots with a node each, in one building: what they tell, and how the simulation goes on."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from math import cos, pi, radians, sin
from pathlib import Path
from typing import Any

import irsim
import numpy as np
import yaml
from builtin_interfaces.msg import Time
from geometry_msgs.msg import TransformStamped
from nav_msgs.msg import OccupancyGrid, Odometry
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import LaserScan
from tf2_msgs.msg import TFMessage

from vedette.ros2_robots.building import Building
from vedette.ros2_robots.mapper import Mapper
from vedette.ros2_robots.navigator import Navigator, Pose
from vedette.ros2_robots.planner import WayFinder

STEP = 0.05  # of the simulation [s]
NOISE = 0.01  # of a range [m]
MAP_PERIOD = 1.0  # [s]
DEFAULTS: Mapping[str, Any] = {
    "radius": 0.2,
    "speed": 0.5,
    "turn_rate": 1.5,
    "range": 8.0,
    "range_min": 0.05,
    "view": 360.0,
    "beams": 240,
    "rate": 5.0,
    "active_from": 0.0,
    "prefix": "",
    "mount": [0.0, 0.0, 0.0],  # of the lidar: x, y, yaw [m, m, deg]
    "upside_down": False,
    "slam": False,  # it publishes a map
    "lost": [0.0, 0.0, 0.0, 0.0],  # until when its map is wrong, and by how much [s, m, m, deg]
}


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
    next_scan: float = 0.0
    next_map: float = 0.0

    def __post_init__(self) -> None:
        node = self.node
        self._tf = node.create_publisher(TFMessage, "tf", 100)
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self._static = node.create_publisher(TFMessage, "tf_static", latched)
        self._odom = node.create_publisher(Odometry, "odom", 10)
        self._scan = node.create_publisher(LaserScan, "scan", qos_profile_sensor_data)
        self._map = node.create_publisher(OccupancyGrid, "map", latched) if self.spec["slam"] else None
        self._mapper = Mapper(self.building)
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

    def tell(
        self, now: float, stamp: Time, at: Pose, moving: tuple[float, float], look: Callable[[], Any]
    ) -> None:
        """Publish where the robot is, and now and then what its lidar sees, which costs most of the time."""
        here = seen_from(self.start, at)
        drift = self._joint("map", "odom", seen_from(self.map_frame(now), self.start), stamp)
        self._tf.publish(TFMessage(transforms=[drift, self._joint("odom", "base_link", here, stamp)]))
        odometry, prefix = Odometry(), self.spec["prefix"]
        odometry.header.frame_id, odometry.header.stamp = f"{prefix}odom", stamp
        odometry.child_frame_id = f"{prefix}base_link"
        odometry.pose.pose.position.x, odometry.pose.pose.position.y = here[0], here[1]
        q = odometry.pose.pose.orientation
        q.x, q.y, q.z, q.w = quaternion(here[2])
        odometry.twist.twist.linear.x, odometry.twist.twist.angular.z = moving
        self._odom.publish(odometry)
        if now >= self.next_scan - 1e-9:
            self.next_scan += 1.0 / self.spec["rate"]
            scan = look()
            self._scan.publish(self._sweep(stamp, scan))
            if self._map is not None:
                x, y, yaw = self.spec["mount"]
                self._mapper.look(*in_world(at, (x, y, radians(yaw))), scan)
        if self._map is not None and now >= self.next_map:
            self.next_map += MAP_PERIOD
            self._map.publish(self._own_map(now, stamp))

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

    def _sweep(self, stamp: Time, scan: Mapping[str, Any]) -> LaserScan:
        told = LaserScan()
        told.header.frame_id, told.header.stamp = f"{self.spec['prefix']}laser", stamp
        told.angle_min, told.angle_max = float(scan["angle_min"]), float(scan["angle_max"])
        told.angle_increment = float(scan["angle_increment"])
        told.range_min, told.range_max = float(scan["range_min"]), float(scan["range_max"])
        told.scan_time = 1.0 / self.spec["rate"]
        ranges = np.asarray(scan["ranges"], np.float64).ravel().copy()
        ranges[ranges >= scan["range_max"]] = np.inf
        if self.spec["upside_down"]:
            ranges = ranges[::-1]
        told.ranges = ranges.astype(np.float32).tolist()
        return told


class Strangers:
    """All robots of a file in their building; ``step`` it, or let a timer do so."""

    def __init__(self, path: Path, context: Any, speed: float, sim_time: bool) -> None:
        """Read the robots' file: ``map`` beside it, ``robots`` with a namespace and a start each."""
        told = yaml.safe_load(path.read_text(encoding="utf-8"))
        self.building = Building.read(path.parent / told["map"])
        self._specs = [{**DEFAULTS, **robot} for robot in told["robots"]]
        self._starts = [(x, y, radians(yaw)) for x, y, yaw in (spec["start"] for spec in self._specs)]
        self._env = self._make()
        self._sim_time, self._speed, self.now = sim_time, speed, 0.0
        self.collided = [False] * len(self._specs)  # whether each robot has touched something
        self.nodes = [Node("robot", namespace=spec["namespace"], context=context) for spec in self._specs]
        self.robots = [self._robot(i) for i in range(len(self._specs))]
        self._clock = self.nodes[0].create_publisher(Clock, "/clock", 10) if sim_time else None
        self.nodes[0].create_timer(STEP / speed, self.step)

    def _robot(self, i: int) -> RobotNode:
        spec = self._specs[i]
        navigator = Navigator(
            self.nodes[i],
            WayFinder(self.building, spec["radius"]),
            spec["radius"],
            spec["speed"],
            spec["turn_rate"],
            lambda at: in_world(self.robots[i].map_frame(self.now), at),
            spec["active_from"],
        )
        return RobotNode(spec, self._starts[i], self.nodes[i], navigator, self.building)

    def _make(self) -> Any:
        rows, cols = self.building.solid.shape
        side = self.building.resolution
        world = {
            "world": {
                "height": rows * side,
                "width": cols * side,
                "offset": [self.building.left, self.building.lower],
                "step_time": STEP,
                "collision_mode": "stop",
            },
            "robot": [self._body(i) for i in range(len(self._specs))],
            "obstacle": [
                {"shape": {"name": "linestring", "vertices": loop}, "state": [0, 0, 0]}
                for loop in self.building.outlines()
            ],
        }
        with tempfile.NamedTemporaryFile("w", suffix=".yaml") as file:
            yaml.safe_dump(world, file)
            file.flush()
            env = irsim.make(file.name, headless=True, log_level="ERROR", seed=0)
        for body in env.robot_list:
            body.sensors = []  # lidars look when a scan is due, not at every step
        return env

    def _look(self, i: int) -> Any:
        """Return what a robot's lidar sees now."""
        body = self._env.robot_list[i]
        body.lidar.step(body.state[0:3])
        return body.lidar.get_scan()

    def _body(self, i: int) -> dict[str, Any]:
        spec = self._specs[i]
        x, y, yaw = spec["mount"]
        lidar = {
            "name": "lidar2d",
            "range_min": spec["range_min"],
            "range_max": spec["range"],
            "angle_range": radians(min(spec["view"], 359.999)),
            "number": spec["beams"],
            "noise": True,
            "std": NOISE,
            "offset": [x, y, radians(yaw)],
        }
        return {
            "kinematics": {"name": "diff"},
            "shape": {"name": "circle", "radius": spec["radius"]},
            "state": list(self._starts[i]),
            "vel_min": [-spec["speed"], -spec["turn_rate"]],
            "vel_max": [spec["speed"], spec["turn_rate"]],
            "sensors": [lidar],
        }

    def pose(self, i: int) -> Pose:
        """Return where a robot is in the world."""
        x, y, yaw = np.asarray(self._env.robot_list[i].state).ravel()[:3].tolist()
        return x, y, yaw

    def step(self) -> None:
        """Let a step pass: drive, sense, tell."""
        poses = [self.pose(i) for i in range(len(self.robots))]
        discs = [(*pose[:2], spec["radius"]) for pose, spec in zip(poses, self._specs, strict=True)]
        moving = [
            robot.navigator.step(self.now, poses[i], [*discs[:i], *discs[i + 1 :]])
            for i, robot in enumerate(self.robots)
        ]
        self._env.step([list(each) for each in moving], list(range(len(moving))))
        self.collided = [
            a or bool(b.collision) for a, b in zip(self.collided, self._env.robot_list, strict=True)
        ]
        self.now += STEP
        stamp = self._stamp()
        if self._clock is not None:
            self._clock.publish(Clock(clock=stamp))
        for i, robot in enumerate(self.robots):
            robot.tell(self.now, stamp, self.pose(i), moving[i], partial(self._look, i))

    def _stamp(self) -> Time:
        if self._sim_time:
            nanoseconds = round(self.now * 1e9)
            return Time(sec=nanoseconds // 10**9, nanosec=nanoseconds % 10**9)
        return self.nodes[0].get_clock().now().to_msg()

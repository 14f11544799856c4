"""Robots with a node each, in one building: how the simulation goes on."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from functools import partial
from math import radians
from pathlib import Path
from typing import Any

import irsim
import numpy as np
import yaml
from builtin_interfaces.msg import Time
from rclpy.node import Node
from rosgraph_msgs.msg import Clock

from vedette.ros2_robots.building import Building
from vedette.ros2_robots.navigator import Navigator, Pose
from vedette.ros2_robots.planner import WayFinder
from vedette.ros2_robots.robot import STEP, RobotNode, in_world
from vedette.ros2_robots.steering import within

NOISE = 0.01  # of a range [m]
DEFAULTS: Mapping[str, Any] = {
    "radius": 0.2,
    "speed": 0.5,
    "turn_rate": 1.5,
    "range": 8.0,
    "range_min": 0.05,
    "view": 360.0,
    "beams": 240,
    "rate": 5.0,
    "active_from": 0.0,  # goals are rejected until then [s]
    "fails": [],  # what befalls the first goals after that: abort, reject, ignore
    "prefix": "",
    "mount": [0.0, 0.0, 0.0],  # of the lidar: x, y, yaw [m, m, deg]
    "upside_down": False,
    "clockwise": False,  # its beams go round the other way
    "speckle": 0.0,  # share of its beams that are no measurement
    "rolling": False,  # its beams are measured one after another, while the robot goes on
    "slam": False,  # it publishes a map
    "updates": False,  # and after the first one only what has changed of it
    "late": 0.0,  # so long after its time map -> odom is told [s]
    "lost": [0.0, 0.0, 0.0, 0.0],  # until when its map is wrong, and by how much [s, m, m, deg]
}


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
            list(spec["fails"]),
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

    def _look(self, i: int, before: Pose, share: float) -> Any:
        """Return what a robot's lidar sees from a share of the way from where it was ``before``."""
        lidar, (x, y, yaw) = self._env.robot_list[i].lidar, self.pose(i)
        left = 1.0 - share
        at = x + left * (before[0] - x), y + left * (before[1] - y), yaw + left * within(before[2] - yaw)
        lidar.step(np.array(at)[:, None])
        return lidar.get_scan()

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
            robot.tell(self.now, stamp, self.pose(i), moving[i], partial(self._look, i, poses[i]))

    def _stamp(self) -> Time:
        if self._sim_time:
            nanoseconds = round(self.now * 1e9)
            return Time(sec=nanoseconds // 10**9, nanosec=nanoseconds % 10**9)
        return self.nodes[0].get_clock().now().to_msg()

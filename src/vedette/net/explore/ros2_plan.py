"""An exploring team whose robots run ROS 2, simulated by strangers on this host."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec
import numpy as np

from vedette.align import FramePose
from vedette.errors import InputError
from vedette.maps.lattice import Lattice
from vedette.net.explore.plan import ExplorePlan
from vedette.net.names import robot_name
from vedette.record.files import write_text

ROBOTS = "robots.yaml"
OF_ROBOT = ("radius", "speed", "turn_rate", "range", "view", "beams", "rate")  # what the strangers are told
READY = "robots: ready"
PATIENCE = 30.0  # for them to start [s]
ENDING = 5.0  # and to end [s]
DOMAINS = 100  # of ROS that every host has


@dataclass(frozen=True, eq=False)
class Ros2Plan(ExplorePlan):
    """``vedette.net.launch.TeamPlan``; a robot's own map begins where the robot starts."""

    def __post_init__(self) -> None:
        """Where frames are unknown, let each be that of the robot's own map."""
        if self.options.frames == "unknown":
            self.frames.extend(FramePose.of(*start) for start in self.starts.tolist())

    @property
    def lattice(self) -> Lattice:
        """That the robots agree on; nobody tells them how large the building is."""
        return self.options.lattice(self.world.frame.resolution)

    def write(self, folder: Path) -> None:
        """Write the building, and the robots' file for those who simulate them."""
        super().write(folder)
        robots = [
            {"namespace": _namespace(i), "start": self._start(i), **{n: getattr(spec, n) for n in OF_ROBOT}}
            for i, spec in enumerate(self.specs)
        ]
        write_text(folder / ROBOTS, msgspec.yaml.encode({"map": "map.yaml", "robots": robots}).decode())

    def config(self, i: int, pose: Sequence[float] | None) -> dict[str, Any]:
        """Return what a robot's file says of its mission; the robot itself says where it is."""
        told, spec = super().config(i, None), self.specs[i]
        ros2 = {
            "namespace": _namespace(i),
            "use_sim_time": True,  # a host that is too slow for them slows the mission down
            "no_return": "free",  # what simulated lidars do not see is not there
            **({} if self.frames else {"start": self._start(i)}),
        }
        body = {"radius": spec.radius, "speed": spec.speed, "turn_rate": spec.turn_rate, "ros2": ros2}
        return told | {
            "body": {**body, "resolution": self.world.frame.resolution, "range_noise": spec.range_noise}
        }

    def _start(self, i: int) -> list[float]:
        x, y, heading = self.starts[i].tolist()
        return [x, y, float(np.degrees(heading))]


def environment(domain: int | None = None) -> dict[str, str]:
    """Return what keeps ROS on this host, and apart from others' on it."""
    number = os.getpid() % DOMAINS if domain is None else domain
    return {"ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST", "ROS_DOMAIN_ID": str(number), "MPLBACKEND": "Agg"}


@contextmanager
def strangers(
    folder: Path, log: Path, speed: float, environment: Mapping[str, str]
) -> Iterator[subprocess.Popen[bytes]]:
    """Let the robots of a folder's file live; what they say goes into ``log``.

    Raises:
        InputError: they do not start; the line says what is missing.
    """
    command = [sys.executable, "-m", "vedette.ros2_robots", str(folder / ROBOTS)]
    options = ["--speed", str(speed), "--sim-time", "--starter", str(os.getpid())]
    log.parent.mkdir(parents=True, exist_ok=True)
    with log.open("wb") as said:
        process = subprocess.Popen(
            [*command, *options],
            stdin=subprocess.DEVNULL,
            stdout=said,
            stderr=subprocess.STDOUT,
            start_new_session=True,
            env={**os.environ, **environment},
        )
    try:
        _await(process, log)
        yield process
    finally:
        process.terminate()
        try:
            process.wait(ENDING)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def _await(process: subprocess.Popen[bytes], log: Path) -> None:
    until = time.monotonic() + PATIENCE
    while READY not in log.read_text(encoding="utf-8", errors="replace"):
        if process.poll() is not None or time.monotonic() > until:
            lines = log.read_text(encoding="utf-8", errors="replace").strip().splitlines()
            raise InputError(
                f"the simulated ROS 2 robots do not start: {lines[-1] if lines else log}; they need rclpy, "
                "nav2_msgs, tf2_msgs and the extra ros2-robots"
            )
        time.sleep(0.1)


def _namespace(i: int) -> str:
    return robot_name(i).replace("-", "")

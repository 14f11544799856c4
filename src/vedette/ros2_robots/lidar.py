"""A lidar as drivers publish it, with the oddities that real ones have."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from builtin_interfaces.msg import Time
from numpy.typing import NDArray
from sensor_msgs.msg import LaserScan

PARTS = 3  # of a step, for a lidar that measures one beam after another
Look = Callable[[float], Mapping[str, Any]]
"""What ir-sim's lidar sees from where it was at a share of the latest step; at 1 from where it is now."""


@dataclass(eq=False)
class LidarModel:
    """Makes scans of one robot's lidar, ``rate`` a second; times are the simulation's [s]."""

    spec: Mapping[str, Any]
    frame: str
    step: float  # of the simulation [s]
    next: float = 0.0
    _parts: list[NDArray[np.float64]] = field(default_factory=list)  # of a turn that goes on: ranges [m]
    _began: Time | None = None  # when that did
    _rng: np.random.Generator = field(default_factory=lambda: np.random.default_rng(0))

    def sweep(self, now: float, stamp: Time, look: Look) -> tuple[LaserScan, Mapping[str, Any]] | None:
        """Return a scan and what was seen in the end, if one is due; looking costs most of the time."""
        if self.spec["rolling"]:
            return self._turn(stamp, look)
        if now < self.next - 1e-9:
            return None
        self.next += 1.0 / self.spec["rate"]
        seen = look(1.0)
        return self._scan(stamp, seen, np.asarray(seen["ranges"], np.float64).ravel()), seen

    def _turn(self, stamp: Time, look: Look) -> tuple[LaserScan, Mapping[str, Any]] | None:
        """Look a part of the beams at a time, from where the robot was then; when all are through, a scan."""
        self._began = self._began or _earlier(stamp, self.step)
        for part in range(PARTS):
            seen = look((part + 0.5) / PARTS)
            self._parts.append(np.array(seen["ranges"], np.float64).ravel())  # a copy: ir-sim writes over it
        count = PARTS * max(round(1.0 / (self.spec["rate"] * self.step)), 1)
        if len(self._parts) < count:
            return None
        n = len(self._parts[0])
        part_of = np.arange(n) * count // n
        if self.spec["upside_down"] != self.spec["clockwise"]:
            part_of = part_of[::-1]
        ranges = np.array(self._parts)[part_of, np.arange(n)]
        told = self._scan(self._began, seen, ranges)
        told.time_increment = self.step * count / PARTS / n
        self._began, self._parts = None, []
        return told, seen

    def _scan(self, stamp: Time, seen: Mapping[str, Any], ranges: NDArray[np.float64]) -> LaserScan:
        told = LaserScan()
        told.header.frame_id, told.header.stamp = self.frame, stamp
        told.angle_min, told.angle_max = float(seen["angle_min"]), float(seen["angle_max"])
        told.angle_increment = float(seen["angle_increment"])
        told.range_min, told.range_max = float(seen["range_min"]), float(seen["range_max"])
        told.scan_time = 1.0 / self.spec["rate"]
        ranges = np.where(ranges >= seen["range_max"], np.inf, ranges)
        odd = self._rng.random(len(ranges)) < self.spec["speckle"]
        ranges[odd] = self._rng.choice((np.nan, 0.0, 0.5 * told.range_min, -np.inf), int(odd.sum()))
        if self.spec["upside_down"]:
            ranges = ranges[::-1]
        if self.spec["clockwise"]:
            told.angle_min, told.angle_max = told.angle_max, told.angle_min
            told.angle_increment, ranges = -told.angle_increment, ranges[::-1]
        told.ranges = ranges.astype(np.float32).tolist()
        return told


def _earlier(stamp: Time, span: float) -> Time:
    """Return a time so much before another [s]."""
    nanoseconds = stamp.sec * 10**9 + stamp.nanosec - round(span * 1e9)
    return Time(sec=nanoseconds // 10**9, nanosec=nanoseconds % 10**9)

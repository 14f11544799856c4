"""A lidar as drivers publish it, with the oddities that real ones have."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from builtin_interfaces.msg import Time
from numpy.typing import NDArray
from sensor_msgs.msg import LaserScan

Look = Callable[[], Mapping[str, Any]]  # what ir-sim's lidar sees from where it is now


@dataclass(eq=False)
class Lidar:
    """Makes scans of one robot's lidar, ``rate`` a second; times are the simulation's [s]."""

    spec: Mapping[str, Any]
    frame: str
    step: float  # of the simulation [s]
    next: float = 0.0
    _parts: list[tuple[Time, NDArray[np.float64]]] = field(default_factory=list)  # of a turn that goes on
    _rng: np.random.Generator = field(default_factory=lambda: np.random.default_rng(0))

    def sweep(self, now: float, stamp: Time, look: Look) -> tuple[LaserScan, Mapping[str, Any]] | None:
        """Return a scan and what was seen in the end, if one is due; looking costs most of the time."""
        parts = max(round(1.0 / (self.spec["rate"] * self.step)), 1) if self.spec["rolling"] else 1
        if not self._parts and now < self.next - 1e-9:
            return None
        seen = look()
        self._parts.append((stamp, np.asarray(seen["ranges"], np.float64).ravel()))
        if len(self._parts) < parts:
            return None
        self.next += 1.0 / self.spec["rate"]
        pieces, first = self._parts, self._parts[0][0]
        self._parts = []
        n = len(pieces[0][1])
        share = np.arange(n) * parts // n  # of the turn, when each was measured
        if self.spec["upside_down"] != self.spec["clockwise"]:
            share = share[::-1]
        ranges = np.choose(share, [ranges for _, ranges in pieces])
        told = self._scan(first, seen, ranges)
        told.time_increment = self.step * parts / n if parts > 1 else 0.0
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

"""Scans that wait until TF covers them, and where the lidar was all through each."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field
from math import ceil, inf

import numpy as np

from vedette.ros2.scans import LaserSweep
from vedette.ros2.transforms import RESTARTED, Gap, Matrix, Transforms

WAITING = 100  # scans that wait for their transforms at most; then the oldest is left out
BETWEEN_SCANS = 0.18  # of those that are taken in, at least [s]
KNOT = 0.025  # a scan's way is looked up as often as this [s] ...
MOST_KNOTS = 8  # ... but in no more legs


@dataclass(frozen=True, eq=False)
class PlacedSweep:
    """A scan, and where it was taken."""

    sweep: LaserSweep
    knots: list[Matrix]  # T_map_lidar in even steps from its first beam to its last
    T_map_base: Matrix  # in its middle
    age: float  # since its middle, by the newest transform [s]


@dataclass(eq=False)
class Sweeps:
    """Takes scans in as they come, and gives them back in order once they can be placed."""

    transforms: Transforms
    latest: LaserSweep | None = None
    left_out: int = 0  # whose transforms never came
    _seen: float = -inf  # stamp of the latest that was taken in [s]
    _waiting: deque[LaserSweep] = field(default_factory=lambda: deque(maxlen=WAITING))

    @property
    def wait(self) -> bool:
        """Whether any of them waits."""
        return bool(self._waiting)

    def receive(self, sweep: LaserSweep) -> None:
        """Let a scan wait for its transforms; what comes faster than is needed is left alone."""
        self.latest = sweep
        if sweep.stamp < self._seen - RESTARTED:  # the robot's clock has begun anew
            self._waiting.clear()
        elif sweep.stamp < self._seen + BETWEEN_SCANS:
            return
        self._seen = sweep.stamp
        self._waiting.append(sweep)

    def due(self, map_frame: str, base_frame: str) -> list[PlacedSweep]:
        """Return the scans whose transforms have come by now."""
        due = []
        while self._waiting:
            placed = self._placed(self._waiting[0], map_frame, base_frame)
            if placed in (Gap.NOT_YET, Gap.UNCONNECTED):
                break
            self._waiting.popleft()
            if isinstance(placed, Gap):
                self.left_out += 1
            else:
                due.append(placed)
        return due

    def can_be_placed(self, map_frame: str, base_frame: str) -> bool:
        """Tell whether TF covers any of those that wait."""
        placed = (self._placed(sweep, map_frame, base_frame) for sweep in self._waiting)
        return any(not isinstance(each, Gap) for each in placed)

    def _placed(self, sweep: LaserSweep, map_frame: str, base_frame: str) -> PlacedSweep | Gap:
        middle, span = 0.5 * (sweep.stamp + sweep.ends), sweep.ends - sweep.stamp
        stamps = np.linspace(sweep.stamp, sweep.ends, min(max(ceil(span / KNOT), 1), MOST_KNOTS) + 1)
        found: list[Matrix] = []
        for frame, stamp in (*((sweep.frame, stamp) for stamp in stamps.tolist()), (base_frame, middle)):
            T = self.transforms.lookup(map_frame, frame, stamp)
            if isinstance(T, Gap):
                return T
            found.append(T)
        newest = self.transforms.newest(base_frame)
        return PlacedSweep(sweep, found[:-1], found[-1], 0.0 if newest is None else max(newest - middle, 0.0))

"""What an agent knows of its team-mates' motion, from their beacons."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from vedette.agent.messages import Beacon

SILENT = 3.0  # a mate not heard for so long stands where it was last [s]


@dataclass(frozen=True, eq=False)
class Mate:
    """A team-mate as it last beaconed."""

    robot: int
    x: float  # [m], team frame
    y: float
    heading: float  # [rad]
    path: NDArray[np.float64]  # (L, 2) its next few metres [m], team frame; empty: it stands
    slowed: float  # [s]
    age: float  # of the beacon [s]

    @property
    def silent(self) -> bool:
        """Tell whether the mate may be dead: it has not been heard for seconds."""
        return self.age > SILENT


@dataclass
class Mates:
    """The newest beacon of every team-mate."""

    _beacons: dict[int, tuple[Beacon, float]] = field(default_factory=dict)

    def hear(self, beacon: Beacon, now: float) -> bool:
        """Keep a beacon; tell whether it is news."""
        known = self._beacons.get(beacon.robot)
        if known is not None and (known[0].boot, known[0].sequence) >= (beacon.boot, beacon.sequence):
            return False
        self._beacons[beacon.robot] = beacon, now
        return True

    def all(self, now: float) -> list[Mate]:
        """Return all team-mates ever heard, by id."""
        return [_mate(beacon, now - heard) for _, (beacon, heard) in sorted(self._beacons.items())]


def _mate(beacon: Beacon, age: float) -> Mate:
    x, y = beacon.x / 100.0, beacon.y / 100.0
    path = np.array(beacon.path[: len(beacon.path) // 2 * 2], np.float64).reshape(-1, 2) / 100.0
    return Mate(beacon.robot, x, y, beacon.heading / 1000.0, path + (x, y), beacon.slowed / 10.0, age)

"""Frontiers that are left alone, and for how long."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

ELSEWHERE = 1.5  # who was in the way is so no longer when it is this far from where it was [m]

Place = tuple[int, float, float]  # of a robot: id, -1 the robot itself, and x, y [m]
# Of a frontier: x, y [m], unknown cells near it when it was planned, from how far away it was looked at [m].
Visit = tuple[float, float, int, float]


@dataclass(frozen=True)
class GivenUp:
    """A frontier that a visit did not change: left alone until the map near it does."""

    x: float
    y: float
    unknown: int  # cells unknown near it when it was given up
    visited: bool = True  # otherwise it could not be reached
    kept_off: tuple[Place, ...] = ()  # who stood about then: while they stand there it is not tried again

    def stands(self, team: Sequence[Place]) -> bool:
        """Tell whether all who stood about when it was given up are still there."""
        now = {robot: (x, y) for robot, x, y in team}
        return all(
            robot in now and math.dist(now[robot], (x, y)) < ELSEWHERE for robot, x, y in self.kept_off
        )

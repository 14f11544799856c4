"""Where a robot has looked from the place where it stands, and where it has to turn to see the rest."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from math import inf, pi, radians, tau

import numpy as np
from numpy.typing import NDArray

from vedette.agent.events import Pose
from vedette.domains.mapping.beams import apart, between
from vedette.domains.mapping.stops import VIEW_REACH
from vedette.team import PlatformSpec

DIRECTIONS = 3600  # told apart in a full turn
DIRECTION = tau / DIRECTIONS  # [rad]
SAME_SPOT = 0.1  # what is seen from this near is seen from the same place; more by two deviations [m]


@dataclass(eq=False)
class Looking:
    """Keeps the directions in which one robot's lidar has looked since it came to where it stands.

    A lidar that sees all round, beam beside beam, has always looked everywhere.
    """

    spec: PlatformSpec
    resolution: float  # of the map [m]
    _seen: NDArray[np.bool_] = field(init=False)  # (DIRECTIONS,) from direction 0 = +x on
    _spot: tuple[float, float] = (inf, inf)  # from where [m], team frame
    _first: float = 0.0  # direction of the first beam that was sent from there [rad]

    def __post_init__(self) -> None:
        self._seen = np.zeros(DIRECTIONS, np.bool_)

    @property
    def view(self) -> float:
        """Field of view [rad]."""
        return radians(self.spec.view)

    @cached_property
    def between(self) -> float:
        """Angle between two beams [rad]."""
        return between(self.spec)

    @cached_property
    def all_round(self) -> bool:
        """Tell whether no turn on the spot ever shows more."""
        farthest = apart(self.spec, VIEW_REACH * self.spec.range, self.resolution)
        return self.spec.view >= 360.0 and farthest == self.between

    def add(self, pose: Pose, angles: NDArray[np.float64]) -> None:
        """Note that beams were sent from a pose at these angles [rad], team frame."""
        if self.all_round:
            return
        if not self.here(pose):
            self._spot, self._first = (pose.x, pose.y), self._first_beam(pose)
            self._seen[:] = False
        self._seen[np.floor(angles / DIRECTION).astype(np.int64) % DIRECTIONS] = True

    def here(self, pose: Pose) -> bool:
        """Tell whether the robot is where it has looked from."""
        away = np.hypot(pose.x - self._spot[0], pose.y - self._spot[1])
        return bool(away <= SAME_SPOT + 2.0 * pose.deviation)

    def toward(self, pose: Pose, direction: float, distance: float) -> float | None:
        """Return the heading to turn to next for a whole view about a direction; None: it has been seen.

        ``distance``: of what is looked at [m], at which beams shall lie close together.
        """
        if self.spec.view >= 360.0:
            return self.around(pose, distance)
        width = self.view - 2.0 * self.between
        return self._next(pose, direction - 0.5 * width, width, distance)

    def around(self, pose: Pose, distance: float) -> float | None:
        """Return the heading to turn to next for a look all round; None: there has been one."""
        return self._next(pose, self._first if self.here(pose) else self._first_beam(pose), tau, distance)

    def _next(self, pose: Pose, start: float, width: float, distance: float) -> float | None:
        """Return the heading that brings the first beam to where the first unseen direction is.

        The directions are those from ``start`` on, counter-clockwise, over ``width`` [rad]. Until a scan was
        taken there, it is the same heading again.
        """
        if self.all_round:
            return None
        wanted = max(apart(self.spec, distance, self.resolution), 2.0 * DIRECTION)
        unseen = self._first_unseen(
            pose, start, width, wanted + 2.0 * DIRECTION
        )  # beams are told by direction
        if unseen is None:
            return None
        turn = unseen[0] + 0.5 * min(wanted, unseen[1] - unseen[0]) - self._first_beam(pose)
        if self.spec.view >= 360.0:  # any beam will do
            turn = (turn + 0.5 * DIRECTION) % self.between - 0.5 * DIRECTION
        return pose.heading + (turn + pi) % tau - pi

    def _first_beam(self, pose: Pose) -> float:
        """Return the direction of the first beam [rad]."""
        return pose.heading - 0.5 * (self.view - self.between)

    def _first_unseen(
        self, pose: Pose, start: float, width: float, apart: float
    ) -> tuple[float, float] | None:
        """Return from where to where no beam came as near as half of ``apart`` first [rad]."""
        if not self.here(pose):
            return start, start + width
        seen = np.sort(((np.flatnonzero(self._seen) + 0.5) * DIRECTION - start) % tau)
        begins = np.maximum(np.concatenate((seen[-1:] - tau, seen)) + 0.5 * apart, 0.0)  # of what is between
        ends = np.minimum(np.concatenate((seen, seen[:1] + tau)) - 0.5 * apart, width)
        unseen = np.flatnonzero(begins < ends - 1e-9)
        if not len(unseen):
            return None
        return float(start + begins[unseen[0]]), float(start + ends[unseen[0]])

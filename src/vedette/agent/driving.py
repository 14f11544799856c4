"""Driving: where the robot is going, and whom it lets pass on the way."""

from __future__ import annotations

from dataclasses import dataclass
from math import hypot, sqrt

import numpy as np
from numpy.typing import NDArray

from vedette.agent.effects import Drive, Route
from vedette.agent.events import Pose
from vedette.agent.intents import HORIZON, Intent
from vedette.agent.mates import Mate
from vedette.agent.refuges import WINDOW
from vedette.agent.rightofway import give_way, queues
from vedette.kernels.motion import remaining
from vedette.team import PlatformSpec

YIELD_LIMIT = 12.0  # a robot that had to make room for so long looks for other work [s]
ON_ITS_WAY = 1.0  # so far from where it had to make room a robot is on its way again [m]


@dataclass
class Driver:
    """Holds the route that the robot wants, and the refuge it may have to take instead."""

    robot: int
    spec: PlatformSpec
    wanted: Route | None = None
    refuge: NDArray[np.float64] | None = None  # (L, 2) [m], team frame, while making room
    yielding_since: float = 0.0  # less what it did so before at the same place
    yielded: tuple[NDArray[np.float64], float] | None = None  # (2,) where it last made room [m], how long [s]
    queueing: bool = False  # it waits for those before it at a narrow place
    queue: tuple[NDArray[np.float64], float] | None = None  # (2,) where it came to one last [m], when [s]

    @property
    def yielding(self) -> bool:
        """Tell whether the robot is making room for another."""
        return self.refuge is not None

    @property
    def standing(self) -> bool:
        """Tell whether the robot neither wants to go anywhere nor makes room."""
        return self.wanted is None and self.refuge is None

    def go(self, route: Route | None) -> Drive:
        """Want this route from now on; None: stand."""
        self.wanted, self.refuge, self.queueing = route, None, False
        return Drive(route)

    def look_out(self, pose: Pose, mates: list[Mate], standing: Route, now: float) -> Drive | None:
        """Make room if right of way demands it, and go on when the mate has passed.

        ``standing``: the map to move aside on while no route is wanted.
        """
        route = self.wanted or standing
        corner = np.array((route.frame.origin_x, route.frame.origin_y))
        place = np.array((pose.x, pose.y))
        here = place - corner
        ahead = self.ahead(pose) - corner
        me = Intent(self.robot, here[0], here[1], ahead, self.spec.radius, self.spec.speed, pose.slowed)
        others = [_intent(mate, corner) for mate in mates if not mate.silent(now) and self._minds(mate, pose)]
        refuge = give_way(route.passable, route.frame.resolution, me, others)
        self.queueing = refuge is None and self._queues(route, me, others, place, now)
        if self.queueing:
            refuge, self.yielding_since = here[None], now
        if refuge is None:
            if not self.yielding:
                return None
            self.refuge = None
            self.yielded = place, now - self.yielding_since
            return Drive(self.wanted)
        if not self.yielding:
            self.yielding_since = now - self._yielded_before(place)
        self.refuge = refuge + corner
        return Drive(Route(self.refuge, route.passable, route.frame, route.room))

    def _minds(self, mate: Mate, pose: Pose) -> bool:
        """Tell whether a mate is near enough for right of way, or to stand in a refuge that is looked at."""
        corner = (WINDOW + self.spec.radius + mate.radius + 1.0) * sqrt(2.0)
        return hypot(mate.x - pose.x, mate.y - pose.y) < max(2.0 * HORIZON + 1.0, corner)

    def _queues(
        self, route: Route, me: Intent, others: list[Intent], place: NDArray[np.float64], now: float
    ) -> bool:
        """Tell whether to wait for those before it; not for ever, lest all wait for each other."""
        if not queues(route.passable, route.frame.resolution, me, others):
            return False
        if self.queue is None or np.hypot(*(place - self.queue[0])) >= ON_ITS_WAY:
            self.queue = place, now
        return now - self.queue[1] <= YIELD_LIMIT

    def _yielded_before(self, place: NDArray[np.float64]) -> float:
        """Return how long it has made room there already [s], lest two let each other pass for ever."""
        if self.yielded is None or np.hypot(*(place - self.yielded[0])) >= ON_ITS_WAY:
            return 0.0
        return self.yielded[1]

    def ahead(self, pose: Pose) -> NDArray[np.float64]:
        """Return what is left of the wanted path, ``(L, 2)`` [m], team frame, for the next few metres."""
        if self.wanted is None:
            return np.empty((0, 2))
        return remaining(self.wanted.path, pose.x, pose.y, HORIZON)

    def beaconed(self, pose: Pose) -> NDArray[np.float64]:
        """Return the next few metres that the robot will really drive, ``(L, 2)`` [m], team frame."""
        if self.refuge is not None and not self.queueing:
            return remaining(self.refuge, pose.x, pose.y, HORIZON)
        return self.ahead(pose)


def _intent(mate: Mate, corner: NDArray[np.float64]) -> Intent:
    x, y = (mate.x, mate.y) - corner
    return Intent(mate.robot, x, y, mate.path - corner, mate.radius, mate.speed, mate.slowed)

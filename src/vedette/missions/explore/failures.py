"""Stops that one robot could not carry out: left alone for a while, then given up."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from vedette.domains.mapping.left_alone import GivenUp, Place
from vedette.domains.mapping.platform import SAME_PLACE, MappingPlatform
from vedette.domains.mapping.stops import LEFT_ALONE

AVOID_TIME = 10.0  # a stop that could not be carried out is left alone for so long, longer each time [s]
TRIES = 3  # a stop that could not be carried out so often is given up
BLOCKING = 3.0  # a mate this near may have kept the robot from a stop [m]
CHANCES = 2  # a stop is taken up again so often because who kept the robot from it has gone


@dataclass(eq=False)
class Failures:
    """What becomes of the stops of a platform that its robot did not get to."""

    platform: MappingPlatform
    _released: list[tuple[float, float]] = field(default_factory=list)  # stops that could not be carried out
    _despaired: list[tuple[float, float]] = field(default_factory=list)  # those that were given up for that

    def put_off(self, x: float, y: float, unknown: int, now: float) -> None:
        """Leave a stop alone, longer after each try; after the last one until the map changes.

        ``unknown``: cells near the frontier at (x, y) [m], team frame.
        """
        self._released.append((x, y))
        near = [np.hypot(x - u, y - v) < SAME_PLACE for u, v in self._released]
        if sum(near) < TRIES:
            self.platform.left_alone.avoided.append((x, y, now + AVOID_TIME * sum(near)))
        else:
            kept_off = self._kept_off(x, y)
            self.platform.left_alone.given_up.append(GivenUp(x, y, unknown, visited=False, kept_off=kept_off))
            self._despaired.append((x, y))
            self._released = [spot for spot, same in zip(self._released, near, strict=True) if not same]

    def postponed(self, now: float) -> bool:
        """Tell whether a stop of the last round is left alone for a while only."""
        considered = self.platform.considered
        return any(
            until > now and np.any(np.hypot(*(considered - (x, y)).T) < LEFT_ALONE)
            for x, y, until in self.platform.left_alone.avoided
        )

    def _kept_off(self, x: float, y: float) -> tuple[Place, ...]:
        """Return who may have kept the robot from a stop, with itself; nobody, after some chances."""
        if sum(np.hypot(x - u, y - v) < SAME_PLACE for u, v in self._despaired) >= CHANCES:
            return ()
        here = self.platform.x, self.platform.y
        near = tuple(spot for spot in self.platform.team if math.dist(spot[1:], here) < BLOCKING)
        return near if len(near) > 1 else ()

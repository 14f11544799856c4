"""Frontiers that are left alone, and for how long."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from vedette.domains.mapping.belief import MapBelief
from vedette.domains.mapping.stops import LEFT_ALONE, enough_of_sight, nearest_view, seen_from, unknown_near
from vedette.team import PlatformSpec

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

    @property
    def at(self) -> tuple[float, float]:
        """Where it is [m], team frame."""
        return self.x, self.y

    def stands(self, team: Sequence[Place]) -> bool:
        """Tell whether all who stood about when it was given up are still there."""
        now = {robot: (x, y) for robot, x, y in team}
        return all(
            robot in now and math.dist(now[robot], (x, y)) < ELSEWHERE for robot, x, y in self.kept_off
        )


@dataclass(eq=False)
class LeftAlone:
    """What one robot leaves alone: by its own visits, by its mates', and what it could not get to."""

    spec: PlatformSpec
    visited: list[Visit] = field(default_factory=list)  # since the last round
    closer: list[GivenUp] = field(default_factory=list)  # seen from afar in vain: to be visited from nearer
    given_up: list[GivenUp] = field(default_factory=list)  # by this robot
    told: list[GivenUp] = field(default_factory=list)  # by anybody, as of the last round
    hearsay: list[GivenUp] = field(default_factory=list)  # by one alone, whose word is not enough in the end
    avoided: list[tuple[float, float, float]] = field(default_factory=list)  # x, y [m], until [s]

    def judge(self, belief: MapBelief, team: Sequence[Place], now: float) -> None:
        """Give up frontiers that a visit did not change; take up again those whose surroundings changed.

        A visit from afar that changed nothing calls for one from nearer. Two cells or an eighth of them are
        no change, unless the robot sees so little that they are all that a look shows.
        """
        much = 0.5 * enough_of_sight(self.spec) / belief.frame.resolution**2  # cells

        def unchanged(x: float, y: float, before: int) -> bool:
            seen = before - unknown_near(belief.classes, belief.frame, x, y)
            return seen <= min(much, max(2, before // 8))

        def still(spots: list[GivenUp]) -> list[GivenUp]:
            return [spot for spot in spots if unchanged(*spot.at, spot.unknown) and spot.stands(team)]

        self.given_up, self.closer = still(self.given_up), still(self.closer)
        self.told, self.hearsay = still(self.told), still(self.hearsay)
        self.avoided = [spot for spot in self.avoided if spot[2] > now]
        for x, y, before, afar in self.visited:
            now_unknown = unknown_near(belief.classes, belief.frame, x, y)
            if now_unknown and unchanged(x, y, before):
                in_vain = self.given_up if self._was_near(belief, x, y, afar) else self.closer
                in_vain.append(GivenUp(x, y, now_unknown))
        self.visited.clear()

    def _was_near(self, belief: MapBelief, x: float, y: float, afar: float) -> bool:
        """Tell whether a frontier was looked at from near enough to be given up.

        That is from within a metre; one that the body may fit through, as near as it gets, if it has not been
        tried to get nearer.
        """
        cell = belief.frame.resolution
        if afar > seen_from(self.spec, cell, close=True) + cell:
            return False
        tried = near_any(np.array([(x, y)]), (spot.at for spot in self.closer), LEFT_ALONE).any()
        if tried or afar <= nearest_view(self.spec, cell) + cell or not len(belief.frontier_cells):
            return True
        away = np.hypot(*(belief.frame.centres(belief.frontier_cells) - (x, y)).T)
        k = int(np.searchsorted(belief.frontier_starts, int(np.argmin(away)), side="right")) - 1
        return bool(np.diff(belief.frontier_starts)[k] * cell <= 2.0 * self.spec.radius + 1e-9)

    @property
    def looked_at(self) -> list[GivenUp]:
        """What the robot has looked at in vain, from near or from afar."""
        return [*(spot for spot in self.given_up if spot.visited), *self.closer]

    @property
    def missed(self) -> list[GivenUp]:
        """What it could not get to, and tries no more."""
        return [spot for spot in self.given_up if not spot.visited]

    def holds(self, places: NDArray[np.float64], within: float) -> NDArray[np.bool_]:
        """Tell which of ``(K, 2)`` places are so near to what is left alone [m]."""
        spots = (spot.at for spot in (*self.given_up, *self.told, *self.hearsay))
        return near_any(places, spots, within) | self.avoids(places, within)

    def avoids(self, places: NDArray[np.float64], within: float) -> NDArray[np.bool_]:
        """Tell which of ``(K, 2)`` places are so near to what is left alone for a while [m]."""
        return near_any(places, (spot[:2] for spot in self.avoided), within)


def near_any(
    places: NDArray[np.float64], spots: Iterable[tuple[float, float]], within: float
) -> NDArray[np.bool_]:
    """Tell which of ``(K, 2)`` places are nearer than so much to any of some spots [m]."""
    near = np.zeros(len(places), np.bool_)
    for x, y in spots:
        near |= np.hypot(places[:, 0] - x, places[:, 1] - y) < within
    return near

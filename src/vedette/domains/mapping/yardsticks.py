"""Planners to compare with: nearest frontier (Yamauchi) and coordinated assignment (Burgard et al.).

Both use the same map, stops, hysteresis and give-up rules as the negotiating planners, and publish the impact
of what they chose; they differ only in how they choose.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vedette.domains.mapping.belief import MapBelief
from vedette.domains.mapping.impact import Impact
from vedette.domains.mapping.platform import STAY, MappingPlatform, Tour
from vedette.kernels import distance

STICK = 1.0  # a new choice must be nearer than the present one by this much [m]


@dataclass(eq=False)
class NearestPlatform(MappingPlatform):
    """Goes to the nearest frontier, whatever the others do (Yamauchi 1998)."""

    def reply(self, belief: MapBelief, others: Impact, current: Tour) -> Tour:
        """Return the nearest stop, keeping the present one unless another is clearly nearer."""
        assert self.stops is not None
        cost = self.stops.first_leg * self.spec.speed
        if not np.isfinite(cost).any():
            return STAY
        best = int(np.argmin(cost))
        if len(current) and cost[current.stops[0]] <= cost[best] + STICK:
            return current
        return self.tour(np.array([best]))


@dataclass(eq=False)
class BurgardPlatform(MappingPlatform):
    """Takes its part of the team assignment of Burgard et al. (T-RO 2005), which every robot computes alike.

    Pairs (robot, frontier) are taken in order of ``U_t - beta V``; each assignment lowers the utility of the
    frontiers within sensor range of the one taken by ``1 - d / range``.
    """

    beta: float = 1.0  # weight of the path length, in sensor ranges, against the utility

    def reply(self, belief: MapBelief, others: Impact, current: Tour) -> Tour:
        """Return the stop that the assignment gives this robot."""
        assert self.stops is not None
        if not np.isfinite(self.stops.first_leg).any():
            return STAY
        costs = self._costs(belief, current)
        chosen = self._assign(costs)
        return self.tour(np.array([chosen])) if chosen >= 0 else STAY

    def _costs(self, belief: MapBelief, current: Tour) -> NDArray[np.float64]:
        """Path lengths [m] of all robots (rows, by place) to all stops; this robot's row is its own."""
        assert self.stops is not None
        assert self.ground is not None
        frame = belief.frame
        views = np.array([frame.flat(x, y) for x, y in self.stops.views])
        reachable = np.isfinite(self.stops.first_leg)
        rows = []
        for robot, (x, y) in enumerate(self._places):
            if robot == self._row:
                row = self.stops.first_leg.astype(np.float64) * self.spec.speed
                if len(current):
                    row[current.stops[0]] -= STICK
            else:
                r, c = np.clip(frame.cell(x, y), 0, (frame.rows - 1, frame.cols - 1))
                field = distance.distance_field(
                    self.ground.passable, int(r * frame.cols + c), frame.resolution, views
                )
                row = field.ravel()[views].astype(np.float64)
            rows.append(np.where(reachable, row, np.inf))
        return np.array(rows)

    @property
    def _places(self) -> list[tuple[float, float]]:
        """Where all robots are, in an order that all agree on: ties must fall alike for everybody."""
        return sorted((x, y) for _, x, y in self.team)

    @property
    def _row(self) -> int:
        here = [np.hypot(x - self.x, y - self.y) for x, y in self._places]
        return int(np.argmin(here))

    def _assign(self, costs: NDArray[np.float64]) -> int:
        assert self.stops is not None
        utility = np.ones(len(self.stops))
        free = np.ones(len(costs), bool)
        while free.any():
            net = np.where(free[:, None], utility - self.beta * costs / self.spec.range, -np.inf)
            robot, stop = np.unravel_index(int(np.argmax(net)), net.shape)
            if not np.isfinite(net[robot, stop]):
                return -1
            if robot == self._row:
                return int(stop)
            free[robot] = False
            away = np.hypot(*(self.stops.targets - self.stops.targets[stop]).T)
            utility -= np.clip(1.0 - away / self.spec.range, 0.0, 1.0)
        return -1

"""Planners to compare with: nearest frontier (Yamauchi) and coordinated assignment (Burgard et al.).

Both use the same map, stops, hysteresis and give-up rules as the negotiating planners, and publish the impact
of what they chose; they differ only in how they choose.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vedette.domains.mapping.baselines.team import STICK, TeamPlatform
from vedette.domains.mapping.belief import MapBelief
from vedette.domains.mapping.impact import Impact
from vedette.domains.mapping.platform import MappingPlatform
from vedette.domains.mapping.tour import STAY, Tour

__all__ = ["STICK", "BurgardPlatform", "NearestPlatform"]


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
class BurgardPlatform(TeamPlatform):
    """Takes its part of the team assignment of Burgard et al. (T-RO 2005), which every robot computes alike.

    Pairs (robot, frontier) are taken in order of ``U_t - beta V``; each assignment lowers the utility of the
    frontiers within sensor range of the one taken by ``1 - d / range``.
    """

    beta: float = 1.0  # weight of the path length, in sensor ranges, against the utility

    def reply(self, belief: MapBelief, others: Impact, current: Tour) -> Tour:
        """Return the stop that the assignment gives this robot."""
        if not np.isfinite(self.lengths[self.row]).any():
            return STAY
        chosen = self._assign(self.sticky(current))
        return self.tour(np.array([chosen])) if chosen >= 0 else STAY

    def _assign(self, lengths: NDArray[np.float64]) -> int:
        assert self.stops is not None
        utility = np.ones(len(self.stops))
        free = np.ones(len(lengths), bool)
        while free.any():
            net = np.where(free[:, None], utility - self.beta * lengths / self.spec.range, -np.inf)
            robot, stop = np.unravel_index(int(np.argmax(net)), net.shape)
            if not np.isfinite(net[robot, stop]):
                return -1
            if robot == self.row:
                return int(stop)
            free[robot] = False
            away = np.hypot(*(self.stops.targets - self.stops.targets[stop]).T)
            utility -= np.clip(1.0 - away / self.spec.range, 0.0, 1.0)
        return -1

"""All known frontiers divided into routes, so that the longest is short."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from vedette.domains.mapping.baselines.routes import Graph, Routes, plan_routes
from vedette.domains.mapping.baselines.team import STICK, TeamPlatform
from vedette.domains.mapping.belief import MapBelief
from vedette.domains.mapping.impact import Impact
from vedette.domains.mapping.tour import STAY, Tour


@dataclass(eq=False)
class MakespanPlatform(TeamPlatform):
    """Goes to the first stop of its route through its part of all frontiers (min-max travelling salesmen).

    Source: Franca et al., Transportation Science 1995; frontiers by routes: Faigl et al., IROS 2012.
    """

    routes: Routes = field(init=False, default_factory=list)  # by row
    between: NDArray[np.float64] = field(init=False, default_factory=lambda: np.empty((0, 0)))  # (K, K) [m]

    def prepare(self, belief: MapBelief) -> None:
        """Find the stops, the path lengths, and everybody's route."""
        super().prepare(belief)
        assert self.stops is not None
        self.between = self.stops.legs.astype(np.float64) * self.spec.speed
        self.routes = plan_routes(self.lengths, self.between)

    def reply(self, belief: MapBelief, others: Impact, current: Tour) -> Tour:
        """Return the route's first stop; the present one if to begin with it is hardly longer.

        A robot without a route stands. Only where nobody goes anywhere, because what is left was given to
        somebody who leaves it alone, it goes to the nearest stop.
        """
        own = self.lengths[self.row]
        route = self.routes[self.row]
        if not route and not len(others.keys) and np.isfinite(own).any():
            route = [int(np.argmin(own))]
        if not route:
            return STAY
        if len(current) and self._by_way_of(int(current.stops[0]), route) <= self._length(route) + STICK:
            return self.tour(current.stops[:1])
        return self.tour(np.array(route[:1]))

    def _length(self, route: list[int]) -> float:
        steps = self.between[route[:-1], route[1:]]
        return float(self.lengths[self.row, route[0]] + steps.sum())

    def _by_way_of(self, stop: int, route: list[int]) -> float:
        """Length of a short route through the same stops that begins with another [m]."""
        rest = [other for other in route if other != stop]
        onwards, among = self.between[[stop]][:, rest], self.between[np.ix_(rest, rest)]
        graph = Graph.of(onwards, among)
        lengths = graph.lengths(plan_routes(onwards, among))
        return float(self.lengths[self.row, stop] + lengths[0])

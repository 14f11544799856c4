"""Seen on the way: a stop shows what is seen on the way to it, too."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from vedette.domains.mapping.belief import MapBelief
from vedette.domains.mapping.impact import quantise
from vedette.domains.mapping.platform import MappingPlatform
from vedette.domains.mapping.stops import to_be_seen
from vedette.kernels import distance
from vedette.kernels.coverage import Footprints

APART = 2.0  # looks on the way [m]


@dataclass(eq=False)
class WayPlatform(MappingPlatform):
    """Counts for each stop what looks every 2 m of the shortest way to it, from where the robot is, show."""

    def prepare(self, belief: MapBelief) -> None:
        """As every platform; then look on the ways."""
        super().prepare(belief)
        if self.leads_anywhere:
            assert self.stops is not None
            self.stops = replace(self.stops, footprints=self._with_ways(belief))

    def _with_ways(self, belief: MapBelief) -> Footprints:
        assert self.stops is not None
        assert self.ground is not None
        step = max(1, round(APART / belief.frame.resolution))
        looks, of = list[int](), list[int]()
        for k in np.flatnonzero(np.isfinite(self.stops.first_leg)):
            view = belief.frame.flat(*self.stops.views[k])
            way = distance.path_to(self.ground.field, self.ground.passable, view)[step:-1:step]
            looks += way.tolist()
            of += [int(k)] * len(way)
        at = np.array(looks, np.int64)
        starts, cells, shares = to_be_seen(belief, self.spec, self.model(belief), at, at)
        marks = self.stops.footprints
        owners = np.concatenate(
            (np.repeat(np.arange(len(self.stops)), np.diff(marks.starts)), np.repeat(of, np.diff(starts)))
        ).astype(np.int64)
        seen = np.concatenate((marks.cells, belief.planning_cells(cells)))
        misses = np.concatenate((marks.misses, quantise(shares)))
        order = np.lexsort((255 - misses, seen, owners))  # of each cell the surest look comes first
        owners, seen, misses = owners[order], seen[order], misses[order]
        first = np.append(True, (np.diff(owners) != 0) | (np.diff(seen.astype(np.int64)) != 0))[: len(seen)]
        bounds = np.searchsorted(owners[first], np.arange(len(self.stops) + 1))
        return Footprints(bounds.astype(np.int64), seen[first], misses[first])

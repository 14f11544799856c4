"""Late frontiers at once: each falls back by itself to closer views and narrower ways, not all together."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from vedette.domains.mapping.belief import MapBelief
from vedette.domains.mapping.platform import LEAST_AREA, MappingPlatform
from vedette.domains.mapping.sightings import SightingModel
from vedette.domains.mapping.stops import (
    CLEARANCES,
    LEFT_ALONE,
    Ground,
    Stops,
    find_stops,
    legs_between,
    survey,
)
from vedette.domains.mapping.views import MOST_STOPS, look
from vedette.kernels.coverage import Footprints


@dataclass(eq=False)
class LatePlatform(MappingPlatform):
    """Looks at every frontier from where it can, at once: from afar, from close by, then by narrower ways."""

    def _finds_anything(self, belief: MapBelief, model: SightingModel) -> bool:
        lots: list[Stops] = []
        grounds: list[Ground] = []
        left = np.arange(len(belief.frontier_starts) - 1)
        for clearance in CLEARANCES:
            ground = survey(belief, self.spec, self.x, self.y, self.obstacles, clearance)
            grounds.append(ground)
            for close in (False, True):
                found, served = self._stops_of(belief, ground, model, left, close)
                lots.append(found)
                left = np.setdiff1d(left, served)
        self.budget.look(belief.frame, grounds[0].passable)
        self.ground = grounds[-1] if any(len(lot) for lot in lots[2:]) else grounds[0]
        stops = joined(belief, self.ground, lots, self.spec.speed)
        self.considered = stops.targets
        self.stops = self._open(stops, LEFT_ALONE)
        return self.leads_anywhere or super()._finds_anything(belief, model)

    def _stops_of(
        self, belief: MapBelief, ground: Ground, model: SightingModel, clusters: np.ndarray, close: bool
    ) -> tuple[Stops, np.ndarray]:
        """Return the stops of some frontiers, and which frontiers these are of."""
        parts = [belief.frontier_cells[slice(*belief.frontier_starts[k : k + 2])] for k in clusters]
        cells = np.concatenate([np.empty(0, np.int64), *parts])
        starts = np.cumsum([0, *map(len, parts)])
        some = replace(belief, frontier_cells=cells, frontier_starts=starts)
        closer = [spot.at for spot in self.left_alone.closer]
        seen = look(some, ground, self.spec, close=close, closer=closer)
        least = max(LEAST_AREA, 0.5 * belief.frame.resolution**2)
        stops = find_stops(some, ground, self.spec, model, least, seen, tours=False, stall=self.stall)
        targets = [belief.frame.flat(x, y) for x, y in stops.targets[np.isfinite(stops.first_leg)]]
        of = dict(zip(cells.tolist(), np.repeat(clusters, np.diff(starts)).tolist(), strict=True))
        return stops, np.array([of[target] for target in targets], np.int64)


def joined(belief: MapBelief, ground: Ground, lots: list[Stops], speed: float) -> Stops:
    """Return the nearest of several lots of stops as one."""
    first = np.concatenate([lot.first_leg for lot in lots])
    nearest = np.sort(np.argsort(first, kind="stable")[:MOST_STOPS])
    chosen = np.isin(np.arange(len(first)), nearest)
    marks = [lot.footprints for lot in lots]
    sizes = np.concatenate([np.diff(mark.starts) for mark in marks])
    entries = np.repeat(chosen, sizes)
    views = np.concatenate([lot.views for lot in lots])[chosen]
    cells = np.array([belief.frame.flat(x, y) for x, y in views], np.int64)
    return Stops(
        np.concatenate([lot.targets for lot in lots])[chosen],
        views,
        np.concatenate([lot.unknown for lot in lots])[chosen],
        Footprints(
            np.concatenate(([0], np.cumsum(sizes[chosen]))).astype(np.int64),
            np.concatenate([mark.cells for mark in marks])[entries],
            np.concatenate([mark.misses for mark in marks])[entries],
        ),
        first[chosen],
        legs_between(belief, ground, cells) / np.float32(speed),
    )

"""A certain bonus a frontier: who visits it surely sees what touches it, so nobody else holds it too."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vedette.domains.mapping.belief import MapBelief
from vedette.domains.mapping.frontier_worth import touching
from vedette.domains.mapping.platform import MappingPlatform
from vedette.kernels.coverage import Footprints
from vedette.kernels.misses import CERTAIN


@dataclass(eq=False)
class SurePlatform(MappingPlatform):
    """Takes the planning cells of the unknown cells beside a stop's frontier for surely seen."""

    def prepare(self, belief: MapBelief) -> None:
        """As every platform; then make the bonuses certain."""
        super().prepare(belief)
        if self.stops is not None and len(self.stops):
            self.stops = replace(self.stops, footprints=self._with_bonuses(belief))

    def _with_bonuses(self, belief: MapBelief) -> Footprints:
        assert self.stops is not None
        marks, (cells, of) = self.stops.footprints, beside(belief)
        cluster = dict(zip(belief.frontier_cells.tolist(), _owners(belief).tolist(), strict=True))
        rows: list[tuple[NDArray[np.uint32], NDArray[np.uint8]]] = []
        for k, (x, y) in enumerate(self.stops.targets):
            row = slice(marks.starts[k], marks.starts[k + 1])
            bonus = np.unique(cells[of == cluster.get(belief.frame.flat(x, y), -1)])
            seen = np.union1d(marks.cells[row], bonus)
            misses = np.zeros(len(seen), np.uint8)
            misses[np.searchsorted(seen, marks.cells[row])] = marks.misses[row]
            misses[np.searchsorted(seen, bonus)] = CERTAIN
            rows.append((seen, misses))
        starts = np.cumsum([0, *(len(seen) for seen, _ in rows)], dtype=np.int64)
        return Footprints(starts, *(np.concatenate(part) for part in zip(*rows, strict=True)))


def _owners(belief: MapBelief) -> NDArray[np.int64]:
    return np.repeat(np.arange(len(belief.frontier_starts) - 1), np.diff(belief.frontier_starts))


def beside(belief: MapBelief) -> tuple[NDArray[np.uint32], NDArray[np.int64]]:
    """Return the planning cells of the unknown cells that touch frontiers, and which each touches."""
    frontiers = belief.frontier_cells, belief.frontier_starts
    touched, of = touching(belief.classes, *frontiers, belief.factor)
    return belief.planning_cells(touched.astype(np.uint32)), of

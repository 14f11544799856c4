"""A mapping strategy: the stops to visit, in order."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vedette.domains.mapping.impact import NOTHING
from vedette.domains.mapping.layers import TimeLayers
from vedette.kernels import coverage
from vedette.kernels.coverage import LAYERS, Footprints
from vedette.kernels.misses import Keys, Misses


@dataclass(frozen=True, eq=False)
class Tour:
    """A strategy: the stops to visit, in order."""

    targets: NDArray[np.float64]  # (L, 2) the frontiers' middles [m], team frame
    views: NDArray[np.float64]  # (L, 2) where to stand [m], team frame
    arrivals: NDArray[np.float64]  # (L,) after the round's t0 [s]
    unknown: NDArray[np.int64]  # (L,) cells unknown near each frontier when planned
    stops: NDArray[np.int64]  # (L,) index among the round's stops

    def __len__(self) -> int:
        return len(self.targets)

    def __eq__(self, other: object) -> bool:
        """Within a round, tours over the same stops are the same."""
        return isinstance(other, Tour) and np.array_equal(self.stops, other.stops)

    def __hash__(self) -> int:
        return hash(self.stops.tobytes())

    def after_first(self) -> Tour:
        """Return the tour without its first stop."""
        return Tour(self.targets[1:], self.views[1:], self.arrivals[1:], self.unknown[1:], self.stops[1:])


def on_the_way(marks: Footprints, tour: Tour, layers: TimeLayers) -> tuple[Keys, Misses]:
    """Return what a tour shows of what its stops do, each in the layer of its arrival."""
    total = NOTHING.sparse
    for stop, arrival in zip(tour.stops, tour.arrivals, strict=True):
        row = slice(marks.starts[stop], marks.starts[stop + 1])
        keys = marks.cells[row] * np.uint32(LAYERS) + np.uint32(layers.layer(arrival))
        total = coverage.combine(*total, keys, marks.misses[row])
    return total


_NONE, _NOWHERE = np.empty(0, np.int64), np.empty((0, 2))
STAY = Tour(_NOWHERE, _NOWHERE, np.empty(0), _NONE, _NONE)

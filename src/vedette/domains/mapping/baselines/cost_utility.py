"""Utility against cost, everybody for itself."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vedette.domains.mapping.baselines.team import STICK
from vedette.domains.mapping.belief import LN2, MapBelief
from vedette.domains.mapping.impact import Impact
from vedette.domains.mapping.platform import MappingPlatform
from vedette.domains.mapping.stops import Stops
from vedette.domains.mapping.tour import STAY, Tour
from vedette.kernels.misses import CERTAIN, STEPS_PER_NAT


@dataclass(eq=False)
class CostUtilityPlatform(MappingPlatform):
    """Goes where ``A exp(-beta L)`` is largest, whatever the others do.

    *A* is the unknown area that a scan is expected to reveal, *L* the path length: utility ln A less cost.
    Source: Gonzalez-Banos & Latombe, IJRR 2002.
    """

    beta: float = 0.2  # price of a metre, against the logarithm of the area [1/m]

    def reply(self, belief: MapBelief, others: Impact, current: Tour) -> Tour:
        """Return the stop of most utility less cost; the present one counts as a metre nearer."""
        assert self.stops is not None
        length = self.stops.first_leg.astype(np.float64) * self.spec.speed
        if not np.isfinite(length).any():
            return STAY
        if len(current):
            length[current.stops[0]] -= STICK
        net = np.log(expected_areas(belief, self.stops)) - self.beta * length  # docs/theory.md (V61)
        return self.tour(np.array([int(np.argmax(net))]))


def expected_areas(belief: MapBelief, stops: Stops) -> NDArray[np.float64]:
    """Return the unknown area that a scan from each stop is expected to reveal, (K,) [m^2]."""
    marks = stops.footprints
    seen = np.where(marks.misses == CERTAIN, 1.0, -np.expm1(marks.misses / -STEPS_PER_NAT))
    stop = np.repeat(np.arange(len(stops)), np.diff(marks.starts))
    nats = np.bincount(stop, seen * belief.weights.of(marks.cells), minlength=len(stops))
    area: NDArray[np.float64] = nats / LN2 * belief.frame.resolution**2
    return area

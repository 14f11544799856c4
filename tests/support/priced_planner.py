"""Planners for tests: robots price the end of their tours, and reply by trying tours one after another."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vedette.domains.mapping import layers
from vedette.domains.mapping.belief import MapBelief
from vedette.domains.mapping.impact import Impact
from vedette.domains.mapping.objective import MappingObjective
from vedette.domains.mapping.planners import HIDDEN_AREA, RETURN_PRICE, Planner
from vedette.domains.mapping.platform import MappingPlatform
from vedette.domains.mapping.price import EndPrice
from vedette.domains.mapping.tour import STAY, Tour
from vedette.team import PlatformSpec

LONGEST = 3  # stops
MARGIN = 1e-6  # of what a tour must gain, beside rounding

_OBJECTIVE = MappingObjective()


@dataclass(eq=False)
class PricedPlatform(MappingPlatform):
    """Takes the best of: to stay, its present tour, single stops, and the best of them led on greedily."""

    def reply(self, belief: MapBelief, others: Impact, current: Tour) -> Tour:
        """Return the best of them in J, the price included."""
        assert self.stops is not None
        reachable = np.flatnonzero(np.isfinite(self.stops.first_leg))
        best, tours = current, [STAY, *(self.tour(np.array([k])) for k in reachable)]
        for _ in range(LONGEST):
            values = self._worth(belief, others, [best, *tours])
            k = int(np.argmax(values))
            if values[k] <= values[0] + MARGIN:
                return best
            best = tours[k - 1]
            tours = [self.tour(np.append(best.stops, k)) for k in reachable if k not in best.stops]
        return best

    def _worth(self, belief: MapBelief, others: Impact, tours: list[Tour]) -> NDArray[np.float64]:
        return _OBJECTIVE.values(belief, others, [self.impact(belief, tour) for tour in tours])


def _priced(price: EndPrice) -> Planner:
    return Planner(
        "tours whose end has a price",
        layers.rate(start=5.0),
        _platform,
        hidden=HIDDEN_AREA,
        return_price=RETURN_PRICE,
        end_price=price,
    )


def _platform(spec: PlatformSpec) -> MappingPlatform:
    return PricedPlatform(spec, max_stops=LONGEST, measured="unknown")


PRICED = _priced(EndPrice(0.03, 0.001))  # some tours are worth it
DEAR = _priced(EndPrice(1e3, 10.0))  # no tour is ever worth it
WRONG = replace(PRICED, end_price=2.0)  # type: ignore[arg-type]

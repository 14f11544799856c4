"""Search teams: aircraft over a patchy sea, each with a dozen flights."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from bench.scale.team import Lots, Team
from vedette.domains.search import worth
from vedette.domains.search.belief import SearchBelief, TargetPdf, freeze
from vedette.domains.search.detectors import DefiniteRange
from vedette.domains.search.impact import Impact, SearchImpactCodec
from vedette.domains.search.objective import SearchObjective
from vedette.domains.search.platform import SearchPlatform
from vedette.maps import GridFrame

LOT = 400.0  # [m]
CELL = 50.0  # [m]
STEP, HORIZON = 5.0, 3  # [s], steps
SPEED, TURN_RATE, CONTROLS = 30.0, 0.2, 2  # [m/s], [rad/s]; 9 flights
EYE = DefiniteRange(detection=0.8, range=100.0)
FIXED_SIDE = 800.0  # [m]


class Flights(list[Impact]):
    """What an aircraft's flights would detect, and their gains as the aircraft itself prices them."""

    def __init__(self, platform: SearchPlatform, belief: SearchBelief) -> None:
        assert platform.options is not None
        super().__init__(platform.impact(belief, flight) for flight in platform.options.flights)
        self.platform = platform


class LocalSearch(SearchObjective):
    """The team's search objective, which leaves pricing its flights to the platform that lists them."""

    def values(self, belief: SearchBelief, others: Impact, own: Sequence[Impact]) -> NDArray[np.float64]:
        """``value(others * own_k)`` for every k."""
        if not isinstance(own, Flights):
            return super().values(belief, others, own)
        return self.value(belief, others) + own.platform.gains(belief, others)


def dense(lots: Lots, rng: np.random.Generator) -> Team:
    """Return one aircraft a lot; in a horizon it flies a lot's width and half."""
    frame = GridFrame(
        CELL, round(lots.rows * lots.side / CELL), round(lots.cols * lots.side / CELL), 0.0, 0.0
    )
    return _team(frame, lots.places(rng), rng)


def fixed(n: int, rng: np.random.Generator) -> Team:
    """Return n aircraft over a square that a dozen of them can search in a horizon."""
    cells = round(FIXED_SIDE / CELL)
    return _team(GridFrame(CELL, cells, cells, 0.0, 0.0), rng.uniform(0.0, FIXED_SIDE, (n, 2)), rng)


def _team(frame: GridFrame, places: NDArray[np.float64], rng: np.random.Generator) -> Team:
    """Return a team that promises nothing beyond the horizon, for promises may lead anywhere."""
    pdf = TargetPdf(frame, rng.exponential(size=frame.shape), dt=STEP)
    belief = freeze(pdf, worth.plain(HORIZON, tail=0.0))
    candidates, reaches = [], []
    for x, y in places.tolist():
        platform = SearchPlatform(SPEED, TURN_RATE, EYE, controls=CONTROLS)
        platform.place((x, y, rng.uniform(-np.pi, np.pi)), None)
        platform.prepare(belief)
        candidates.append(Flights(platform, belief))
        reaches.append(platform.reach())
    codec = SearchImpactCodec(frame.size, belief.layers)
    return Team(LocalSearch(), belief, places, candidates, reaches, codec, codec.bound)

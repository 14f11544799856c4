"""Monitoring teams: robots over a field that has been measured here and there, each with a few ways."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.scale.team import Lots, Team
from vedette.domains.monitoring.belief import FieldBelief
from vedette.domains.monitoring.field import FieldModel
from vedette.domains.monitoring.impact import FieldImpactCodec
from vedette.domains.monitoring.objective import MonitoringBelief, MonitoringObjective
from vedette.domains.monitoring.platform import FieldSensor, MonitoringPlatform
from vedette.domains.monitoring.spots import Spots
from vedette.domains.monitoring.worth import Patrol
from vedette.maps import GridFrame

LOT = 24.0  # [m]
CELL = 4.0  # of planning [m]
LENGTH = 4.0  # of the field [m]
SPEED, HORIZON, BEARINGS = 1.0, 8.0, 3  # [m/s], [s]; 9 ways, staying and going on
EYE = FieldSensor(0.2)
FIXED_SIDE = 64.0  # [m]
SEEN = 0.2  # share of the cells that have been measured


def dense(lots: Lots, rng: np.random.Generator) -> Team:
    """Return one robot a lot; in a horizon it crosses a third of it."""
    rows, cols = (max(2, round(n * lots.side / CELL)) for n in (lots.rows, lots.cols))
    return _team(GridFrame(CELL, rows, cols), lots.places(rng), rng)


def fixed(n: int, rng: np.random.Generator) -> Team:
    """Return n robots over a field that some dozens of them can measure in a horizon."""
    cells = round(FIXED_SIDE / CELL)
    return _team(GridFrame(CELL, cells, cells), rng.uniform(0.0, FIXED_SIDE, (n, 2)), rng)


def _team(frame: GridFrame, places: NDArray[np.float64], rng: np.random.Generator) -> Team:
    seen = np.flatnonzero(rng.random(frame.size) < SEEN)
    known = FieldBelief.prior(FieldModel(frame, length=LENGTH), Spots(frame)).observe(
        seen, np.zeros(len(seen)), np.full(len(seen), EYE.variance)
    )
    belief = MonitoringBelief(known, Patrol(HORIZON, 2, 0.7), 0.25 / EYE.variance)
    candidates, reaches = [], []
    for x, y in places.tolist():
        platform = MonitoringPlatform(SPEED, EYE, bearings=BEARINGS)
        platform.place(x, y, np.inf)
        platform.prepare(belief)
        candidates.append(platform.candidates)
        reaches.append(platform.reach(belief))
    codec = FieldImpactCodec(known.spots.count, belief.patrol.layers)
    return Team(MonitoringObjective(), belief, places, candidates, reaches, codec, codec.bound)

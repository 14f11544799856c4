"""Tracking teams: vehicles with range and bearing sensors among moving targets."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.scale.team import Lots, Team
from vedette.domains.tracking.belief import Tracks, tracks
from vedette.domains.tracking.codec import TrackImpactCodec
from vedette.domains.tracking.models import constant_velocity
from vedette.domains.tracking.objective import TrackingObjective
from vedette.domains.tracking.platform import TrackingPlatform
from vedette.domains.tracking.sensing import Sensor
from vedette.domains.tracking.sensors import RangeBearing

LOT = 20.0  # [m]
HORIZON = 3  # steps of 1 s: 27 courses
SPEED, TURN_RATE = 5.0, 0.6  # [m/s], [rad/s]
TARGETS_A_LOT = 2
NEAR_SENSOR = RangeBearing(range=15.0, view=180.0)
FIXED_TARGETS, FIXED_SIDE = 16, 60.0
FAR_SENSOR = RangeBearing(range=60.0, view=180.0)


def dense(lots: Lots, rng: np.random.Generator) -> Team:
    """Return one vehicle and two targets a lot; a vehicle sees into the lots around its own."""
    corners = np.repeat(lots.corners, TARGETS_A_LOT, axis=0)
    targets = corners + lots.side * rng.random(corners.shape)
    return _team(_tracks(targets, rng), lots.places(rng), NEAR_SENSOR, rng)


def fixed(n: int, rng: np.random.Generator) -> Team:
    """Return n vehicles in a square with sixteen targets, of which each sees about half."""
    targets = rng.uniform(0.0, FIXED_SIDE, (FIXED_TARGETS, 2))
    return _team(_tracks(targets, rng), rng.uniform(0.0, FIXED_SIDE, (n, 2)), FAR_SENSOR, rng)


def _tracks(targets: NDArray[np.float64], rng: np.random.Generator) -> Tracks:
    """Return targets at these places that move at about 1 m/s, each known to about 5 m."""
    count = len(targets)
    means = np.column_stack((targets, rng.normal(size=(count, 2))))
    covariances = [np.diag([v, v, 1.0, 1.0]) for v in rng.uniform(10.0, 40.0, count)]
    return tracks([constant_velocity(1.0, 0.1)] * count, list(means), covariances, dt=1.0, horizon=HORIZON)


def _team(belief: Tracks, places: NDArray[np.float64], sensor: Sensor, rng: np.random.Generator) -> Team:
    candidates, reaches = [], []
    for x, y in places.tolist():
        platform = TrackingPlatform(SPEED, TURN_RATE, sensor)
        platform.place(x, y, rng.uniform(-np.pi, np.pi))
        platform.prepare(belief)
        assert platform.candidates is not None
        candidates.append(platform.candidates)
        reaches.append(platform.reach(belief))
    codec = TrackImpactCodec(len(belief), belief.horizon)
    return Team(TrackingObjective(), belief, places, candidates, reaches, codec, codec.bound)

"""Rotating radars and Kalman targets, and what a decision about them is worth."""

from __future__ import annotations

import datetime
from dataclasses import dataclass
from typing import Any

import numpy as np
from stonesoup.models.transition.linear import CombinedLinearGaussianTransitionModel, ConstantVelocity
from stonesoup.predictor.kalman import KalmanPredictor
from stonesoup.sensor.radar import RadarRotatingBearingRange
from stonesoup.sensormanager.reward import UncertaintyRewardFunction
from stonesoup.types.array import CovarianceMatrix, StateVector
from stonesoup.types.state import GaussianState
from stonesoup.types.track import Track
from stonesoup.updater.kalman import ExtendedKalmanUpdater

SIDE = 100.0  # of the square in which radars and targets are [m]
VIEW = np.radians(30.0)
NOISE = np.diag([np.radians(1.0) ** 2, 5.0**2])  # of bearing and range [rad^2, m^2]
RPM = 29.0  # just under half a turn in a second: 12 dwell angles of 30 degrees in reach, none of them twice
START = datetime.datetime(2026, 1, 1)
THEN = START + datetime.timedelta(seconds=1)


@dataclass(frozen=True, eq=False)
class Scene:
    """A decision to be made at ``THEN``."""

    sensors: tuple[Any, ...]
    tracks: frozenset[Any]
    predictor: Any
    updater: Any

    def reward(self, *, return_tracks: bool = False) -> Any:
        """Return Stone Soup's reward function of this scene."""
        return UncertaintyRewardFunction(self.predictor, self.updater, return_tracks=return_tracks)

    def worth(self, config: Any) -> float:
        """Return what Stone Soup's own reward says of a configuration."""
        return float(self.reward()(config, self.tracks, THEN))


def scene(radars: int, targets: int, rng: np.random.Generator) -> Scene:
    """Return radars and targets at random places, each target with its own uncertainty."""
    model = CombinedLinearGaussianTransitionModel([ConstantVelocity(0.05), ConstantVelocity(0.05)])
    return Scene(
        tuple(_radar(rng) for _ in range(radars)),
        frozenset(_track(rng) for _ in range(targets)),
        KalmanPredictor(model),
        ExtendedKalmanUpdater(measurement_model=None),
    )


def _radar(rng: np.random.Generator) -> Any:
    radar = RadarRotatingBearingRange(
        position=StateVector(rng.uniform(0.0, SIDE, 2)),
        position_mapping=(0, 2),
        ndim_state=4,
        noise_covar=CovarianceMatrix(NOISE),
        dwell_centre=StateVector([0.0]),
        rpm=RPM,
        resolution=VIEW,
        fov_angle=VIEW,
    )
    radar.timestamp = START
    return radar


def _track(rng: np.random.Generator) -> Any:
    (x, y), (vx, vy) = rng.uniform(0.0, SIDE, 2), rng.normal(size=2)
    covariance = CovarianceMatrix(np.diag(rng.uniform(1.0, 30.0, 4)))
    return Track([GaussianState(StateVector([x, vx, y, vy]), covariance, timestamp=START)])

"""Small random tracking scenes."""

from __future__ import annotations

import numpy as np

from vedette.domains.tracking.belief import Tracks, tracks
from vedette.domains.tracking.impact import Impact, impact_of
from vedette.domains.tracking.models import constant_velocity, static
from vedette.domains.tracking.platform import TrackingPlatform
from vedette.domains.tracking.sensors import BearingOnly, Position, RangeBearing, RangeOnly

SIDE = 60.0  # of the square that everything is in [m]
KINDS = (
    BearingOnly(range=40.0),
    RangeBearing(range=30.0, view=120.0),
    RangeOnly(range=40.0, detection=0.8),
    Position(range=25.0),
)


def random_tracks(rng: np.random.Generator, targets: int = 3, horizon: int = 3) -> Tracks:
    """Moving and static targets at random places, known well or badly."""
    models, means, covariances = [], [], []
    for _ in range(targets):
        d = int(rng.choice([2, 4]))
        model = (
            constant_velocity(1.0, 10 ** rng.uniform(-2, 0))
            if d == 4
            else static(1.0, rng.choice([0.0, 0.1]))
        )
        root = rng.normal(size=(d, d)) * ([5.0, 5.0, 1.0, 1.0][:d])
        models.append(model)
        means.append(np.concatenate([rng.uniform(0, SIDE, 2), rng.normal(size=2)])[:d])
        covariances.append(root.T @ root + 0.1 * np.eye(d))
    return tracks(models, means, covariances, dt=1.0, horizon=horizon, k0=7)


def random_impact(rng: np.random.Generator, belief: Tracks) -> Impact:
    """Some targets seen at some steps, with one bearing or in full."""
    h = rng.normal(size=(len(belief), belief.horizon, 2, 2)) * 10 ** rng.uniform(-2, 1)
    h[rng.random(h.shape[:2]) < 0.3] = 0.0
    h[..., 1] *= rng.random((*h.shape[:2], 1)) < 0.5
    h[rng.random(len(belief)) < 0.3] = 0.0
    info = h @ h.swapaxes(-1, -2)
    return impact_of(np.stack([info[..., 0, 0], info[..., 0, 1], info[..., 1, 1]], -1))


def random_platform(
    rng: np.random.Generator, belief: Tracks, *, continuous: bool = False
) -> TrackingPlatform:
    """A vehicle with a sensor of any kind somewhere, prepared."""
    sensor = KINDS[rng.integers(len(KINDS))]
    platform = TrackingPlatform(rng.uniform(2.0, 6.0), rng.uniform(0.2, 0.8), sensor, continuous=continuous)
    platform.place(*rng.uniform(0, SIDE, 2), rng.uniform(-np.pi, np.pi))
    platform.prepare(belief)
    return platform

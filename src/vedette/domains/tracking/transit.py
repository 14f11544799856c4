"""Where to go while no target can be seen within the horizon."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vedette.domains.tracking.belief import Tracks
from vedette.domains.tracking.geometry import geometry, wrapped
from vedette.domains.tracking.impact import Impact, Impacts
from vedette.domains.tracking.objective import TrackingObjective
from vedette.domains.tracking.sensing import Sensor


def times_to_see(
    sensor: Sensor, speed: float, turn_rate: float, poses: ArrayLike, points: ArrayLike
) -> NDArray[np.float64]:
    """Time to turn towards a point and come within range of it [s], inf where that cannot be.

    Turning first and going straight then: an estimate, for the turn itself takes the vehicle elsewhere.

    Args:
        sensor: what is to see the point.
        speed: [m/s], 0 for one that only turns.
        turn_rate: [rad/s].
        poses: (..., 3) [m, m, rad]; broadcast with
        points: (..., 2) [m].
    """
    pose = np.asarray(poses, np.float64)
    r, radial, _ = geometry(pose, points)
    aside = np.abs(wrapped(np.arctan2(radial[..., 1], radial[..., 0]) - pose[..., 2]))
    to_go = np.maximum(r - sensor.range, 0.0)
    margin = np.where(to_go > 0.0, 0.0, np.radians(sensor.view) / 2.0)
    turn = np.maximum(aside - margin, 0.0)
    return _quotient(turn, turn_rate) + _quotient(to_go, speed)


def nearest_worth(
    objective: TrackingObjective, belief: Tracks, others: Impact, sensor: Sensor, times: NDArray[np.float64]
) -> int | None:
    """The target whose first look gains most for the time that it takes to get there; None: no way to any.

    A look is worth what it would add to the others' impact at the horizon's last step from the edge of the
    range: the rate of uncertainty reduction of the paper's eq. (42), for one look beyond the horizon.

    Args:
        objective, belief, others: whose gain.
        sensor: that would look.
        times: (T,) to see each target [s].
    """
    count = len(belief)
    a, b = sensor.weights(np.array([sensor.range]))
    looks = np.zeros((count, belief.blocks, 3))
    looks[:, belief.horizon - 1, ::2] = sensor.detection * (a + b) / 2.0  # from whatever side
    each = Impacts(np.arange(count + 1), np.arange(count), looks)
    gains = objective.values(belief, others, each) - objective.value(belief, others)
    rates = gains / np.maximum(times, belief.dt)
    best = int(np.argmax(rates))
    return best if rates[best] > 0.0 else None


def _quotient(way: NDArray[np.float64], rate: float) -> NDArray[np.float64]:
    """``way / rate``, inf where there is a way but no rate, 0 where there is no way."""
    return way / rate if rate > 0.0 else np.where(way > 0.0, np.inf, 0.0)

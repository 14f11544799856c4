"""Continuous turn rates: exact gradients through the vehicle's motion, and a monotone ascent."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Rates = NDArray[np.float64]
FACTORS = 2.0 ** np.arange(3, -9, -1)  # steps tried on a line, of the last one that was good
MOST_STEPS = 40
SMALLEST = 1e-9  # relative gain that is worth another step


def turn_rate_gradient(
    pose: NDArray[np.float64], rates: Rates, speed: float, dt: float, by_position: NDArray[np.float64]
) -> Rates:
    """Chain a derivative by the positions along a course (K, 2) to one by its turn rates (K,).

    With turns ``a_k = u_k dt`` and chords ``c_k = V dt sinc(a_k / 2)`` at angles ``m_k``, half a turn past
    the last heading, ``x_k = x_0 + sum_{j<=k} c_j (cos m_j, sin m_j)``: one pass back over the steps.
    docs/theory.md (V30)
    """
    turns = rates * dt
    middles = pose[2] + np.cumsum(turns) - turns / 2.0
    sinc = np.sinc(turns / (2.0 * np.pi))
    small = np.abs(turns) < 1e-4
    sinc_slope = np.where(small, -turns / 12.0, (np.cos(turns / 2.0) - sinc) / np.where(small, 1.0, turns))
    later = np.cumsum(by_position[::-1], axis=0)[::-1]  # each chord moves all positions after it
    along = later[:, 0] * np.cos(middles) + later[:, 1] * np.sin(middles)
    across = speed * dt * sinc * (later[:, 1] * np.cos(middles) - later[:, 0] * np.sin(middles))
    after = np.cumsum(across[::-1])[::-1] - across  # each turn turns all chords after it
    return np.asarray(dt * (speed * dt * sinc_slope * along + across / 2.0 + after))


def ascend(
    values: Callable[[Rates], NDArray[np.float64]],
    gradient: Callable[[Rates], Rates],
    start: Rates,
    limit: float,
) -> tuple[Rates, float]:
    """Climb from ``start`` within ``|u| <= limit``; never ends lower.

    Projected gradient: a dozen step lengths at once are tried, and the best point is taken if it is higher.
    So the hard edges of a sensor's view, which no gradient sees, cost steps but no value.

    Args:
        values: of many points (C, K), as (C,).
        gradient: at one point (K,).
        start: (K,) within the limit.
        limit: [rad/s].

    Returns:
        The highest point found, and its value.
    """
    point, value, step = start, float(values(start[None])[0]), 0.25 * limit
    for _ in range(MOST_STEPS):
        slope = gradient(point)
        steepest = np.abs(slope).max()
        if not steepest > 0.0:
            break
        lengths = step * FACTORS
        tried = np.clip(point + lengths[:, None] * slope / steepest, -limit, limit)
        reached = values(tried)
        best = int(np.argmax(reached))
        if reached[best] - value <= SMALLEST * max(1.0, abs(value)):
            break
        point, value, step = tried[best], float(reached[best]), lengths[best]
    return point, value

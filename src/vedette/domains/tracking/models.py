"""How targets move: linear, with Gaussian disturbances."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vedette.errors import InputError

STATE = 4  # x, y, vx, vy [m, m, m/s, m/s], team frame


@dataclass(frozen=True, eq=False)
class TargetModel:
    """``x' = F x + w, w ~ N(0, Q)`` in one step; docs/tracking.md (V31).

    Every target has the state x, y, vx, vy. One without velocity uses ``d = 2`` of it: the rest is a dummy
    that neither changes nor touches the position, with mean 0 and variance 1, so that nothing is singular.

    Raises:
        InputError: a shape is wrong, a number not finite, F singular, or Q not a covariance.
    """

    F: NDArray[np.float64]  # (4, 4)
    Q: NDArray[np.float64]  # (4, 4) [m, m, m/s, m/s]^2; may be singular
    d: int = STATE  # leading components that are the target's

    def __post_init__(self) -> None:
        for name, matrix in (("F", self.F), ("Q", self.Q)):
            if matrix.shape != (STATE, STATE) or not np.isfinite(matrix).all():
                raise InputError(f"target model: {name} must be 4x4, all finite; got shape {matrix.shape}")
        if not np.array_equal(self.Q, self.Q.T) or np.linalg.eigvalsh(self.Q)[0] < -1e-9 * np.trace(self.Q):
            raise InputError("target model: Q must be symmetric without negative eigenvalues")
        if np.linalg.matrix_rank(self.F) < STATE:
            raise InputError("target model: F must be invertible")
        if self.d not in (2, STATE):
            raise InputError(f"target model: d must be 2 or 4; got {self.d}")

    def move(self, rng: np.random.Generator, state: ArrayLike) -> NDArray[np.float64]:
        """Draw the state (4,) one step later."""
        variances, axes = np.linalg.eigh(self.Q)
        noise = axes @ (np.sqrt(np.maximum(variances, 0.0)) * rng.normal(size=STATE))
        return np.asarray(self.F @ np.asarray(state, np.float64) + noise)


def constant_velocity(dt: float, q: float) -> TargetModel:
    """Near-constant velocity: on each axis an acceleration that is drawn anew for each step.

    Its variance is ``q / dt``, so that the velocity's grows by ``q`` a second at any step; Q has rank 2.

    Args:
        dt: step [s], > 0.
        q: intensity of the acceleration [m^2/s^3], >= 0.
    """
    _check(dt, q, "m^2/s^3")
    push = np.kron(np.array([[dt * dt / 2.0], [dt]]), np.eye(2))
    return TargetModel(np.eye(STATE) + dt * np.eye(STATE, k=2), q / dt * push @ push.T)


def static(dt: float, q: float = 0.0) -> TargetModel:
    """A target that stays where it is, or diffuses: the variance of each coordinate grows by ``q`` a second.

    Args:
        dt: step [s], > 0.
        q: diffusion [m^2/s], >= 0.
    """
    _check(dt, q, "m^2/s")
    return TargetModel(np.eye(STATE), np.diag([q * dt, q * dt, 0.0, 0.0]), d=2)


def _check(dt: float, q: float, unit: str) -> None:
    if not (math.isfinite(dt) and dt > 0.0):
        raise InputError(f"target model: dt must be > 0 s; got {dt}")
    if not (math.isfinite(q) and q >= 0.0):
        raise InputError(f"target model: q must be >= 0 {unit}; got {q}")

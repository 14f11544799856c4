"""Vehicles at constant speed with a bounded turn rate: where a sequence of turn rates takes them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vedette.errors import InputError


def drive(pose: ArrayLike, turn_rates: ArrayLike, speed: ArrayLike, step: float) -> NDArray[np.float64]:
    """Poses after each step: ``psi' = psi + u dt``, ``x' = x + (V/u)(sin psi' - sin psi)``.

    Exact, a straight line as u -> 0.  docs/theory.md (V30)

    Args:
        pose: ``(..., 3)`` x, y, heading at the beginning [m, m, rad].
        turn_rates: ``(..., K)`` held constant during each step [rad/s]; leading axes broadcast with those of
            ``pose``, so that ``(C, K)`` turn rates and one pose give C paths.
        speed: ``(...)`` [m/s].
        step: [s].

    Returns:
        ``(..., K, 3)`` poses at the ends of the steps [m, m, rad]; headings are not wrapped.
    """
    start = np.asarray(pose, np.float64)
    turns = np.asarray(turn_rates, np.float64) * step
    heading = start[..., 2, None] + np.cumsum(turns, axis=-1)
    # A chord of an arc: its length is V dt sinc(turn / 2), its direction the mean of the two headings.
    chord = np.asarray(speed, np.float64)[..., None] * step * np.sinc(turns / (2.0 * np.pi))
    middle = heading - turns / 2.0
    x = start[..., 0, None] + np.cumsum(chord * np.cos(middle), axis=-1)
    y = start[..., 1, None] + np.cumsum(chord * np.sin(middle), axis=-1)
    return np.stack(np.broadcast_arrays(x, y, heading), axis=-1)


def turn_sequences(turn_rate: float, steps: int, choices: int = 3) -> NDArray[np.float64]:
    """Every sequence of evenly spaced turn rates [rad/s], ``(choices**steps, steps)``.

    ``choices`` is odd, so that straight ahead is one; ``turn_rate`` is the most the vehicle can do.
    """
    rates = np.linspace(-turn_rate, turn_rate, choices)
    return np.array(list(product(rates, repeat=steps)), np.float64).reshape(-1, steps)


@dataclass(frozen=True)
class Gust:
    """One of the winds that may carry a vehicle off its way: ``P(y_k | y_{k-1}, u)``; docs/theory.md (V107).

    Raises:
        InputError: a probability that is none, or a wind that is not two finite speeds.
    """

    chance: float  # probabilities of a vehicle's gusts sum to 1
    wind: tuple[float, float]  # [m/s], team frame, all through the horizon

    def __post_init__(self) -> None:
        if not 0.0 <= self.chance <= 1.0:
            raise InputError(f"gust: chance must be from 0 to 1; got {self.chance}")
        if len(self.wind) != 2 or not all(map(math.isfinite, self.wind)):
            raise InputError(f"gust: wind must be two finite speeds [m/s]; got {self.wind}")


CALM = (Gust(1.0, (0.0, 0.0)),)


def check_gusts(gusts: tuple[Gust, ...]) -> None:
    """Raise ``InputError`` for gusts whose probabilities do not sum to 1."""
    if abs(sum(gust.chance for gust in gusts) - 1.0) > 1e-9:
        raise InputError(f"gusts: chances must sum to 1; got {[gust.chance for gust in gusts]}")


def carried(
    poses: NDArray[np.float64], after: NDArray[np.float64], wind: tuple[float, float]
) -> NDArray[np.float64]:
    """Return poses (..., 3) as a wind has moved them, ``after`` (...) seconds of it."""
    moved = poses.copy()
    moved[..., 0] += wind[0] * after
    moved[..., 1] += wind[1] * after
    return moved

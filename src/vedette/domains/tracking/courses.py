"""What a vehicle can do over the horizon: sequences of turn rates."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vedette.vehicle import turn_sequences

CHOICES = 3  # turn rates: right, straight, left
MOST_DECISIONS = 5  # turn rates chosen independently: 3^5 = 243 sequences


@dataclass(frozen=True)
class Course:
    """A strategy: the turn rate of each step of the horizon, held constant during the step."""

    k0: int  # step at whose beginning it starts
    rates: tuple[float, ...]  # (K,) [rad/s], counter-clockwise positive
    target: int | None = None  # where it goes, or stays, after the horizon

    def from_step(self, k0: int, horizon: int) -> Course:
        """Return what is left of it at a later step, straight ahead at the end."""
        left = self.rates[max(0, k0 - self.k0) :][:horizon]
        return Course(k0, left + (0.0,) * (horizon - len(left)), self.target)


def sequences(turn_rate: float, horizon: int, decisions: int = MOST_DECISIONS) -> NDArray[np.float64]:
    """Turn rates that are compared, (C, K) [rad/s], straight ahead first: it wins where all are equal.

    With no more steps than ``decisions`` every sequence of right, straight and left; with more, steps share a
    rate in so many blocks, the earlier ones shorter, for plans are made again before their end.
    """
    if turn_rate == 0.0:
        return np.zeros((1, horizon))
    blocks = min(horizon, decisions)
    lengths = [horizon // blocks + (i >= blocks - horizon % blocks) for i in range(blocks)]
    rates = np.repeat(turn_sequences(turn_rate, blocks, CHOICES), lengths, axis=1)
    turning = np.abs(rates).sum(axis=1)
    return rates[np.argsort(turning, kind="stable")]  # on equal terms, the least turning

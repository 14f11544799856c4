"""What knowing the field is worth by when: a discounted horizon, in layers of time."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vedette.errors import InputError

MOST_LAYERS = 16


@dataclass(frozen=True)
class Patrol:
    """A horizon cut into layers of equal length; what is known from layer l on is worth ``gamma^l`` of it.

    Raises:
        InputError: a number out of its range.
    """

    horizon: float = 60.0  # [s]
    layers: int = 3
    gamma: float = 0.7  # in (0, 1]; 1: only what is known in the end counts

    def __post_init__(self) -> None:
        if not (math.isfinite(self.horizon) and self.horizon > 0.0):
            raise InputError(f"patrol: horizon must be > 0 s; got {self.horizon}")
        if not 1 <= self.layers <= MOST_LAYERS:
            raise InputError(f"patrol: layers must be 1 to {MOST_LAYERS}; got {self.layers}")
        if not 0.0 < self.gamma <= 1.0:
            raise InputError(f"patrol: gamma must be more than 0 and at most 1; got {self.gamma}")

    def layer(self, times: NDArray[np.float64]) -> NDArray[np.int64]:
        """Return the layer of each time after the round's beginning [s]; later ones are in the last."""
        layers = np.floor(times * self.layers / self.horizon).astype(np.int64)
        return np.minimum(layers, self.layers - 1)

    @property
    def weights(self) -> NDArray[np.float64]:
        """(layers,) ``w_l - w_{l+1}`` of ``w_l = gamma^l``, ``w_L = 0``: of what is known by the end of l."""
        worth = np.append(np.float64(self.gamma) ** np.arange(self.layers), 0.0)
        return np.asarray(worth[:-1] - worth[1:])

"""What comes after the horizon: layers of time that grow, in which targets are attended or not."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

SHORTEST = 10.0  # of a layer [s]
RATIO = 1.6  # of each layer's end to that of the one before


def edges(length: float) -> tuple[float, ...]:
    """Return the ends of the layers of a tail so long [s], none if it is shorter than one."""
    ends: list[float] = []
    while SHORTEST * RATIO ** len(ends) < length:
        ends.append(SHORTEST * RATIO ** len(ends))
    return (*ends[:-1], length) if ends else ()


@dataclass(frozen=True, eq=False)
class Tail:
    """T targets as they would be in the middle of each of B layers, had nobody seen them since.

    A layer is worth ``Delta_b / dt`` times the entropy that looks in it would take off the states of then:
    so the tail counts nats in steps, as a sum of the entropy over all steps would. docs/tracking.md (V90)
    """

    ends: tuple[float, ...]  # of the layers, after the horizon [s]
    dt: float  # step [s]
    means: NDArray[np.float64]  # (B, T, 4)
    covariances: NDArray[np.float64]  # (B, T, 2, 2) of the positions

    @cached_property
    def weights(self) -> NDArray[np.float64]:
        """(B,) steps in each layer."""
        return np.diff(np.array((0.0, *self.ends))) / self.dt

    @cached_property
    def spreads(self) -> NDArray[np.float64]:
        """(B, T) Geometric means of the variances of a position [m^2]."""
        return np.asarray(np.sqrt(np.linalg.det(self.covariances)))

    def discounted(self, before: int, gamma: float) -> NDArray[np.float64]:
        """(B,) ``sum gamma^k`` over the steps k of each layer, after so many before; the last never ends."""
        ends = before + np.array((0.0, *self.ends[:-1])) / self.dt
        left = gamma**ends / (1.0 - gamma)
        return np.asarray(left - np.append(left[1:], 0.0))

    def worth(
        self,
        targets: NDArray[np.int64],
        blocks: NDArray[np.float64],
        weights: NDArray[np.float64] | None = None,
    ) -> NDArray[np.float64]:
        """``sum_b w_b 1/2 ln det(1 + P_b I_b)`` of rows (N,) of targets with information (N, B, 3).

        ``weights``: (B,) of the layers; without them their steps.
        """
        p = self.covariances[:, targets].swapaxes(0, 1)
        xx, xy, yy = np.moveaxis(blocks, -1, 0)
        a, b, c = p[..., 0, 0], p[..., 0, 1], p[..., 1, 1]
        growth = a * xx + 2.0 * b * xy + c * yy + (a * c - b * b) * (xx * yy - xy * xy)  # (V37)
        return np.asarray(
            (0.5 * np.log1p(np.maximum(growth, 0.0))) @ (self.weights if weights is None else weights)
        )

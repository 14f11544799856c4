"""Where a robot has been, by what it knows of pairs of places: weighted least squares, (V88)."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
import scipy
from numpy.typing import NDArray

from vedette.sim.odometry import laid_at, seen_from

Floats = NDArray[np.float64]

STEPS = 4  # of Gauss and Newton at most
STILL = 1e-4  # a step this small is the last [m, rad]


@dataclass(eq=False)
class PoseGraph:
    """Places and measured motions between them; the first place is certain."""

    places: Floats  # (n, 3) x, y [m], heading [rad]: the best guess so far
    _pairs: list[tuple[int, int]] = field(default_factory=list)
    _measured: list[Floats] = field(default_factory=list)  # the second as seen from the first
    _deviations: list[Floats] = field(default_factory=list)  # (3,) [m, m, rad]

    def add(self, measured: Floats, deviation: Floats) -> None:
        """Add a place, as it lies from the one before."""
        self.places = np.vstack((self.places, laid_at(self.places[-1], measured)))
        self.tie(len(self.places) - 2, len(self.places) - 1, measured, deviation)

    def tie(self, first: int, second: int, measured: Floats, deviation: Floats) -> None:
        """Tell how two places lie to each other."""
        self._pairs.append((first, second))
        self._measured.append(measured)
        self._deviations.append(deviation)

    def solve(self) -> None:
        """Move all places but the first to where what was measured fits best."""
        pairs = np.array(self._pairs)
        measured, weights = np.array(self._measured), 1.0 / np.array(self._deviations)
        for _ in range(STEPS):
            residual, left, right = _linear(self.places[pairs[:, 0]], self.places[pairs[:, 1]], measured)
            step = _least_squares(
                pairs, weights[:, :, None] * left, weights[:, :, None] * right, weights * residual
            )
            self.places[1:] += step
            if np.abs(step).max() < STILL:
                break


def _linear(first: Floats, second: Floats, measured: Floats) -> tuple[Floats, Floats, Floats]:
    """Return residuals ``(m, 3)`` of motions, and their derivatives ``(m, 3, 3)`` by either place."""
    residual = seen_from(first, second) - measured
    residual[:, 2] = np.remainder(residual[:, 2] + math.pi, math.tau) - math.pi
    c, s = np.cos(first[:, 2]), np.sin(first[:, 2])
    dx, dy = (second - first)[:, 0], (second - first)[:, 1]
    left, right = np.zeros((len(first), 3, 3)), np.zeros((len(first), 3, 3))
    right[:, 0, 0], right[:, 0, 1], right[:, 1, 0], right[:, 1, 1] = c, s, -s, c
    right[:, 2, 2] = 1.0
    left[:] = -right
    left[:, 0, 2], left[:, 1, 2] = -s * dx + c * dy, -c * dx - s * dy
    return residual, left, right


def _least_squares(pairs: NDArray[np.int64], left: Floats, right: Floats, residual: Floats) -> Floats:
    """Return the step ``(n - 1, 3)`` of all places but the first that makes the residuals least."""
    rows = np.arange(len(pairs) * 3).reshape(-1, 3, 1)
    blocks, indices = [], []
    for k, block in enumerate((left, right)):
        cols = (3 * pairs[:, k])[:, None, None] + np.arange(3)
        blocks.append(block.ravel())
        indices.append([np.broadcast_to(each, block.shape).ravel() for each in (rows, cols)])
    places: NDArray[np.int64] = np.concatenate(indices, axis=1)
    jacobian = scipy.sparse.csc_matrix((np.concatenate(blocks), places))[:, 3:]
    solved = scipy.sparse.linalg.splu(scipy.sparse.csc_matrix(jacobian.T @ jacobian)).solve(
        -(jacobian.T @ residual.ravel())
    )
    return np.asarray(solved, np.float64).reshape(-1, 3)

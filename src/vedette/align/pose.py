"""A rigid motion of the plane: where one map's frame lies in another's."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class FramePose:
    """Turns by ``angle`` about the origin, then moves by ``x, y``: ``T_a_b`` takes places of b to a's."""

    x: float  # [m]
    y: float  # [m]
    angle: float  # [rad], counter-clockwise, in (-pi, pi]

    @classmethod
    def of(cls, x: float, y: float, angle: float) -> FramePose:
        """Return the pose with its angle brought into (-pi, pi]."""
        return cls(x, y, math.pi - (math.pi - angle) % (2.0 * math.pi))

    @property
    def rotation(self) -> Floats:
        """``(2, 2)``."""
        c, s = math.cos(self.angle), math.sin(self.angle)
        return np.array([[c, -s], [s, c]])

    def places(self, points: Floats) -> Floats:
        """Return where points ``(n, 2)`` [m] lie in the other frame."""
        return points @ self.rotation.T + (self.x, self.y)

    def after(self, first: FramePose) -> FramePose:
        """Return this motion after another: ``T_a_c = T_a_b.after(T_b_c)``."""
        (x, y) = self.places(np.array([[first.x, first.y]]))[0].tolist()
        return FramePose.of(x, y, self.angle + first.angle)

    def inverse(self) -> FramePose:
        """Return ``T_b_a``."""
        x, y = (-(self.rotation.T @ (self.x, self.y))).tolist()
        return FramePose.of(x, y, -self.angle)

    def apart(self, other: FramePose, at: Floats) -> tuple[float, float]:
        """Return how far apart two poses take the place ``at`` (2,), and the angle between them [m, rad]."""
        (dx, dy) = (self.places(at[None]) - other.places(at[None]))[0].tolist()
        turn = abs((self.angle - other.angle + math.pi) % (2.0 * math.pi) - math.pi)
        return math.hypot(dx, dy), turn

"""What a simulated robot's localiser gets wrong: an error that wanders, and never far."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from vedette.team import PlatformSpec

CORRELATION_TIME = 10.0  # after so long an error has 1/e of itself left [s]


@dataclass(eq=False)
class Localisation:
    """``e(t + dt) = f e(t) + sqrt(1 - f^2) s w``, ``f = exp(-dt / 10 s)``, w standard normal; docs (V80).

    That is a stationary Gaussian process (Ornstein-Uhlenbeck), each coordinate on its own, of which any two
    samples are exact whatever the time between them.
    """

    deviation: NDArray[np.float64]  # (3,) standard deviations of x, y, heading [m, m, rad]
    rng: np.random.Generator
    error: NDArray[np.float64] = field(init=False)  # (3,) told minus true [m, m, rad]

    def __post_init__(self) -> None:
        self.error = self.deviation * self.rng.standard_normal(3)

    @classmethod
    def of(cls, spec: PlatformSpec, stream: np.random.Generator) -> Localisation | None:
        """Return a robot's localiser, with a stream of chance beside its own; None: it knows where it is."""
        if spec.pose_std == 0.0 and spec.pose_std_heading == 0.0:
            return None
        heading = math.radians(spec.pose_std_heading)
        deviation = np.array((spec.pose_std, spec.pose_std, heading))
        return cls(deviation, stream.spawn(1)[0])  # the robot's own stream goes on as without

    def advance(self, dt: float) -> None:
        """Let the error wander for ``dt`` seconds."""
        kept = math.exp(-dt / CORRELATION_TIME)
        fresh = self.deviation * self.rng.standard_normal(3)
        self.error = kept * self.error + math.sqrt(1.0 - kept * kept) * fresh

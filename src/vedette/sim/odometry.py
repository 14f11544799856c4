"""Wheels that miscount: where a robot takes itself to be drifts with the way and the turning done."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def seen_from(frame: Floats, place: Floats) -> Floats:
    """Return a place, x, y [m] and heading [rad] in the last axis, as it lies in a frame; (V86)."""
    gap = place - frame
    c, s = np.cos(frame[..., 2]), np.sin(frame[..., 2])
    x, y = c * gap[..., 0] + s * gap[..., 1], c * gap[..., 1] - s * gap[..., 0]
    turn = np.remainder(gap[..., 2] + math.pi, math.tau) - math.pi
    return np.stack((x, y, turn), axis=-1)


def laid_at(frame: Floats, place: Floats) -> Floats:
    """Return a place of a frame where that frame lies: the inverse of ``seen_from``."""
    c, s = np.cos(frame[..., 2]), np.sin(frame[..., 2])
    x = frame[..., 0] + c * place[..., 0] - s * place[..., 1]
    y = frame[..., 1] + s * place[..., 0] + c * place[..., 1]
    return np.stack((x, y, frame[..., 2] + place[..., 2]), axis=-1)


@dataclass(eq=False)
class Odometry:
    """What the wheels have counted since they were last set to 0, and how uncertain that is; (V87).

    Over a way of d metres and a turn of t radians each coordinate errs by a deviation of ``drift sqrt(d)``
    [m], the heading by ``drift sqrt(d + |t|)`` [rad].
    """

    drift: float  # [m] after a metre, [rad] after a metre and after a radian
    rng: np.random.Generator
    counted: Floats = field(default_factory=lambda: np.zeros(3))  # x, y [m], heading [rad]
    way: float = 0.0  # driven meanwhile [m]
    turned: float = 0.0  # and turned [rad]

    def count(self, before: Floats, after: Floats) -> None:
        """Count a motion between two true places."""
        step = seen_from(before, after)
        way, turn = math.hypot(step[0], step[1]), abs(float(step[2]))
        if way == 0.0 and turn == 0.0:
            return
        self.way, self.turned = self.way + way, self.turned + turn
        deviation = self.drift * np.sqrt((way, way, way + turn))
        self.counted = laid_at(self.counted, step + deviation * self.rng.standard_normal(3))

    def reset(self) -> None:
        """Count from 0 again."""
        self.counted, self.way, self.turned = np.zeros(3), 0.0, 0.0

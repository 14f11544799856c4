"""Where one frame lies in another, as integers: all who hold the same compute the same, to the bit."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

TURN = 1 << 16  # steps of the angle in a full turn
UNIT = 1 << 24  # cosines are whole multiples of 1 / UNIT
MILLIMETRE = 1000  # [um]


class Transform(NamedTuple):
    """``T_a_b``: turns by ``angle``, then moves by ``x, y``; takes places of b to a's."""

    x: int  # [mm]
    y: int  # [mm]
    angle: int  # counter-clockwise [2^-16 of a turn], 0 to TURN - 1

    @classmethod
    def of(cls, x: float, y: float, angle: float) -> Transform:
        """Return the nearest to a motion in metres and radians."""
        return cls(round(1000.0 * x), round(1000.0 * y), round(angle / math.tau * TURN) % TURN)

    @property
    def radians(self) -> float:
        """The angle in (-pi, pi] [rad]."""
        return math.tau * (self.angle if 2 * self.angle <= TURN else self.angle - TURN) / TURN

    @property
    def cosine(self) -> tuple[int, int]:
        """Cosine and sine [1 / UNIT]."""
        return cosine(self.angle)

    def after(self, first: Transform) -> Transform:
        """Return ``T_a_c = T_a_b.after(T_b_c)``, rounded to the millimetre."""
        cos, sin = self.cosine
        x, y = cos * first.x - sin * first.y, sin * first.x + cos * first.y
        return Transform(self.x + _whole(x), self.y + _whole(y), (self.angle + first.angle) % TURN)

    def inverse(self) -> Transform:
        """Return ``T_b_a``, rounded to the millimetre."""
        cos, sin = self.cosine
        x, y = cos * self.x + sin * self.y, cos * self.y - sin * self.x
        return Transform(-_whole(x), -_whole(y), -self.angle % TURN)

    def places(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return where points ``(n, 2)`` of b [m] lie in a's frame."""
        cos, sin = (each / UNIT for each in self.cosine)
        rotation = np.array([[cos, -sin], [sin, cos]])
        return np.asarray(points @ rotation.T + (self.x / 1000.0, self.y / 1000.0), np.float64)

    def place(self, x: float, y: float) -> tuple[float, float]:
        """Return where a point of b [m] lies in a's frame."""
        (u, v) = self.places(np.array([[x, y]]))[0].tolist()
        return u, v

    def apart(self, other: Transform, x: float, y: float) -> tuple[float, float]:
        """Return how far apart two take the place ``x, y`` of b [m], and the angle between them [rad]."""
        turn = (self.angle - other.angle) % TURN
        return math.dist(self.place(x, y), other.place(x, y)), math.tau * min(turn, TURN - turn) / TURN


IDENTITY = Transform(0, 0, 0)


def cosine(angle: int) -> tuple[int, int]:
    """Return cosine and sine of an angle [2^-16 of a turn], rounded to whole multiples of 1 / UNIT."""
    quarter, rest = divmod(angle % TURN, TURN // 4)
    turned = math.tau * rest / TURN
    cos, sin = round(UNIT * math.cos(turned)), round(UNIT * math.sin(turned))
    return ((cos, sin), (-sin, cos), (-cos, -sin), (sin, -cos))[quarter]


def _whole(scaled: int) -> int:
    """Return a multiple of 1 / UNIT rounded to a whole number, halves up."""
    return (2 * scaled + UNIT) // (2 * UNIT)

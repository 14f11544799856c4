"""Steering along a way: toward a point of it that is in plain sight, and nowhere that has too little room."""

from __future__ import annotations

from collections.abc import Callable
from math import atan2, cos, hypot, pi, sin, tau

import numpy as np
from numpy.typing import NDArray

LOOKAHEAD = 0.6  # along the way [m]
SAMPLE = 0.05  # of a line in sight [m]
SOON = 0.3  # what lies so far ahead decides how fast a robot drives [s]
SLOWEST = 0.1  # near the way's end [m/s]
ASKEW = 0.8  # a robot that faces so far beside its way turns on the spot [rad]
SHARES = (1.0, 0.6, 0.3)  # of its speed that a robot tries
CLOSE = 0.02  # a robot comes no nearer to anything of itself [m]

Room = Callable[[NDArray[np.float64]], NDArray[np.float64]]
"""(k, 2) places [m] -> (k,) how far a robot's rim would be from walls and other robots there [m]."""


def steer(
    here: tuple[float, float, float], path: NDArray[np.float64], speed: float, turn_rate: float, room: Room
) -> tuple[float, float]:
    """Return speed [m/s] and turn rate [rad/s] along a way, at most those given."""
    x, y, yaw = here
    aim = _aim(np.array((x, y)), path, room)
    off = within(atan2(aim[1] - y, aim[0] - x) - yaw)
    wanted = min(speed, max(hypot(path[-1, 0] - x, path[-1, 1] - y), SLOWEST)) * max(cos(off), 0.0)
    shares = np.array(SHARES)
    step = wanted * shares * SOON
    soon = np.column_stack((x + step * cos(yaw), y + step * sin(yaw)))
    least = min(CLOSE, float(room(np.array(((x, y),)))[0]))
    fits = shares[room(soon) >= least] if abs(off) < ASKEW else shares[:0]
    return (wanted * float(fits[0]) if len(fits) else 0.0), turn(off, turn_rate)


def _aim(here: NDArray[np.float64], path: NDArray[np.float64], room: Room) -> NDArray[np.float64]:
    """Return the farthest point of the way within the lookahead to which the robot fits straight on."""
    nearest = int(np.hypot(*(path - here).T).argmin())
    ahead = path[nearest:]
    along = np.concatenate(((0.0,), np.cumsum(np.hypot(*np.diff(ahead, axis=0).T))))
    last = int(np.searchsorted(along, LOOKAHEAD))
    for point in ahead[min(last, len(ahead) - 1) : 0 : -1]:
        share = np.linspace(0.0, 1.0, 2 + int(hypot(*(point - here)) / SAMPLE))[1:, None]
        if (room(here + share * (point - here)) >= CLOSE).all():
            return np.asarray(point)
    return np.asarray(ahead[min(1, len(ahead) - 1)])


def turn(off: float, turn_rate: float) -> float:
    """Return the turn rate that takes an angle away [rad/s]."""
    return min(max(3.0 * off, -turn_rate), turn_rate)


def within(angle: float) -> float:
    """Return an angle between -pi and pi."""
    return (angle + pi) % tau - pi

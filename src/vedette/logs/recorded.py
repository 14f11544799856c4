"""Scans that a real lidar has taken, each with the pose that mapping gave it afterwards."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Float = NDArray[np.float64]
PACE, TURN = 0.5, 1.0  # of a robot whose log tells no times [m/s], [rad/s]
SHORTEST_STEP, LONGEST_STEP = 0.1, 60.0  # between two scans [s]


@dataclass(frozen=True, eq=False)
class RecordedScan:
    """One scan, from where the lidar was."""

    time: float  # since the log began [s]
    x: float  # of the lidar [m], frame of the log
    y: float  # [m]
    heading: float  # [rad]
    angles: Float  # (B,) of the beams, in the frame of the log [rad]
    ranges: Float  # (B,) [m]; infinite where nothing came back, NaN where nothing was measured


@dataclass(frozen=True, eq=False)
class RecordedLog:
    """What a robot has seen on its way."""

    name: str
    scans: tuple[RecordedScan, ...]  # in the order of time, at least one
    range: float  # longest that the lidar measured [m]

    @property
    def way(self) -> float:
        """Length of the lidar's way [m]."""
        places = np.array([(scan.x, scan.y) for scan in self.scans])
        return float(np.hypot(*np.diff(places, axis=0).T).sum())


def times(stamps: Sequence[float], poses: Float) -> Float:
    """Return when each scan was taken, from 0 on: by its stamp if stamps rise steadily, else by the way.

    Old logs have stamps of few digits, of two clocks or none. A robot that such a log is of is taken to
    drive at 0.5 m/s and to turn at 1 rad/s.

    Args:
        stamps: of the scans [s].
        poses: (n, 3) x, y, heading [m, m, rad].

    Returns:
        (n,) [s].
    """
    steps = np.diff(np.asarray(stamps, dtype=np.float64))
    if not len(steps) or (((steps >= 0.0) & (steps <= LONGEST_STEP)).all() and steps.any()):
        return np.append(0.0, np.cumsum(steps, dtype=np.float64))
    moved = np.diff(poses, axis=0)
    turned = np.abs(np.angle(np.exp(1j * moved[:, 2])))
    taken = np.maximum(np.hypot(moved[:, 0], moved[:, 1]) / PACE, turned / TURN)
    return np.append(0.0, np.cumsum(np.maximum(taken, SHORTEST_STEP), dtype=np.float64))


def spread(count: int) -> Float:
    """Return the ``(count,)`` angles of a half-round lidar's beams about its heading [rad].

    181 and 361 readings are the ends of 1 and 0.5 degree steps over 180 degrees, 180 and 360 leave the last
    one out.
    """
    step = math.pi / max(count - count % 2, 1)
    return -math.pi / 2.0 + step * np.arange(count, dtype=np.float64)

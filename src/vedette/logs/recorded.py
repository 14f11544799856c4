"""What a real robot has recorded: scans with the poses that mapping gave them, or maps of its own."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

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
class RecordedMap:
    """What a robot's own mapping held at a time; its first cell's corner is where columns and rows begin."""

    time: float  # since the recording began [s]
    classes: NDArray[np.uint8]  # (R, C) UNKNOWN, FREE or OCCUPIED
    resolution: float  # [m]
    corner: tuple[float, float, float]  # x, y [m], heading of its columns' direction [rad], frame of the log
    pose: tuple[float, float, float] | None = None  # of the robot [m, m, rad]; None: nothing told it

    @property
    def middle(self) -> tuple[float, float]:
        """Of what it covers [m]."""
        x, y = self.corners.mean(axis=0).tolist()
        return x, y

    @property
    def corners(self) -> Float:
        """``(4, 2)`` of what it covers [m]."""
        x, y, heading = self.corner
        rows, cols = self.classes.shape
        along = self.resolution * np.array(((0, 0), (cols, 0), (0, rows), (cols, rows)), np.float64)
        c, s = math.cos(heading), math.sin(heading)
        turned: Float = along @ np.array(((c, s), (-s, c))) + (x, y)
        return turned


Sight: TypeAlias = RecordedScan | RecordedMap


def place_of(sight: Sight) -> tuple[float, float, float] | None:
    """Return from where something was seen: x, y [m], heading [rad], frame of the log; None: not told."""
    return (sight.x, sight.y, sight.heading) if isinstance(sight, RecordedScan) else sight.pose


@dataclass(frozen=True, eq=False)
class RecordedLog:
    """What a robot has seen on its way: scans, or maps, at least one."""

    name: str
    scans: tuple[RecordedScan, ...]  # in the order of time
    range: float  # longest that the lidar measured [m]
    maps: tuple[RecordedMap, ...] = ()  # in the order of time; each takes the place of the one before

    @property
    def sights(self) -> tuple[Sight, ...]:
        """Whichever there are."""
        return self.scans or self.maps

    @property
    def way(self) -> float:
        """Length of the way, as far as it is told [m]."""
        steps = np.diff(way_of(self.sights), axis=0)
        return float(np.hypot(*steps.T).sum())


def way_of(sights: Sequence[Sight]) -> Float:
    """Return ``(n, 2)``: the places [m] from which something was seen."""
    places = [place[:2] for sight in sights if (place := place_of(sight)) is not None]
    return np.array(places, np.float64).reshape(-1, 2)


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

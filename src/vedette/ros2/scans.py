"""A scan of a real lidar as evidence: which beams say what, and where they went in the team's frame."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import degrees, inf, isfinite, nan

import numpy as np
from numpy.typing import NDArray

from vedette.errors import InputError
from vedette.ros2.transforms import Matrix, between

MOST_RANGE = 200.0  # no lidar is taken to see farther [m]


@dataclass(frozen=True, eq=False)
class LaserSweep:
    """``sensor_msgs/LaserScan``, in its own frame; the stamp is of the first beam [s]."""

    frame: str
    stamp: float
    angle_min: float  # of the first beam [rad]
    angle_increment: float  # negative: clockwise [rad]
    time_increment: float  # from beam to beam [s]
    range_min: float  # [m]
    range_max: float
    ranges: NDArray[np.float64]  # (B,) [m]

    @property
    def ends(self) -> float:
        """When its last beam was [s]."""
        return self.stamp + max(self.time_increment, 0.0) * max(len(self.ranges) - 1, 0)


@dataclass(frozen=True)
class Lidar:
    """What a lidar's own scans tell of it."""

    range: float  # [m]
    view: float  # [deg]
    beams: int

    @classmethod
    def of(cls, sweep: LaserSweep, topic: str) -> Lidar:
        """Return what a scan tells.

        Raises:
            InputError: it cannot be a lidar's; the line names topic, field and value.
        """
        beams, span = len(sweep.ranges), abs(sweep.angle_increment) * len(sweep.ranges)
        if beams < 2:
            raise InputError(f"{topic}: ranges has {beams} beams; a lidar has at least 2")
        if not isfinite(span) or span <= 0.0 or not isfinite(sweep.angle_min):
            raise InputError(
                f"{topic}: angle_increment is {sweep.angle_increment:g}; it must be a number other than 0"
            )
        if not isfinite(sweep.range_max) or sweep.range_max <= 0.0:
            raise InputError(f"{topic}: range_max is {sweep.range_max:g} m; it must be a number above 0")
        return cls(min(sweep.range_max, MOST_RANGE), min(degrees(span), 360.0), beams)


def measured(sweep: LaserSweep, no_return: str) -> NDArray[np.float64]:
    """Return ``(B,)`` ranges [m]: finite of what is there, inf where nothing is, nan where nothing is said.

    NaN and what is nearer than ``range_min`` is no measurement. From ``range_max`` on nothing came back: with
    ``no_return`` "free" because nothing is there, with "ignore" for whatever reason.
    """
    ranges = np.asarray(sweep.ranges, np.float64).copy()
    low = max(sweep.range_min, 0.0) if isfinite(sweep.range_min) else 0.0
    nothing = ranges >= sweep.range_max
    with np.errstate(invalid="ignore"):
        ranges[(ranges < low) | (ranges <= 0.0)] = nan
    ranges[nothing] = inf if no_return == "free" else nan
    return ranges


@dataclass(frozen=True, eq=False)
class Beams:
    """A scan's beams as if sent from one place at one time."""

    x: float  # from where [m], target frame
    y: float
    angles: NDArray[np.float64]  # (B,) [rad], target frame
    ranges: NDArray[np.float64]  # (B,) [m], as `measured` returns them


def beams(sweep: LaserSweep, knots: Sequence[Matrix], no_return: str) -> Beams:
    """Return a scan's beams in the plane of another frame.

    Each beam goes out from where the lidar was when it was sent. What it met is then told from where the
    lidar was in the middle of the scan.

    Args:
        sweep: the scan.
        knots: ``T_target_lidar`` at its first beam, at its last, and as often as is known in even steps
            between them: a robot that begins to turn does so within a scan.
        no_return: what a beam says that nothing came back from: "ignore" or "free".
    """
    ranges, n = measured(sweep, no_return), len(sweep.ranges)
    at = sweep.angle_min + sweep.angle_increment * np.arange(n)
    along = np.column_stack((np.cos(at), np.sin(at), np.zeros(n)))
    still = all(np.array_equal(T, knots[0]) for T in knots)
    T = np.broadcast_to(knots[0], (n, 4, 4)) if still else _between(knots, np.linspace(0.0, 1.0, n))
    out = np.einsum("bij,bj->bi", T[:, :3, :3], along)[:, :2]
    x, y = _between(knots, np.array((0.5,)))[0, :2, 3].tolist()
    angles = np.arctan2(out[:, 1], out[:, 0])
    finite = np.isfinite(ranges)
    ends = T[:, :2, 3] - (x, y) + np.where(finite, ranges, 0.0)[:, None] * out
    angles = np.where(finite, np.arctan2(ends[:, 1], ends[:, 0]), angles)
    return Beams(x, y, angles, np.where(finite, np.hypot(ends[:, 0], ends[:, 1]), ranges))


def _between(knots: Sequence[Matrix], shares: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return ``(B, 4, 4)``: transforms at shares 0 to 1 of the way along even knots, two at least."""
    legs = len(knots) - 1
    leg_of = np.minimum((shares * legs).astype(int), legs - 1)
    T = np.empty((len(shares), 4, 4))
    for leg in np.unique(leg_of).tolist():
        on_it = leg_of == leg
        T[on_it] = between(knots[leg], knots[leg + 1], shares[on_it] * legs - leg)
    return T

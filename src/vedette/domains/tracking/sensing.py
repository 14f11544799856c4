"""What every sensor of targets has: a view, a position-only measurement, and the information in it."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vedette.domains.tracking.models import STATE
from vedette.errors import Limits, check_limits

_COMMON: dict[str, Limits] = {
    "range": (0.1, 1e6, "m"),
    "view": (1.0, 360.0, "deg"),
    "min_range": (0.1, 1e5, "m"),
    "detection": (0.01, 1.0, ""),
}


@dataclass(frozen=True, kw_only=True)
class Sensor(ABC):
    """``I = a e_r e_r' + b e_t e_t'``: what a look tells along the line of sight and across it.

    docs/tracking.md (V33)

    A target is seen within ``range`` and within half of ``view`` on either side of the heading. Nearer than
    ``min_range`` the information is that at ``min_range``, or the 1 / r^2 of a bearing would draw platforms
    onto the targets. Predicted information is scaled by the probability of detection, an approximation: the
    mean of a log-det is below the log-det of the mean. Which target a measurement belongs to is known.

    Raises:
        InputError: a field is out of its range; the line names field, value and range.
    """

    limits: ClassVar[Mapping[str, Limits]] = {}  # of the fields that a kind of sensor adds

    range: float = 50.0  # [m]
    view: float = 360.0  # centred on the heading [deg]
    min_range: float = 1.0  # [m]
    detection: float = 1.0  # probability of detecting a target in view

    def __post_init__(self) -> None:
        check_limits(self, {**_COMMON, **self.limits})

    @abstractmethod
    def weights(self, r: NDArray[np.float64]) -> tuple[NDArray[np.float64], ...]:
        """Return a, b and their derivatives at ranges r not below ``min_range`` [1/m^2, 1/m^3]."""

    @abstractmethod
    def predicted(self, pose: NDArray[np.float64], point: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return ``h(x)``, (m,): the measurement of a target at a point (2,) without noise."""

    @abstractmethod
    def jacobian(self, pose: NDArray[np.float64], point: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the position's part of ``H``, (m, 2)."""

    @abstractmethod
    def curvature(
        self, pose: NDArray[np.float64], point: NDArray[np.float64], covariance: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return ``1/2 tr(h'' P)`` and ``1/2 tr((h'' P)^2)``, (m,) each: what H leaves out of z."""

    @property
    @abstractmethod
    def deviations(self) -> NDArray[np.float64]:
        """Standard deviations of a measurement, (m,)."""

    def innovation(self, measured: NDArray[np.float64], expected: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return ``z - h(x)``, angles wrapped."""
        return measured - expected

    def information(self, poses: ArrayLike, points: ArrayLike) -> NDArray[np.float64]:
        """Expected ``H' R^-1 H`` of looks, as xx, xy, yy [1/m^2]; zero where out of view (paper, eq. (25)).

        Args:
            poses: (..., 3) x, y, heading [m, m, rad]; broadcasts with
            points: (..., 2) where the targets are expected [m].

        Returns:
            (..., 3)
        """
        r, radial, across = geometry(poses, points)
        a, b, _, _ = self.weights(np.maximum(r, self.min_range))
        packed = a[..., None] * _outer(radial, radial) + b[..., None] * _outer(across, across)
        weight = np.where(self.sees(poses, points), self.detection, 0.0)
        return np.asarray(packed * weight[..., None])

    def slope(self, poses: ArrayLike, points: ArrayLike, by: NDArray[np.float64]) -> NDArray[np.float64]:
        """Chain a derivative by ``information`` (..., 3) to one by the sensor's x and y, (..., 2).

        Exact where the information is smooth: not on the edge of the view, nor at ``min_range``.
        """
        r, radial, across = geometry(poses, points)
        clamped = np.maximum(r, self.min_range)
        a, b, a_slope, b_slope = self.weights(clamped)
        farther = a_slope[..., None] * _outer(radial, radial) + b_slope[..., None] * _outer(across, across)
        by_range = (by * farther).sum(-1) * (r > self.min_range)
        by_angle = (by * 2.0 * _outer(radial, across)).sum(-1) * (a - b)
        towards = by_range[..., None] * radial + (by_angle / np.maximum(r, 1e-9))[..., None] * across
        weight = np.where(self.sees(poses, points), self.detection, 0.0)
        return np.asarray(-weight[..., None] * towards)  # the sensor moves, the target does not

    def most_evidence(self, extent: float) -> tuple[float, float]:
        """Return bounds on any number in ``I`` [1/m^2] and in ``i`` of a likelihood, for fixed-point sums.

        ``extent``: no pose or estimate is farther than this from the origin in x or y [m].
        """
        a, b, _, _ = self.weights(np.array(self.min_range))
        most = float(max(a, b))
        return most, 8.0 * most * (extent + self.range)  # |H' R^-1| (|innovation| + |H x|), both generous

    def sees(self, poses: ArrayLike, points: ArrayLike) -> NDArray[np.bool_]:
        """Tell which points (..., 2) [m] are in range and view from the poses (..., 3)."""
        pose, offset = np.asarray(poses, np.float64), _offset(poses, points)
        near = np.hypot(offset[..., 0], offset[..., 1]) <= self.range
        if self.view >= 360.0:
            return np.asarray(near)
        aside = wrapped(np.arctan2(offset[..., 1], offset[..., 0]) - pose[..., 2])
        return np.asarray(near & (np.abs(aside) <= math.radians(self.view) / 2.0))

    def measure(
        self, rng: np.random.Generator, pose: ArrayLike, state: ArrayLike
    ) -> NDArray[np.float64] | None:
        """Draw a measurement (m,) of a target in a true state (4,) or (2,); None if it is not detected."""
        at, point = np.asarray(pose, np.float64), np.asarray(state, np.float64)[:2]
        noise, luck = (
            rng.normal(size=len(self.deviations)),
            rng.random(),
        )  # drawn always: runs stay comparable
        if luck >= self.detection or not self.sees(at, point):
            return None
        expected = self.predicted(at, point)
        return self.innovation(expected + self.deviations * noise, np.zeros_like(expected))  # angles wrapped

    def likelihood(
        self,
        measured: NDArray[np.float64],
        pose: ArrayLike,
        mean: ArrayLike,
        covariance: NDArray[np.float64] | None = None,
        origin: ArrayLike = (0.0, 0.0),
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """``I = H' R^-1 H`` (4, 4) and ``i = H' R^-1 (z - a)`` (4,), with ``a = h(x) - H (x - o)``.

        Source: paper, eqs. (20) and (21). As printed, (21) has z for ``z - a``, which is right only where h
        is linear without an offset. With the estimate's covariance, mean and variance of what the line leaves
        out go into a and R: otherwise a bearing from close by makes the estimate surer than it is.
        docs/tracking.md (V32), (V34)

        Args:
            measured: (m,) from ``measure``.
            pose: (3,) at the time [m, m, rad].
            mean: (4,) estimate to linearise about.
            covariance: (4, 4) of that estimate.
            origin: o (2,), to which ``i`` is relative [m].
        """
        at, x = np.asarray(pose, np.float64), np.asarray(mean, np.float64)
        expected, variances = self.predicted(at, x[:2]), self.deviations**2
        if covariance is not None:
            bias, spread = self.curvature(at, x[:2], covariance[:2, :2])
            expected, variances = expected + bias, variances + spread
        H = np.zeros((len(variances), STATE))
        H[:, :2] = self.jacobian(at, x[:2])
        weighted = H / variances[:, None]  # R^-1 H
        information = H.T @ weighted
        z_less_a = self.innovation(measured, expected) + H[:, :2] @ (x[:2] - np.asarray(origin))
        return (information + information.T) / 2.0, weighted.T @ z_less_a


def geometry(
    poses: ArrayLike, points: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return range (...) [m] and unit vectors (..., 2) along the line of sight and across it, to its left."""
    offset = _offset(poses, points)
    r = np.hypot(offset[..., 0], offset[..., 1])
    radial = np.where(r[..., None] > 0.0, offset / np.maximum(r, 1e-300)[..., None], np.array([1.0, 0.0]))
    return r, radial, np.stack([-radial[..., 1], radial[..., 0]], -1)


def wrapped(angle: ArrayLike) -> NDArray[np.float64]:
    """Return angles [rad] as the same directions in (-pi, pi]."""
    return np.asarray(math.pi - np.mod(math.pi - np.asarray(angle, np.float64), 2.0 * math.pi))


def _offset(poses: ArrayLike, points: ArrayLike) -> NDArray[np.float64]:
    return np.asarray(points, np.float64) - np.asarray(poses, np.float64)[..., :2]


def _outer(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    """``(a b' + b a') / 2`` as xx, xy, yy."""
    ax, ay, bx, by = a[..., 0], a[..., 1], b[..., 0], b[..., 1]
    return np.stack([ax * bx, (ax * by + ay * bx) / 2.0, ay * by], -1)


def evidence(
    sensor: Sensor,
    pose: ArrayLike,
    measured: Mapping[int, NDArray[np.float64]],
    means: NDArray[np.float64],
    covariances: NDArray[np.float64] | None = None,
    origin: ArrayLike = (0.0, 0.0),
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """What one platform's measurements of a step say about all targets: ``I`` (T, 4, 4) and ``i`` (T, 4).

    Args:
        sensor: the platform's.
        pose: (3,) at the step [m, m, rad].
        measured: by target; the others were not detected, and that says nothing.
        means, covariances: (T, 4) and (T, 4, 4) estimates at the step to linearise about.
        origin: (2,) to which the vectors are relative [m].
    """
    information, vector = np.zeros((len(means), STATE, STATE)), np.zeros((len(means), STATE))
    for target, z in measured.items():
        covariance = None if covariances is None else covariances[target]
        information[target], vector[target] = sensor.likelihood(z, pose, means[target], covariance, origin)
    return information, vector

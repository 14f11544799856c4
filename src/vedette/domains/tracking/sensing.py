"""What every sensor of targets has: a view, a position-only measurement, and the information in it."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vedette.domains.tracking.geometry import geometry, offset_of, outer, packed, wrapped
from vedette.domains.tracking.models import STATE
from vedette.errors import Limits, check_limits
from vedette.kernels import looks
from vedette.kernels.looks import Sight

_DIFFERENCE = 1e-5  # of the farthest offset: step of numerical slopes

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
    ``min_range`` a bearing counts as from ``min_range``. Predicted information is scaled by the probability
    of detection, an approximation: the mean of a log-det is below the log-det of the mean. Which target a
    measurement belongs to is known.

    So much a look tells of a place that is known; of one that is not, what `foresee` and `likelihood` say,
    both by the line that fits the measurement best over all that the place may be. docs/tracking.md (V34)

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
    def weights(self, r: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return a and b at ranges r not below ``min_range`` [1/m^2]."""

    @abstractmethod
    def predicted(self, pose: NDArray[np.float64], point: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return ``h(x)``, (m,): the measurement of a target at a point (2,) without noise."""

    @abstractmethod
    def jacobian(self, pose: NDArray[np.float64], point: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the position's part of ``H``, (m, 2)."""

    @property
    @abstractmethod
    def noises(self) -> tuple[float, float, float]:
        """Standard deviations of range [m], bearing [rad] and place [m]; 0 for what it does not measure."""

    @abstractmethod
    def statistics(
        self, measured: NDArray[np.float64], pose: NDArray[np.float64], along: float
    ) -> NDArray[np.float64]:
        """Return what is linear in the position, at best: the statistics of `vedette.kernels.looks.Lines`.

        Args:
            measured: (m,).
            pose: (3,) at the time [m, m, rad].
            along: direction of the line of sight to the mean, team frame [rad].
        """

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
        a, b = self.weights(np.maximum(r, self.min_range))
        packed = a[..., None] * outer(radial, radial) + b[..., None] * outer(across, across)
        weight = np.where(self.sees(poses, points), self.detection, 0.0)
        return np.asarray(packed * weight[..., None])

    def sight(self, stride: float) -> Sight:
        """Return what the kernels need to know; ``stride``: how far it moves between looks [m]."""
        return Sight(*self.noises, self.min_range, stride)

    def foresee(
        self,
        poses: NDArray[np.float64],
        points: NDArray[np.float64],
        covariances: NDArray[np.float64],
        stride: float = 0.0,
    ) -> NDArray[np.float64]:
        """Expected information of looks at targets that are known so well, (C, M, K, 3) as `information`.

        It is that of `likelihood`, times the probability that the target is detected and in view.

        Args:
            poses: (C, K, 3) along C courses [m, m, rad].
            points: (M, K, 2) where M targets are expected [m].
            covariances: (M, K, 2, 2) of their positions [m^2].
            stride: how far the sensor moves between looks [m].
        """
        view = self.range, math.radians(self.view) / 2.0
        seen = looks.foreseen(self.sight(stride), view, poses, points, packed(covariances))
        return self.detection * seen

    def foreseen_slope(
        self,
        poses: NDArray[np.float64],
        points: NDArray[np.float64],
        covariances: NDArray[np.float64],
        by: NDArray[np.float64],
        stride: float = 0.0,
    ) -> NDArray[np.float64]:
        """Chain a derivative (M, K, 3) by `foresee` of one course to one by the sensor's x and y, (M, K, 2).

        By central differences, the share in view held: not on the edge of the view, nor at ``min_range``.
        """
        sight, spread = self.sight(stride), packed(covariances)
        offsets = points - poses[..., :2]

        def of(moved: NDArray[np.float64]) -> NDArray[np.float64]:
            found = looks.lines(sight, moved.reshape(-1, 2), spread.reshape(-1, 3)).information
            return found.reshape(by.shape)

        here, foreseen = of(offsets), self.foresee(poses[None], points, covariances, stride)[0]
        share = foreseen[..., ::2].sum(-1) / np.maximum(here[..., ::2].sum(-1), 1e-300)
        step = _DIFFERENCE * max(self.min_range, float(np.abs(offsets).max(initial=0.0)))
        moves = step * np.eye(2)
        slopes = [(by * (of(offsets - move) - of(offsets + move))).sum(-1) / (2.0 * step) for move in moves]
        return np.asarray(share[..., None] * np.stack(slopes, -1))

    @property
    def most(self) -> float:
        """Most that a look tells in any direction [1/m^2]."""
        a, b = self.weights(np.array(self.min_range))
        return float(max(a, b))

    def most_evidence(self, extent: float) -> tuple[float, float]:
        """Return bounds on any number in ``I`` [1/m^2] and in ``i`` of a likelihood, for fixed-point sums.

        ``extent``: no pose or estimate is farther than this from the origin in x or y [m].
        """
        most = self.most
        vector = 8.0 * most * (extent + self.range)  # |H' R^-1| (|innovation| + |H x|), both generous
        return most * (1.0 + 1e-9), vector

    def sees(self, poses: ArrayLike, points: ArrayLike) -> NDArray[np.bool_]:
        """Tell which points (..., 2) [m] are in range and view from the poses (..., 3)."""
        pose, offset = np.asarray(poses, np.float64), offset_of(poses, points)
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
        stride: float = 0.0,
        origin: ArrayLike = (0.0, 0.0),
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """``I = H' R^-1 H`` (4, 4) and ``i = H' R^-1 (z - a)`` (4,), with ``a = h(x) - H (x - o)``.

        Source: paper, eqs. (20) and (21). As printed, (21) has z for ``z - a``, which is right only where h
        is linear without an offset. Without a covariance the line is the tangent at the mean; with it, the
        one that fits best over the Gaussian, and what it leaves counts as noise: so a look from close by, or
        from overhead, tells what it can and no more. docs/tracking.md (V32), (V34)

        Args:
            measured: (m,) from ``measure``.
            pose: (3,) at the time [m, m, rad].
            mean: (4,) estimate to linearise about.
            covariance: (4, 4) of that estimate.
            stride: how far the sensor moves between looks [m].
            origin: o (2,), to which ``i`` is relative [m].
        """
        at, x, o = np.asarray(pose, np.float64), np.asarray(mean, np.float64)[:2], np.asarray(origin)
        if covariance is None:
            H, expected = self.jacobian(at, x), self.predicted(at, x)
            gain, left = H.T / self.deviations**2, self.innovation(measured, expected)
            information = gain @ H
        else:
            offset = x - at[:2]
            spread = packed(np.asarray(covariance, np.float64)[:2, :2])
            (xx, xy, yy), wide, known = (
                each[0] for each in looks.lines(self.sight(stride), offset[None], spread[None])
            )
            found = self.statistics(measured, at, math.atan2(offset[1], offset[0]))
            gain, left = wide[:, : len(found)], found - known[: len(found)]
            information = np.array([[xx, xy], [xy, yy]])
        matrix, vector = np.zeros((STATE, STATE)), np.zeros(STATE)
        matrix[:2, :2] = (information + information.T) / 2.0
        vector[:2] = gain @ left + information @ (x - o)
        return matrix, vector


def evidence(
    sensor: Sensor,
    pose: ArrayLike,
    measured: Mapping[int, NDArray[np.float64]],
    means: NDArray[np.float64],
    covariances: NDArray[np.float64] | None = None,
    stride: float = 0.0,
    origin: ArrayLike = (0.0, 0.0),
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """What one platform's measurements of a step say about all targets: ``I`` (T, 4, 4) and ``i`` (T, 4).

    Args:
        sensor: the platform's.
        pose: (3,) at the step [m, m, rad].
        measured: by target; the others were not detected, and that says nothing.
        means, covariances: (T, 4) and (T, 4, 4) estimates at the step to linearise about.
        stride: how far the sensor moves between looks [m].
        origin: (2,) to which the vectors are relative [m].
    """
    information, vector = np.zeros((len(means), STATE, STATE)), np.zeros((len(means), STATE))
    for target, z in measured.items():
        covariance = None if covariances is None else covariances[target]
        information[target], vector[target] = sensor.likelihood(
            z, pose, means[target], covariance, stride, origin
        )
    return information, vector

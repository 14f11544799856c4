"""Sensors that may detect a target in range: what they report, and how likely a report is."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vedette.errors import Limits, check_limits
from vedette.kernels.search import look_footprints
from vedette.maps import GridFrame
from vedette.scenario import as_one_of

Report: TypeAlias = tuple[float, float] | None  # where a target was reported [m], team frame; None: nowhere
Pose: TypeAlias = ArrayLike  # (3,) x, y, heading [m, m, rad], team frame

LEAST_SAMPLES, MOST_SAMPLES = 2, 256  # points along each side of a cell over which a look is averaged
POINTS = 4.0  # along a sensor's half width, at least
COARSEST = 2.0  # cells along a sensor's half width, at least, for a grid to tell apart what it sees
LEAST_FALSE_ALARM = 1e-9  # assumed at least, so that no report is taken for proof
LEAST_MISS = 1e-9  # likewise for looks that cannot miss
_TABLE = 4096  # entries in the squared distance


@dataclass(frozen=True)
class Detector(ABC):
    """``P(r)`` up to a range, in a field of view; at most one report a look, of the target or a false alarm.

    A look at a target at distance r reports it with probability P(r), at its place plus noise; otherwise,
    with probability ``false_alarm``, it reports a place anywhere in the field of view.

    Raises:
        InputError: a field is not a number in its range; the line names it.
    """

    detection: float = 0.9  # probability of detection at best, per look
    range: float = 100.0  # beyond it nothing is detected [m]
    view: float = 360.0  # field of view, centred on the heading [deg]
    noise: float = 10.0  # standard deviation of a reported place along each axis [m]
    false_alarm: float = 0.0  # probability of a false alarm, per look without a detection

    def __post_init__(self) -> None:
        check_limits(self, {field.name: _LIMITS[field.name] for field in fields(self)})

    @abstractmethod
    def probability(self, distance: ArrayLike) -> NDArray[np.float64]:
        """Probability that one look detects a target at this distance [m] in the field of view."""

    @property
    @abstractmethod
    def breadth(self) -> float:
        """Distance at which P has fallen to e^-2 of its best, at most the range [m]."""

    @property
    def half_width(self) -> float:
        """Half of what it sweeps when it flies ahead [m]; docs/search.md (V53)."""
        return self.breadth * math.sin(math.radians(min(self.view, 180.0)) / 2.0)

    def parts(self, resolution: float, each: float) -> int:
        """In how many parts to cut a side of ``resolution`` [m] for ``each`` of them in a half width."""
        return max(1, math.ceil(each * resolution / self.half_width - 1e-9))

    def table(self) -> NDArray[np.float64]:
        """Return the probability in equal steps of the squared distance, as the kernel takes it."""
        return self.probability(self.range * np.sqrt((np.arange(_TABLE) + 0.5) / _TABLE))

    def footprints(
        self, frame: GridFrame, poses: NDArray[np.float64], least: int = LEAST_SAMPLES
    ) -> tuple[NDArray[np.int64], NDArray[np.uint32], NDArray[np.float64]]:
        """Probability that at least one of L looks detects a target that is anywhere in a cell.

        The mean over a cell is taken over points so close that even a cell far larger than the range has
        many in range.

        Args:
            frame: the grid.
            poses: ``(N, L, 3)`` x, y, heading [m, m, rad], team frame.
            least: number of points along a cell's side.

        Returns:
            starts ``(N + 1,)``, cells ``(M,)`` and probabilities ``(M,)``, the rows of a sparse matrix.
        """
        local = np.asarray(poses, np.float64) - (frame.origin_x, frame.origin_y, 0.0)
        view = math.radians(self.view) if self.view < 360.0 else 2.0 * math.pi
        samples = min(max(least, self.parts(frame.resolution, POINTS)), MOST_SAMPLES)
        return look_footprints(frame.shape, frame.resolution, local, self.table(), self.range, view, samples)

    def chance(self, pose: Pose, targets: ArrayLike) -> NDArray[np.float64]:
        """Probability that one look detects each of the targets at ``targets`` (n, 2) [m], ``(n,)``."""
        x, y, heading = np.asarray(pose, np.float64)
        away = np.asarray(targets, np.float64) - (x, y)
        off = (np.arctan2(away[:, 1], away[:, 0]) - heading + math.pi) % (2.0 * math.pi) - math.pi
        seen = np.degrees(np.abs(off)) <= self.view / 2.0
        return np.where(seen, self.probability(np.hypot(away[:, 0], away[:, 1])), 0.0)

    def glimpse(self, rng: np.random.Generator, pose: Pose, target: ArrayLike) -> Report:
        """Return what one look reports with the target at ``target`` (2,) [m], team frame."""
        place = np.asarray(target, np.float64)
        detects, alarms = rng.random(2)
        if detects < self.chance(pose, place[None])[0]:
            x, y = (place + self.noise * rng.standard_normal(2)).tolist()
            return x, y
        if alarms < self.false_alarm:
            x, y, heading = np.asarray(pose, np.float64)
            away = self.range * math.sqrt(rng.random())
            bearing = heading + math.radians(self.view) * (rng.random() - 0.5)
            return float(x + away * math.cos(bearing)), float(y + away * math.sin(bearing))
        return None

    def log_likelihood(
        self, frame: GridFrame, pose: Pose, report: Report
    ) -> tuple[NDArray[np.uint32], NDArray[np.float64]]:
        """``ln p(report | target in cell) / p(report | target elsewhere)`` of one look, where it is not 0.

        None: ``ln (1 - P)``. A place z: ``ln (1 - P + P N(z; x, noise) A / P_FA)``, A the area of the field
        of view, the mean over the parts of a cell that is large for the sensor. The noise is widened by that
        of a target anywhere in its part. ``P_FA`` counts as 1e-9 at least, and a miss likewise.
        docs/search.md (V42)

        Returns:
            cells ``(M,)`` and log-likelihood ratios ``(M,)`` [nat].
        """
        look = np.asarray(pose, np.float64)[None, None]
        if report is None:
            _, cells, detection = self.footprints(frame, look)
            return cells, np.log(np.maximum(1.0 - detection, LEAST_MISS))
        parts = self.parts(frame.resolution, COARSEST)
        fine = frame.finer(parts)
        _, inside, detection = self.footprints(fine, look)
        variance = self.noise**2 + fine.resolution**2 / 12.0
        square = ((fine.centres(inside) - report) ** 2).sum(axis=1)
        density = np.exp(-square / (2.0 * variance)) / (2.0 * math.pi * variance)
        area = math.radians(self.view) / 2.0 * self.range**2
        alarms = max(self.false_alarm, LEAST_FALSE_ALARM) / area
        ratio = np.maximum(1.0 - detection, LEAST_MISS) + detection * density / alarms
        row, col = np.divmod(inside, np.uint32(fine.cols))
        cells, part = np.unique(row // parts * np.uint32(frame.cols) + col // parts, return_inverse=True)
        mean = 1.0 + np.bincount(part, ratio - 1.0) / parts**2  # 1 in the parts that are not in view
        return cells.astype(np.uint32), np.log(np.maximum(mean, LEAST_MISS))


@dataclass(frozen=True)
class DefiniteRange(Detector):
    """``P(r) = P_D`` up to the range."""

    @property
    def breadth(self) -> float:
        """The range."""
        return self.range

    def probability(self, distance: ArrayLike) -> NDArray[np.float64]:
        """``P_D [r <= R]``."""
        return np.where(np.asarray(distance) <= self.range, self.detection, 0.0)


@dataclass(frozen=True)
class ExponentialRange(Detector):
    """``P(r) = P_D exp(-(r / sigma)^k)``, cut at the range."""

    sigma: float = 50.0  # distance at which P is P_D / e [m]
    power: float = 2.0  # k

    @property
    def breadth(self) -> float:
        """``2^(1/k) sigma``, at most the range."""
        return min(self.range, self.sigma * math.pow(2.0, 1.0 / self.power))

    def probability(self, distance: ArrayLike) -> NDArray[np.float64]:
        """``P_D exp(-(r / sigma)^k) [r <= R]``."""
        distance = np.asarray(distance, np.float64)
        falling = self.detection * np.exp(-((distance / self.sigma) ** self.power))
        return np.where(distance <= self.range, falling, 0.0)


DETECTORS: dict[str, type[Detector]] = {"definite": DefiniteRange, "exponential": ExponentialRange}

_LIMITS: dict[str, Limits] = {
    "detection": (0.0, 1.0, ""),
    "range": (1e-3, 1e6, "m"),
    "view": (1.0, 360.0, "deg"),
    "noise": (0.0, 1e6, "m"),
    "false_alarm": (0.0, 1.0, ""),
    "sigma": (1e-3, 1e6, "m"),
    "power": (0.1, 20.0, ""),
}


def detector_from(settings: Mapping[str, Any]) -> Detector:
    """Make a detector from ``{type: NAME, field: value, ...}``, as a scenario file says it.

    Raises:
        InputError: no or an unknown type, an unknown field (with the nearest known), a value out of range.
    """
    return as_one_of(DETECTORS, settings, "detector")

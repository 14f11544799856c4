"""The kinds of sensors, and how a scenario names them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar, TypeAlias

import numpy as np
from numpy.typing import NDArray

from vedette.domains.tracking.geometry import debiased, geometry, wrapped
from vedette.domains.tracking.sensing import Sensor
from vedette.scenario import as_one_of

Floats: TypeAlias = NDArray[np.float64]

_RANGE_NOISE = {"range_noise": (1e-3, 1e5, "m")}
_BEARING_NOISE = {"bearing_noise": (0.01, 90.0, "deg")}
_POSITION_NOISE = {"noise": (1e-3, 1e5, "m")}


@dataclass(frozen=True, kw_only=True)
class RangeBearing(Sensor):
    """Distance [m], and direction from the heading [rad] in (-pi, pi]."""

    limits: ClassVar = {**_RANGE_NOISE, **_BEARING_NOISE}

    range_noise: float = 0.5  # standard deviation [m]
    bearing_noise: float = 2.0  # standard deviation [deg]

    def weights(self, r: Floats) -> tuple[Floats, Floats]:
        """``1 / sigma_r^2`` along the line of sight, ``1 / (r sigma_b)^2`` across it."""
        along = np.full_like(r, self.range_noise**-2)
        across = (r * math.radians(self.bearing_noise)) ** -2
        return along, across

    def predicted(self, pose: Floats, point: Floats) -> Floats:
        """Range and bearing of the point."""
        return np.array([math.dist(point, pose[:2]), _bearing(pose, point)])

    def jacobian(self, pose: Floats, point: Floats) -> Floats:
        """``e_r'`` and ``e_t' / r``."""
        r, radial, across = geometry(pose, point)
        return np.stack([radial, across / max(float(r), self.min_range)])

    @property
    def noises(self) -> tuple[float, float, float]:
        """Range and bearing."""
        return self.range_noise, math.radians(self.bearing_noise), 0.0

    def statistics(self, measured: Floats, pose: Floats, along: float) -> Floats:
        """The debiased place that both say, and the range."""
        r, bearing = measured.tolist()
        place = r * debiased(bearing + float(pose[2]) - along, math.radians(self.bearing_noise))
        return np.append(place, r)

    @property
    def deviations(self) -> Floats:
        """Of the range [m] and the bearing [rad]."""
        return np.array([self.range_noise, math.radians(self.bearing_noise)])

    def innovation(self, measured: Floats, expected: Floats) -> Floats:
        """Differences, that of the bearings in (-pi, pi]."""
        difference = measured - expected
        difference[1] = wrapped(difference[1])
        return difference


@dataclass(frozen=True, kw_only=True)
class BearingOnly(Sensor):
    """Direction from the heading [rad] in (-pi, pi]."""

    limits: ClassVar = _BEARING_NOISE

    bearing_noise: float = 2.0  # standard deviation [deg]

    def weights(self, r: Floats) -> tuple[Floats, Floats]:
        """Nothing along the line of sight, ``1 / (r sigma_b)^2`` across it."""
        across = (r * math.radians(self.bearing_noise)) ** -2
        return np.zeros_like(r), across

    def predicted(self, pose: Floats, point: Floats) -> Floats:
        """Bearing of the point."""
        return np.array([_bearing(pose, point)])

    def jacobian(self, pose: Floats, point: Floats) -> Floats:
        """``e_t' / r``."""
        r, _, across = geometry(pose, point)
        return across[None] / max(float(r), self.min_range)

    @property
    def noises(self) -> tuple[float, float, float]:
        """Bearing."""
        return 0.0, math.radians(self.bearing_noise), 0.0

    def statistics(self, measured: Floats, pose: Floats, along: float) -> Floats:
        """Debiased cosine and sine."""
        return debiased(float(measured[0] + pose[2]) - along, math.radians(self.bearing_noise))

    @property
    def deviations(self) -> Floats:
        """Of the bearing [rad]."""
        return np.array([math.radians(self.bearing_noise)])

    def innovation(self, measured: Floats, expected: Floats) -> Floats:
        """Difference in (-pi, pi]."""
        return wrapped(measured - expected)


@dataclass(frozen=True, kw_only=True)
class RangeOnly(Sensor):
    """Distance [m]."""

    limits: ClassVar = _RANGE_NOISE

    range_noise: float = 0.5  # standard deviation [m]

    def weights(self, r: Floats) -> tuple[Floats, Floats]:
        """``1 / sigma_r^2`` along the line of sight, nothing across it."""
        return np.full_like(r, self.range_noise**-2), np.zeros_like(r)

    def predicted(self, pose: Floats, point: Floats) -> Floats:
        """Range of the point."""
        return np.array([math.dist(point, pose[:2])])

    def jacobian(self, pose: Floats, point: Floats) -> Floats:
        """``e_r'``."""
        return geometry(pose, point)[1][None]

    @property
    def noises(self) -> tuple[float, float, float]:
        """Range."""
        return self.range_noise, 0.0, 0.0

    def statistics(self, measured: Floats, pose: Floats, along: float) -> Floats:
        """The range."""
        return measured

    @property
    def deviations(self) -> Floats:
        """Of the range [m]."""
        return np.array([self.range_noise])


@dataclass(frozen=True, kw_only=True)
class Position(Sensor):
    """Position x, y in the team frame [m], equally good in all directions."""

    limits: ClassVar = _POSITION_NOISE

    noise: float = 1.0  # standard deviation of each coordinate [m]

    def weights(self, r: Floats) -> tuple[Floats, Floats]:
        """``1 / sigma^2`` both ways."""
        both = np.full_like(r, self.noise**-2)
        return both, both

    def predicted(self, pose: Floats, point: Floats) -> Floats:
        """The point."""
        return point

    def jacobian(self, pose: Floats, point: Floats) -> Floats:
        """The identity."""
        return np.eye(2)

    @property
    def noises(self) -> tuple[float, float, float]:
        """Place."""
        return 0.0, 0.0, self.noise

    def statistics(self, measured: Floats, pose: Floats, along: float) -> Floats:
        """The place from the sensor, along the line of sight and across it."""
        c, s = math.cos(along), math.sin(along)
        return np.array([[c, s], [-s, c]]) @ (measured - pose[:2])

    @property
    def deviations(self) -> Floats:
        """Of x and y [m]."""
        return np.array([self.noise, self.noise])


SENSORS: dict[str, type[Sensor]] = {
    "range-bearing": RangeBearing,
    "bearing": BearingOnly,
    "range": RangeOnly,
    "position": Position,
}


def sensor_of(entry: object, where: str) -> Sensor:
    """Return the sensor that a scenario describes: ``{type: bearing, range: 60, bearing_noise: 2}``.

    Every field but ``type`` has a default; lengths are in metres, angles in degrees.

    Raises:
        InputError: not such a mapping, an unknown type or field (with the nearest valid name), a value of the
            wrong type or out of range; the line starts with ``where``.
    """
    return as_one_of(SENSORS, entry, where)


def _bearing(pose: Floats, point: Floats) -> float:
    """Direction of a point from the heading [rad] in (-pi, pi]."""
    return float(wrapped(math.atan2(point[1] - pose[1], point[0] - pose[0]) - pose[2]))

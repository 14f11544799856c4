"""A sensor of somebody's own on a mapping robot: what it tells of the world, and what a look promises."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import Any, Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

from vedette.parts import PartKind, telling

Floats: TypeAlias = NDArray[np.float64]
# From directions (B,) off the robot's heading [rad] to how far the first thing is [m], inf beyond range.
Cast: TypeAlias = Callable[[Floats], Floats]


class OwnSensor(Protocol):
    """Made by a call with the robot's ``PlatformSpec``; its ``range``, ``view`` and ``rate`` hold."""

    def scan(self, cast: Cast, rng: np.random.Generator) -> tuple[Floats, Floats]:
        """Return directions [rad] off the heading and ranges [m], (B,) each.

        Up to its range a beam says that all is free, and that something is there, if it is less than the
        robot's ``range``. NaN: the beam says nothing.
        """

    def sees(self, distance: Floats, bearing: Floats) -> Floats:
        """Return how likely a look shows places that nothing hides, (K,) 0 to 1.

        ``distance`` [m]; ``bearing`` [rad] off the direction that the robot faces then, -pi to pi.
        """


def _wrong(part: Any) -> str | None:
    return None if callable(part) else f"is {type(part).__name__}, not a class of sensors"


SENSOR: PartKind[Callable[[Any], OwnSensor]] = PartKind(
    "sensors", "sensor", {}, _wrong, "docs/how-to/own-sensor.md"
)


@dataclass(frozen=True)
class CheckedSensor:
    """`OwnSensor`; raises InputError where its class raises, or says what cannot be."""

    name: str
    own: OwnSensor

    @classmethod
    def of(cls, spec: Any) -> CheckedSensor | None:
        """Return the sensor that a ``PlatformSpec`` names; None: it has a lidar.

        Raises:
            InputError: there is none of this name, or it cannot be made.
        """
        if spec.sensor is None:
            return None
        make = SENSOR.find(spec.sensor)
        with telling(f"sensor {spec.sensor}"):
            own = make(spec)
            lacking = [part for part in ("scan", "sees") if not hasattr(own, part)]
            if lacking:
                raise TypeError(f"it lacks {', '.join(lacking)}; see {SENSOR.page}")
        return cls(spec.sensor, own)

    def scan(self, cast: Cast, rng: np.random.Generator) -> tuple[Floats, Floats]:
        """Return what it tells now."""
        with self._telling("scan"):
            angles, ranges = (np.asarray(each, np.float64) for each in self.own.scan(cast, rng))
            if angles.ndim != 1 or angles.shape != ranges.shape:
                raise ValueError(f"gives angles {angles.shape} and ranges {ranges.shape}; give (B,) of both")
            if not np.isfinite(angles).all() or (ranges < 0.0).any():
                raise ValueError("gives an angle that is not finite, or a range below 0")
        return angles, ranges

    def sees(self, distance: Floats, bearing: Floats) -> Floats:
        """Return how likely a look shows places."""
        with self._telling("sees"):
            share = np.asarray(self.own.sees(distance, bearing), np.float64)
            if share.shape != distance.shape:
                raise ValueError(f"gives {share.shape} for places {distance.shape}")
            if not ((share >= 0.0) & (share <= 1.0)).all():
                raise ValueError("gives a probability that is not 0 to 1")
        return share

    def _telling(self, what: str) -> AbstractContextManager[None]:
        return telling(f"sensor {self.name}: {what}")

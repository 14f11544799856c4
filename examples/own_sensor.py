"""Sensors of one's own for mapping: a camera that sees a cone, and feelers that must touch.

A team file names them, `sensor: own_sensor:Camera`; docs/how-to/own-sensor.md explains.
"""

import numpy as np

from vedette.team import PlatformSpec


class Camera:
    """Sees within its view what has texture enough: ever less with the distance, and ever less precisely."""

    BLIND = 0.3  # nearer than that it tells nothing [m]

    def __init__(self, spec: PlatformSpec) -> None:
        self.half, self.range, self.pixels = np.radians(spec.view) / 2, spec.range, spec.beams

    def scan(self, cast, rng):  # cast: directions off the heading -> ranges [m], inf where nothing is
        angles = np.linspace(-self.half, self.half, self.pixels)
        true = cast(angles)
        near = np.minimum(true, self.range)
        noisy = true + rng.normal(0.0, 0.005, len(true)) * near**2
        told = (rng.random(len(true)) < self.likely(near)) & (true > self.BLIND)
        return angles, np.where(told, noisy, np.nan)  # NaN: that pixel says nothing

    def sees(self, distance, bearing):  # how likely a look shows a place that nothing hides
        return self.likely(distance) * ((distance > self.BLIND) & (np.abs(bearing) <= self.half))

    def likely(self, distance):
        return np.clip(1.0 - 0.7 * distance / self.range, 0.0, 1.0)


class Feelers:
    """Stick out all round, as long as the range; each says which of its switches gave way, 5 cm apart."""

    STEP = 0.05  # [m]

    def __init__(self, spec: PlatformSpec) -> None:
        self.angles, self.range = np.arange(spec.beams) * 2 * np.pi / spec.beams, spec.range

    def scan(self, cast, rng):
        touched = np.floor(cast(self.angles) / self.STEP) * self.STEP + self.STEP / 2
        return self.angles, touched  # inf: it touches nothing, so all along it is free

    def sees(self, distance, bearing):
        return (distance <= self.range).astype(float)

"""A domain of one's own, made of the skeleton: vehicles that hear where a sound comes from, but not how far.

`vedette sound:Sound`, and `vedette team sound:Sound` as processes; docs/how-to/own-domain.md explains.
"""

from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np
from msgspec import Meta

from vedette import LogDet
from vedette.missions.own.codec import FloatsCodec
from vedette.missions.own.scenario import OwnScenario, grid_over
from vedette.missions.own.theory import Theory

LEVELS = 1024.0  # evidence is in whole 1/1024 nat
MISSED = 0.05  # probability that a source within range is not heard, or one beyond is


class SoundScenario(OwnScenario, frozen=True, kw_only=True):
    cell: Annotated[float, Meta(gt=0.0)] = 10.0  # of the grid over which the source is sought [m]
    range: Annotated[float, Meta(gt=0.0)] = 250.0  # within which it is heard [m]
    bearing_noise: Annotated[float, Meta(gt=0.0, le=90.0)] = 8.0  # standard deviation [deg]


@dataclass(frozen=True, eq=False)
class Where:
    """What is known of the source."""

    pdf: np.ndarray  # (C,) of the cells, sum 1
    mean: np.ndarray  # (2,) [m]
    information: np.ndarray  # (2, 2), the inverse of the covariance [1/m^2]


class AboutTheSource(LogDet):
    """The entropy that bearings take off the source's place, as if it were Gaussian [nat]."""

    def nothing(self, belief):
        return super().nothing(belief.information)

    def value(self, belief, impact):
        return super().value(belief.information, impact)

    def values(self, belief, others, own):
        return super().values(belief.information, others, own)

    def wrong_belief(self, belief):
        return super().wrong_belief(belief.information)

    def wrong_impact(self, belief, own):
        return super().wrong_impact(belief.information, own)


class Sound(Theory):
    """Let vehicles that hear bearings find where a sound comes from. A vehicle hears no distance."""

    scenario_type = SoundScenario
    example: ClassVar = {
        "area": (0.0, 0.0, 500.0, 400.0),
        "vehicles": [{"start": (30.0, 30.0, 0.0)}, {"start": (60.0, 30.0, 90.0)}],
        "duration": 40.0,
    }
    objective = AboutTheSource()
    codec = FloatsCodec((2, 2))

    def __init__(self, scenario):
        super().__init__(scenario)
        self.grid = grid_over(scenario.area, scenario.cell)
        self.cells = self.grid.centres(np.arange(self.grid.size))
        self.noise = np.radians(scenario.bearing_noise)

    def truth(self, rng):
        x0, y0, x1, y1 = self.scenario.area
        return rng.uniform((x0, y0), (x1, y1))

    def sense(self, truth, i, pose, rng):  # a bearing, or NaN: all is quiet
        near = np.hypot(*(truth - pose[:2])) <= self.scenario.range
        hears = near != (rng.random() < MISSED)
        bearing = np.arctan2(*(truth - pose[:2])[::-1]) + rng.normal(0.0, self.noise)
        return float(bearing) if hears else np.nan

    @property
    def size(self):
        return self.grid.size

    def evidence(self, i, pose, told):  # log-likelihoods of the cells, which add up over looks
        away = self.cells - pose[:2]
        near = np.hypot(*away.T) <= self.scenario.range
        heard = np.where(near != np.isnan(told), np.log(1.0 - MISSED), np.log(MISSED))
        if not np.isnan(told):
            off = np.remainder(told - np.arctan2(away[:, 1], away[:, 0]) + np.pi, 2.0 * np.pi) - np.pi
            heard = heard - 0.5 * np.minimum((off / self.noise) ** 2, 40.0)
        levels = np.rint(heard * LEVELS).astype(np.int64)
        return np.flatnonzero(levels), levels[levels != 0]

    def belief(self, total):
        pdf = np.exp((total - total.max()) / LEVELS)
        pdf /= pdf.sum()
        mean = pdf @ self.cells
        apart = self.cells - mean
        spread = (pdf[:, None] * apart).T @ apart + self.scenario.cell**2 / 12.0 * np.eye(2)
        return Where(pdf, mean, np.linalg.inv(spread))

    def impacts(self, belief, i, poses):  # H' R^-1 H of each bearing, as far as the source may be in range
        away = belief.mean - poses[..., :2]
        square = (away**2).sum(axis=-1) + np.trace(np.linalg.inv(belief.information))
        across = np.stack((-away[..., 1], away[..., 0]), axis=-1) / (self.noise * square)[..., None]
        reach = np.hypot(*np.moveaxis(poses[..., None, :2] - self.cells, -1, 0)) <= self.scenario.range
        return list(np.einsum("nk,nki,nkj->nij", reach @ belief.pdf, across, across))

    def figures(self, belief, truth):
        deviation = np.sqrt(np.trace(np.linalg.inv(belief.information)))
        return {"error_m": float(np.hypot(*(belief.mean - truth))), "deviation_m": float(deviation)}

    def image(self, belief):
        return np.log(belief.pdf.reshape(self.grid.shape) + 1e-6)

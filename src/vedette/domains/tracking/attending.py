"""What a vehicle brings to the time after the horizon: it goes to a target and stays with it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vedette.domains.tracking.sensing import Sensor
from vedette.domains.tracking.tail import Tail
from vedette.domains.tracking.transit import times_to_see


@dataclass(frozen=True, eq=False)
class Attending:
    """What a vehicle brings to the tail: it goes to a target, then stays with it and what is near it."""

    sensor: Sensor
    speed: float  # [m/s]
    turn_rate: float  # [rad/s]

    def looks(self, tail: Tail, share: ArrayLike = 1.0) -> NDArray[np.float64]:
        """Information (..., T, B, 3) of one look a layer at each target, from half of the range and any side.

        One that is made with a probability, or for a part of its layer, has that ``share`` (..., T, B) of its
        worth: ``(1 + s I)^share = 1 + s I'`` for s the geometric mean of the target's variances.
        """
        a, b = self.sensor.weights(np.maximum(np.array([0.5 * self.sensor.range]), self.sensor.min_range))
        spread = tail.spreads.T  # (T, B)
        part = self.sensor.detection * np.asarray(share, np.float64)
        told = np.expm1(part * np.log1p(spread * float((a[0] + b[0]) / 2.0))) / spread
        return np.asarray(told[..., None] * np.array([1.0, 0.0, 1.0]))

    def blocks(self, tail: Tail, poses: NDArray[np.float64], target: int) -> NDArray[np.float64]:
        """Information (C, T, B, 3) of going from poses (C, 3) to a target, for as long as it is there.

        It finds what is within its range when it arrives, of a Gaussian about the place where it went, and
        keeps what it has found. A second later is a second less: so nobody puts it off.
        """
        places = tail.means[..., :2]
        times = times_to_see(self.sensor, self.speed, self.turn_rate, poses[:, None], places[None, :, target])
        share = np.clip((np.array(tail.ends) - times) / (tail.weights * tail.dt), 0.0, 1.0)  # (C, B)
        arrival = tail.spreads[np.argmax(share > 0.0, axis=1)]  # (C, T)
        found = -np.expm1(-(self.sensor.range**2) / (2.0 * arrival))
        attended = self._beside(poses[0], places, target).T * share[:, None]  # (C, T, B)
        return self.looks(tail, attended * found[..., None])

    def _beside(
        self, pose: NDArray[np.float64], places: NDArray[np.float64], target: int
    ) -> NDArray[np.bool_]:
        """Tell which targets (B, T) it sees beside the one that it is with, or turns to."""
        if self.speed > 0.0:
            away = np.hypot(*np.moveaxis(places - places[:, target, None], -1, 0))
            return np.asarray(away <= 0.5 * self.sensor.range)
        offset = places[:, target] - pose[:2]
        facing = np.arctan2(offset[:, 1], offset[:, 0])
        poses = np.stack([np.full_like(facing, pose[0]), np.full_like(facing, pose[1]), facing], -1)
        return self.sensor.sees(poses[:, None], places)

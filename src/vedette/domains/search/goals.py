"""Where to search after the horizon: the blocks that hold the most probability for their distance."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vedette.domains.search.belief import SearchBelief
from vedette.domains.search.flights import time_to
from vedette.domains.search.worth import DELAYS
from vedette.kernels.misses import CERTAIN, STEPS_PER_NAT, Misses

MOST_GOALS = 16
PROMISED = 1.0 - math.exp(-1.0)  # found by one horizon's effort in a block of the area that it sweeps


@dataclass(frozen=True, eq=False)
class Goals:
    """J square blocks, each of about the area that the vehicle sweeps in one horizon."""

    places: NDArray[np.float64]  # (J, 2) their middles [m], team frame
    cells: NDArray[np.uint32]  # (J, B) flat cells
    mass: NDArray[np.float64]  # (J,) probability in them after the horizon, if nobody looks
    side: float  # [m]

    def __len__(self) -> int:
        return len(self.places)


NO_GOALS = Goals(np.empty((0, 2)), np.empty((0, 0), np.uint32), np.empty(0), 0.0)


def find_goals(
    belief: SearchBelief, pose: NDArray[np.float64], area: float, speed: float, turn_rate: float
) -> Goals:
    """The best few blocks of ``area`` [m^2] by ``mass H / (H + tau)``, none overlapping another.

    H is the duration of the horizon, tau the time to get there: what the block yields a unit of time, as in
    the paper's rate, eq. (42).
    """
    frame = belief.frame
    side = int(np.clip(round(math.sqrt(area) / frame.resolution), 1, min(frame.shape)))
    row, col = (_starts(n, side) for n in frame.shape)
    summed = np.pad(belief.afterwards.cumsum(axis=0).cumsum(axis=1), ((1, 0), (1, 0)))
    upper, lower = summed[row + side], summed[row]
    mass = (upper[:, col + side] - upper[:, col] - lower[:, col + side] + lower[:, col]).ravel()
    corner = np.stack(np.meshgrid(row, col, indexing="ij"), axis=-1).reshape(-1, 2)
    origin = np.array([frame.origin_x, frame.origin_y])
    middle = np.asarray(origin + (corner[:, ::-1] + side / 2) * frame.resolution, np.float64)
    half = side * frame.resolution / 2
    worth = mass * share_left(time_to(pose[None], middle, half, speed, turn_rate)[0], belief.duration)
    chosen: list[int] = []
    while len(chosen) < MOST_GOALS and worth.max() > 0.0:
        chosen.append(int(np.argmax(worth)))
        worth[(np.abs(corner - corner[chosen[-1]]) < side).all(axis=1)] = 0.0
    inside = (np.arange(side)[:, None] * frame.cols + np.arange(side)).ravel()
    cells = (corner[chosen] @ (frame.cols, 1))[:, None] + inside
    return Goals(middle[chosen], cells.astype(np.uint32), mass[chosen], side * frame.resolution)


def share_left(delay: NDArray[np.float64], duration: float) -> NDArray[np.float64]:
    """``H / (H + tau)``: the share of the time until then that is spent searching."""
    return np.asarray(duration / (duration + delay))


def promise(delay: NDArray[np.float64], duration: float) -> tuple[NDArray[np.int64], Misses]:
    """Layer after the horizon, and log-miss of every cell, of a block that is reached ``delay`` [s] after it.

    docs/search.md (V48)

    The layer is the last that is not later, so its worth is too high by the share by which the detection is
    thinned: alone, a promise is worth ``PROMISED H / (H + tau)``; a second one for the same place, little.
    """
    layer = np.searchsorted(DELAYS, delay / duration, side="right") - 1
    found = PROMISED * (1.0 + DELAYS[layer]) * share_left(delay, duration)
    levels = np.rint(-STEPS_PER_NAT * np.log1p(-found))
    return layer, np.clip(levels, 1, CERTAIN).astype(np.uint8)


def _starts(n: int, side: int) -> NDArray[np.int64]:
    """First rows (or columns) of blocks, half a block apart, the last at the edge."""
    return np.unique(np.append(np.arange(0, n - side, max(1, side // 2)), n - side))

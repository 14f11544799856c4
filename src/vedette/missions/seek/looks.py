"""Where somebody may be by what is known of a building, and what a look from a place sees of that."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vedette.domains.mapping.belief import LN2, MapBelief, planning_factor
from vedette.domains.search.belief import SearchBelief
from vedette.domains.search.evidence import LEVELS_PER_NAT
from vedette.domains.search.motion import STILL
from vedette.domains.search.worth import Worth
from vedette.kernels.coverage import LAYERS
from vedette.kernels.visibility import line_of_sight
from vedette.maps import FREE, UNKNOWN, GridFrame

UNKNOWN_FREE = 0.5  # of an unknown cell, that it is free: as the map's prior has it


@dataclass(frozen=True, eq=False)
class Looker:
    """What a robot sees of planning cells when it looks for somebody, walls and the unknown in its way."""

    classes: NDArray[np.uint8]  # (R, C) whole planning cells
    resolution: float  # of the cells [m]
    reach: float  # [m]

    def seen(self, cell: int) -> NDArray[np.int64]:
        """Return the flat planning cells (of this part of the map) in sight and reach of a cell's centre."""
        factor, (rows, cols) = planning_factor(self.resolution), self.classes.shape
        row, col = divmod(int(cell), cols)
        most = int(self.reach / self.resolution)
        tops = np.arange(max(0, row - most) // factor, min(rows - 1, row + most) // factor + 1)
        lefts = np.arange(max(0, col - most) // factor, min(cols - 1, col + most) // factor + 1)
        middle_rows = np.minimum(tops * factor + factor // 2, rows - 1)
        middle_cols = np.minimum(lefts * factor + factor // 2, cols - 1)
        away = np.hypot(middle_rows[:, None] - row, middle_cols - col) * self.resolution
        near = away <= self.reach
        ahead = (middle_rows[:, None] * cols + middle_cols)[near]
        cells = (tops[:, None] * -(-cols // factor) + lefts)[near]
        free = self.classes.ravel()[ahead] == FREE
        ahead, cells = ahead[free], cells[free]
        seen: NDArray[np.int64] = cells[line_of_sight(self.classes != FREE, int(cell), ahead)]
        return seen


def room_for_somebody(classes: NDArray[np.uint8], factor: int) -> NDArray[np.float64]:
    """Return ``(r, c)`` how many cells of each planning cell somebody may stand in, unknown ones by half."""
    room = np.where(classes == FREE, 1.0, np.where(classes == UNKNOWN, UNKNOWN_FREE, 0.0))
    rows, cols = -(-classes.shape[0] // factor), -(-classes.shape[1] // factor)
    padded = np.zeros((rows * factor, cols * factor))
    padded[: classes.shape[0], : classes.shape[1]] = room
    return np.asarray(padded.reshape(rows, factor, cols, factor).sum(axis=(1, 3)))


def search_belief(belief: MapBelief, looked: NDArray[np.int64]) -> SearchBelief:
    """Return where somebody who stands still may be, and what finding them is worth by when.

    Beforehand alike in all cells where one can stand; less likely where somebody has looked in vain.

    Args:
        belief: the map of the same round.
        looked: ``(N,)`` of all planning cells, sums of log-misses [1/1024 nat].
    """
    planning, factor = belief.planning, belief.factor
    mass = np.full(planning.shape, UNKNOWN_FREE * factor**2)
    row, col = belief.first
    room = room_for_somebody(belief.classes, factor)
    mass[row : row + room.shape[0], col : col + room.shape[1]] = room
    mass *= np.exp(-looked.reshape(planning.shape) / LEVELS_PER_NAT)
    total = float(mass.sum())
    worth = np.cumsum(belief.layers.weights[::-1])[::-1]
    return SearchBelief(
        planning,
        mass / total if total > 0.0 else mass,
        STILL.stencil(planning.resolution, 1.0),
        1.0,
        0,
        Worth(np.maximum.accumulate(worth[::-1])[::-1], LAYERS),
    )


def entropy_of(frame: GridFrame) -> float:
    """Return what knowing the whole ground is worth [nat]."""
    return LN2 * frame.size


def levels(detection: float) -> int:
    """Return the log-miss of a look [1/1024 nat], at most that of a detection of 0.999999."""
    return round(-math.log(max(1.0 - detection, 1e-6)) * LEVELS_PER_NAT)

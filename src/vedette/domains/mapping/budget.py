"""How far a robot can still drive, and whether a way leaves enough to come home."""

from __future__ import annotations

from dataclasses import dataclass
from math import hypot, inf

import numpy as np
from numpy.typing import NDArray

from vedette.kernels.distance import distance_field
from vedette.maps import GridFrame

RESERVE, RESERVE_SHARE = 2.0, 0.1  # kept for ways round what comes between [m], and of the way home
JITTER = 0.02  # a pose that has moved by less has not been driven to [m]


@dataclass(eq=False)
class WayLeft:
    """What is left of the way that a robot's energy is good for; it begins where its home is."""

    whole: float  # [m]; inf: there is no end to it
    used: float = 0.0  # [m]
    home: tuple[float, float] | None = None  # [m], team frame
    _last: tuple[float, float] | None = None
    _frame: GridFrame | None = None
    _field: NDArray[np.float32] | None = None  # (R, C) way home from each cell [m]

    @property
    def limited(self) -> bool:
        """Whether there is an end to it."""
        return self.whole < inf

    @property
    def left(self) -> float:
        """The way that the robot can still drive [m]."""
        return self.whole - self.used

    def move(self, x: float, y: float) -> None:
        """Note where the robot is; the first place is its home."""
        if self._last is None:
            self.home = self._last = (x, y)
        elif (way := hypot(x - self._last[0], y - self._last[1])) >= JITTER:
            self.used += way
            self._last = x, y

    def look(self, frame: GridFrame, passable: NDArray[np.bool_]) -> None:
        """Find out how far home is on ``(R, C)`` ground."""
        if self.limited and self.home is not None:
            row, col = np.clip(frame.cell(*self.home), 0, (frame.rows - 1, frame.cols - 1))
            self._frame = frame
            self._field = distance_field(passable, int(row * frame.cols + col), frame.resolution)

    def affords(self, places: NDArray[np.float64], ways: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Tell which of ``(k, 2)`` places the robot can get home from after ways [m] that lead to them."""
        if not self.limited or self._field is None or self._frame is None:
            return np.ones(len(places), np.bool_)
        frame = self._frame
        col = ((places[:, 0] - frame.origin_x) / frame.resolution).astype(np.int64).clip(0, frame.cols - 1)
        row = ((places[:, 1] - frame.origin_y) / frame.resolution).astype(np.int64).clip(0, frame.rows - 1)
        return np.asarray(ways + needed(self._field[row, col]) <= self.left)


def needed(way_home: NDArray[np.float32]) -> NDArray[np.float64]:
    """Return what has to be left to drive home so far [m]."""
    return RESERVE + (1.0 + RESERVE_SHARE) * way_home.astype(np.float64)

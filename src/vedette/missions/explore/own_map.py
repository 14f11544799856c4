"""A map that a robot has made itself: evidence that takes the place of what the robot said before."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, cos, floor, sin

import numpy as np
from numpy.typing import NDArray

from vedette.maps import FREE, OCCUPIED, UNKNOWN, GridFrame
from vedette.maps.bounds import Bounds

FREE_SHARE = 0.5  # of a cell's samples that say free; fewer leave it unknown
EDGE = 1e-6  # of a cell: less is rounding


@dataclass(frozen=True, eq=False)
class OwnMap:
    """What the robot holds now; row 0 and column 0 begin at its corner, whatever way that is turned."""

    classes: NDArray[np.uint8]  # (R, C) UNKNOWN, FREE or OCCUPIED
    resolution: float  # [m]
    x: float  # of the corner [m], team frame
    y: float
    heading: float  # of its columns' direction [rad]

    def bounds(self, frame: GridFrame) -> Bounds:
        """Return the cells of a frame that the map lies on."""
        rows, cols = self.classes.shape
        c, s = cos(self.heading), sin(self.heading)
        along = self.resolution * np.array(((0, 0), (cols, 0), (0, rows), (cols, rows)), np.float64)
        x, y = self.x + along @ (c, -s), self.y + along @ (s, c)
        left, right = (x.min() - frame.origin_x, x.max() - frame.origin_x)
        low, high = (y.min() - frame.origin_y, y.max() - frame.origin_y)
        first_row, end_row = _cells(low, high, frame.resolution, frame.rows)
        first_col, end_col = _cells(left, right, frame.resolution, frame.cols)
        bounds = Bounds()
        if end_row > first_row and end_col > first_col:
            bounds.hold(first_row, end_row, first_col, end_col)
        return bounds

    def beyond(self, frame: GridFrame) -> int:
        """Count the cells of this map that say something of ground outside a frame."""
        row, col = np.nonzero(self.classes != UNKNOWN)
        along, up = self.resolution * (col + 0.5), self.resolution * (row + 0.5)
        c, s = cos(self.heading), sin(self.heading)
        places = np.column_stack((self.x + c * along - s * up, self.y + s * along + c * up))
        return int(np.count_nonzero(~frame.holds(places)))

    def laid(self, frame: GridFrame) -> NDArray[np.uint8]:
        """Return the classes ``(rows, cols)`` of a frame's cells as this map has them.

        Each cell is sampled as finely as this map is. It is occupied where a sample says so, so that walls
        stay closed, and free where at least half of its samples say that.
        """
        k = max(ceil(frame.resolution / self.resolution - EDGE), 1)
        x = frame.origin_x + frame.resolution / k * (np.arange(frame.cols * k) + 0.5) - self.x
        y = frame.origin_y + frame.resolution / k * (np.arange(frame.rows * k) + 0.5) - self.y
        c, s = cos(self.heading), sin(self.heading)
        col = np.floor((c * x + s * y[:, None]) / self.resolution).astype(np.int64)
        row = np.floor((c * y[:, None] - s * x) / self.resolution).astype(np.int64)
        inside = (row >= 0) & (row < self.classes.shape[0]) & (col >= 0) & (col < self.classes.shape[1])
        sampled = np.full(inside.shape, UNKNOWN, np.uint8)
        sampled[inside] = self.classes[row[inside], col[inside]]
        cells = sampled.reshape(frame.rows, k, frame.cols, k)
        free = (cells == FREE).mean(axis=(1, 3)) >= FREE_SHARE
        occupied = (cells == OCCUPIED).any(axis=(1, 3))
        return np.where(occupied, OCCUPIED, np.where(free, FREE, UNKNOWN)).astype(np.uint8)


def _cells(low: float, high: float, side: float, count: int) -> tuple[int, int]:
    """Return the first cell of one axis from ``low`` [m] on and the one after the last before ``high``."""
    first, end = floor(low / side + EDGE), ceil(high / side - EDGE)
    return min(max(first, 0), count), min(max(end, 0), count)

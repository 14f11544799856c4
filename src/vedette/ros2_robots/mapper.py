"""A map as SLAM makes it: what one robot's lidar has shown of the building, free of drift."""

from __future__ import annotations

from collections.abc import Mapping
from math import cos, sin
from typing import Any

import numpy as np
from numpy.typing import NDArray
from skimage.draw import line

from vedette.ros2_robots.building import Building

HIT, MISS, SURE = 3, 1, 12  # of a cell's count
INTO = 0.3  # a return lies so much of a cell in the wall


class Mapper:
    """Counts what beams meet and what they pass, on the building's own cells."""

    def __init__(self, building: Building) -> None:
        self._building = building
        self._counts: NDArray[np.int16] = np.zeros(building.solid.shape, np.int16)

    def look(self, x: float, y: float, yaw: float, scan: Mapping[str, Any]) -> None:
        """Take in a scan of a lidar that is there in the world."""
        ranges = np.asarray(scan["ranges"], np.float64).ravel()
        angles = yaw + scan["angle_min"] + scan["angle_increment"] * np.arange(len(ranges))
        hits = ranges < scan["range_max"]
        reach = ranges + INTO * self._building.resolution * hits
        start = self._cell(x, y)
        for angle, length, hit in zip(angles.tolist(), reach.tolist(), hits.tolist(), strict=True):
            end = self._cell(x + length * cos(angle), y + length * sin(angle))
            rows, cols = line(*start, *end)
            rows, cols = self._inside(rows, cols)
            self._counts[rows[:-1], cols[:-1]] -= MISS
            if len(rows):
                self._counts[rows[-1], cols[-1]] += HIT if hit else -MISS
        np.clip(self._counts, -SURE, SURE, out=self._counts)

    @property
    def occupancy(self) -> NDArray[np.int8]:
        """``(R, C)`` as ``nav_msgs/OccupancyGrid`` has it: 0, 100, -1 unknown."""
        counts = self._counts
        return np.where(counts == 0, -1, np.where(counts > 0, 100, 0)).astype(np.int8)

    def _cell(self, x: float, y: float) -> tuple[int, int]:
        side = self._building.resolution
        return int((y - self._building.lower) // side), int((x - self._building.left) // side)

    def _inside(
        self, rows: NDArray[np.int64], cols: NDArray[np.int64]
    ) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        height, width = self._counts.shape
        there = (rows >= 0) & (rows < height) & (cols >= 0) & (cols < width)
        return rows[there], cols[there]

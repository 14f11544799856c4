"""A map as SLAM makes it: what one robot's lidar has shown of the building, free of drift."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vedette.ros2_robots.building import Building

HIT, MISS, SURE = 3, 1, 12  # of a cell's count
INTO = 0.3  # a return lies so much of a cell in the wall
STEP = 0.25  # of a cell, between the places along a beam that are looked at

Floats = NDArray[np.float64]


class Mapper:
    """Counts what beams meet and what they pass, on the building's own cells.

    A beam passes what lies a cell before its return, and nothing beside it: along a wall, where beams are
    nearly parallel to it, cells that are only near a beam are the wall's.
    """

    def __init__(self, building: Building) -> None:
        self._building = building
        self._counts: NDArray[np.int16] = np.zeros(building.solid.shape, np.int16)

    def look(self, x: float, y: float, yaw: float, scan: Mapping[str, Any]) -> None:
        """Take in a scan of a lidar that is there in the world."""
        ranges = np.asarray(scan["ranges"], np.float64).ravel()
        angles = yaw + scan["angle_min"] + scan["angle_increment"] * np.arange(len(ranges))
        hits = ranges < scan["range_max"]
        side, size = self._building.resolution, self._counts.size
        along = STEP * side * np.arange(ranges.max(initial=0.0) // (STEP * side) + 1.0)
        beam, at = np.nonzero(along < (ranges - side * hits)[:, None])
        cells = self._cells(x + along[at] * np.cos(angles[beam]), y + along[at] * np.sin(angles[beam]))
        once = np.unique(beam[cells >= 0] * size + cells[cells >= 0]) % size  # a beam passes a cell once
        ends, ways = ranges[hits] + INTO * side, angles[hits]
        met = self._cells(x + ends * np.cos(ways), y + ends * np.sin(ways))
        more = HIT * np.bincount(met[met >= 0], minlength=size) - MISS * np.bincount(once, minlength=size)
        told = self._counts + more.reshape(self._counts.shape)
        self._counts = np.clip(told, -SURE, SURE).astype(np.int16)

    @property
    def occupancy(self) -> NDArray[np.int8]:
        """``(R, C)`` as ``nav_msgs/OccupancyGrid`` has it: 0, 100, -1 unknown."""
        counts = self._counts
        return np.where(counts == 0, -1, np.where(counts > 0, 100, 0)).astype(np.int8)

    def _cells(self, x: Floats, y: Floats) -> NDArray[np.int64]:
        """Return the flat cells of points; -1 for those outside the building."""
        building = self._building
        row = np.floor((y - building.lower) / building.resolution).astype(np.int64)
        col = np.floor((x - building.left) / building.resolution).astype(np.int64)
        rows, cols = self._counts.shape
        inside = (row >= 0) & (row < rows) & (col >= 0) & (col < cols)
        return np.where(inside, row * cols + col, -1)

"""Ways through the building, by scikit-image's minimum cost paths on an inflated costmap."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt
from skimage.graph import MCP_Geometric

from vedette.ros2_robots.building import Building

INFLATED = 0.5  # beyond the robot's rim costs rise toward walls [m]
STEEPNESS = 8.0  # of that rise [1/m]
MARGIN = 0.03  # beyond its rim that a way leaves at least [m]
GAP = 0.06  # that a robot keeps to others beside that [m]
TOLERANCE = 0.5  # a goal that is in the way of something is moved so far at most [m]


class WayFinder:
    """Plans for a robot of one size."""

    def __init__(self, building: Building, radius: float) -> None:
        """``radius``: of the robot [m]."""
        self._building, self._radius = building, radius
        self._room = (distance_transform_edt(~building.solid) - 0.5) * building.resolution  # to walls [m]

    def path(
        self, here: Sequence[float], goal: Sequence[float], discs: Sequence[Sequence[float]]
    ) -> NDArray[np.float64] | None:
        """Return ``(L, 2)``: a way round walls and discs x, y, radius [m]; None: there is none."""
        room = self._room.copy()
        rows, cols = np.indices(room.shape)
        x, y = self._centres(rows, cols)
        for dx, dy, radius in discs:
            np.minimum(room, np.hypot(x - dx, y - dy) - radius - GAP, out=room)
        start = self._cell(here)
        free = room > min(self._radius + MARGIN, float(room[start]))  # who is nearer already may leave
        end = self._nearest(free, self._cell(goal))
        if end is None:
            return None
        free[start] = True
        beyond = np.maximum(room - self._radius, 0.0)
        costs = np.where(free, 1.0 + 20.0 * np.exp(-STEEPNESS * beyond) * (beyond < INFLATED), -1.0)
        search = MCP_Geometric(costs)
        reached, _ = search.find_costs([start], [end])
        if not np.isfinite(reached[end]):
            return None
        cells = np.array(search.traceback(end))
        return np.column_stack(self._centres(cells[:, 0], cells[:, 1]))

    def room(self, places: NDArray[np.float64], discs: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return ``(k,)`` how far the robot's rim is from walls and discs at places ``(k, 2)`` [m].

        Of discs, ``(n, 3)`` x, y, radius [m], a gap is kept. What is far is only told to be so.
        """
        side, reach = self._building.resolution, int(2.0 * self._radius / self._building.resolution) + 2
        row, col = self._cell(places.mean(axis=0).tolist())
        row, col = max(row - reach, 0), max(col - reach, 0)
        walls = np.argwhere(self._building.solid[row : row + 2 * reach + 1, col : col + 2 * reach + 1])
        x, y = self._centres(walls[:, 0] + row, walls[:, 1] + col)
        beside = [np.maximum(np.abs(places[:, i, None] - at) - side / 2, 0.0) for i, at in enumerate((x, y))]
        to_walls = np.hypot(*beside).min(axis=1, initial=reach * side)
        away = np.hypot(places[:, 0, None] - discs[:, 0], places[:, 1, None] - discs[:, 1]) - discs[:, 2]
        return np.asarray(np.minimum(to_walls, away.min(axis=1, initial=np.inf) - GAP) - self._radius)

    def _centres(
        self, rows: NDArray[np.int64], cols: NDArray[np.int64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        side, x, y = self._building.resolution, cols.astype(np.float64), rows.astype(np.float64)
        return self._building.left + (x + 0.5) * side, self._building.lower + (y + 0.5) * side

    def _cell(self, at: Sequence[float]) -> tuple[int, int]:
        side, (rows, cols) = self._building.resolution, self._room.shape
        row, col = int((at[1] - self._building.lower) // side), int((at[0] - self._building.left) // side)
        return min(max(row, 0), rows - 1), min(max(col, 0), cols - 1)

    def _nearest(self, free: NDArray[np.bool_], cell: tuple[int, int]) -> tuple[int, int] | None:
        """Return the free cell nearest to one, within the tolerance."""
        if free[cell]:
            return cell
        reach = int(TOLERANCE / self._building.resolution)
        row, col = max(cell[0] - reach, 0), max(cell[1] - reach, 0)
        near = np.argwhere(free[row : cell[0] + reach + 1, col : cell[1] + reach + 1])
        near += (row, col)
        if not len(near):
            return None
        best = near[np.hypot(*(near - cell).T).argmin()]
        return int(best[0]), int(best[1])

"""Where a grid lies in the world: resolution, origin and shape."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil

import numpy as np
from numpy.typing import NDArray

UNKNOWN = 0
FREE = 1
OCCUPIED = 2


@dataclass(frozen=True)
class GridFrame:
    """An axis-aligned grid in the team frame; row 0 is the lowest y, column 0 the lowest x.

    The order is that of ``nav_msgs/OccupancyGrid``: cell ``(row, col)`` covers
    ``[origin_x + col * resolution, origin_x + (col + 1) * resolution)`` in x, likewise rows in y.
    """

    resolution: float  # cell side [m]
    rows: int
    cols: int
    origin_x: float = 0.0  # lower-left corner of cell (0, 0) [m], team frame
    origin_y: float = 0.0

    @classmethod
    def over(cls, area: tuple[float, float, float, float], resolution: float) -> GridFrame:
        """Return the grid of whole cells over an area: lowest x, lowest y, highest x, highest y [m]."""
        x0, y0, x1, y1 = area
        rows, cols = (max(1, ceil((high - low) / resolution - 1e-9)) for low, high in ((y0, y1), (x0, x1)))
        return cls(resolution, rows, cols, x0, y0)

    @property
    def shape(self) -> tuple[int, int]:
        """``(rows, cols)``."""
        return self.rows, self.cols

    @property
    def size(self) -> int:
        """Number of cells."""
        return self.rows * self.cols

    @property
    def extent(self) -> tuple[float, float, float, float]:
        """``(x_min, x_max, y_min, y_max)`` [m], as matplotlib's ``imshow`` takes it."""
        return (
            self.origin_x,
            self.origin_x + self.cols * self.resolution,
            self.origin_y,
            self.origin_y + self.rows * self.resolution,
        )

    def cell(self, x: float, y: float) -> tuple[int, int]:
        """Return the ``(row, col)`` that holds the point; it may lie outside the grid."""
        return (
            int(np.floor((y - self.origin_y) / self.resolution)),
            int(np.floor((x - self.origin_x) / self.resolution)),
        )

    def contains(self, x: float, y: float) -> bool:
        """Tell whether the point lies in the grid."""
        row, col = self.cell(x, y)
        return 0 <= row < self.rows and 0 <= col < self.cols

    def holds(self, places: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Tell which of the points ``(n, 2)`` [m] lie in the grid, ``(n,)``."""
        x_min, x_max, y_min, y_max = self.extent
        inside = (places >= (x_min, y_min)) & (places < (x_max, y_max))
        return np.asarray(inside.all(axis=1))

    def flat(self, x: float, y: float) -> int:
        """Return the flat (row-major) index of the cell that holds a point inside the grid."""
        row, col = self.cell(x, y)
        return row * self.cols + col

    def centres(self, flat: NDArray[np.integer]) -> NDArray[np.float64]:
        """Return the ``(n, 2)`` cell centres ``[x, y]`` [m] of flat (row-major) cell indices."""
        row, col = np.divmod(np.asarray(flat), self.cols)
        return np.column_stack(
            (
                self.origin_x + (col + 0.5) * self.resolution,
                self.origin_y + (row + 0.5) * self.resolution,
            )
        )

    def window(self, rows: slice, cols: slice) -> GridFrame:
        """Return the frame of some of the rows and columns."""
        return GridFrame(
            self.resolution,
            rows.stop - rows.start,
            cols.stop - cols.start,
            self.origin_x + cols.start * self.resolution,
            self.origin_y + rows.start * self.resolution,
        )

    def mean(self, mass: NDArray[np.float64]) -> tuple[float, float]:
        """Return the mean place [m] of a density ``(rows, cols)`` of sum 1."""
        x, y = (mass.ravel() @ self.centres(np.arange(self.size))).tolist()
        return x, y

    def coarse(self, factor: int) -> GridFrame:
        """Return the frame whose cells are ``factor x factor`` of these, padded at the far edges."""
        return GridFrame(
            self.resolution * factor,
            -(-self.rows // factor),
            -(-self.cols // factor),
            self.origin_x,
            self.origin_y,
        )

    def finer(self, parts: int) -> GridFrame:
        """Return the frame of ``parts x parts`` cells in each of these."""
        return GridFrame(
            self.resolution / parts, self.rows * parts, self.cols * parts, self.origin_x, self.origin_y
        )

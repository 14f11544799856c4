"""Rectangles of whole cells, of which floor plans are made."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Rect:
    """Cells ``[row, row_end) x [col, col_end)``."""

    row: int
    col: int
    row_end: int
    col_end: int

    @property
    def height(self) -> int:
        """Rows."""
        return self.row_end - self.row

    @property
    def width(self) -> int:
        """Columns."""
        return self.col_end - self.col

    @property
    def area(self) -> int:
        """Cells."""
        return self.height * self.width

    @property
    def slices(self) -> tuple[slice, slice]:
        """Index of the cells in a grid that holds them all."""
        return slice(self.row, self.row_end), slice(self.col, self.col_end)

    def of(self, grid: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Return the view of the grid's cells in here, without those outside the grid."""
        return grid[max(self.row, 0) : max(self.row_end, 0), max(self.col, 0) : max(self.col_end, 0)]

    def holds(self, other: Rect) -> bool:
        """Tell whether the other one's first cell is in here."""
        return self.row <= other.row < self.row_end and self.col <= other.col < self.col_end

    def turned(self) -> Rect:
        """Return the rectangle with rows and columns exchanged."""
        return Rect(self.col, self.row, self.col_end, self.row_end)

    def cut(self, at: int, gap: int, rows: bool) -> tuple[Rect, Rect]:
        """Return the part before ``at`` and the part from ``at + gap``, along rows or along columns."""
        if rows:
            return (
                Rect(self.row, self.col, at, self.col_end),
                Rect(at + gap, self.col, self.row_end, self.col_end),
            )
        low, high = self.turned().cut(at, gap, rows=True)
        return low.turned(), high.turned()

    def between(self, other: Rect, thick: int) -> Rect | None:
        """Return the wall of at most ``thick`` cells that the two share face to face, ``None`` if none."""
        rows = max(self.row, other.row), min(self.row_end, other.row_end)
        cols = max(self.col, other.col), min(self.col_end, other.col_end)
        if rows[0] < rows[1] and 0 <= cols[0] - cols[1] <= thick:
            return Rect(rows[0], cols[1], rows[1], cols[0])
        if cols[0] < cols[1] and 0 <= rows[0] - rows[1] <= thick:
            return Rect(rows[1], cols[0], rows[0], cols[1])
        return None

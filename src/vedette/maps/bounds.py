"""The rows and columns within which something happened on a grid, so that the rest need not be looked at."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Extent = tuple[slice, slice]  # rows, columns
EVERYWHERE: Extent = (slice(None), slice(None))


@dataclass
class Bounds:
    """Grows to hold what it is told of; nothing at first."""

    top: int = 0
    bottom: int = 0  # exclusive, like right
    left: int = 0
    right: int = 0

    @property
    def extent(self) -> Extent:
        """The smallest so far; empty if nothing was told."""
        return slice(self.top, self.bottom), slice(self.left, self.right)

    def widen(self, rows: NDArray[np.int64], cols: NDArray[np.int64]) -> None:
        """Hold these cells too."""
        if len(rows):
            self.hold(int(rows.min()), int(rows.max()) + 1, int(cols.min()), int(cols.max()) + 1)

    def hold(self, top: int, bottom: int, left: int, right: int) -> None:
        """Hold these rows and columns too, the last of each exclusive."""
        if self.top == self.bottom:
            self.top, self.bottom, self.left, self.right = top, bottom, left, right
        self.top, self.bottom = min(self.top, top), max(self.bottom, bottom)
        self.left, self.right = min(self.left, left), max(self.right, right)

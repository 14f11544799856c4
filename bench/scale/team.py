"""A team of any domain as the scale table needs it, and how platforms are spread over space."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vedette.problem import Objective, Reach
from vedette.problem.objective import Codec


@dataclass(frozen=True, eq=False)
class Team:
    """What n platforms negotiate on, with impacts as they travel."""

    objective: Objective[Any, Any]
    belief: Any
    places: NDArray[np.float64]  # (n, 2) [m]
    candidates: Sequence[Sequence[Any]]  # of each platform
    reaches: Sequence[Reach]  # of each platform: all its candidates are nothing outside
    codec: Codec[Any]
    bound: int  # no impact on this belief takes more [bytes]

    def __len__(self) -> int:
        return len(self.candidates)

    def first(self, n: int) -> Team:
        """Return the team of the first n platforms, on the same belief."""
        return replace(self, places=self.places[:n], candidates=self.candidates[:n], reaches=self.reaches[:n])


@dataclass(frozen=True)
class Lots:
    """``rows x cols`` square lots side by side, one a platform, numbered along a serpentine."""

    rows: int
    cols: int
    side: float  # [m]

    @classmethod
    def square(cls, n: int, side: float) -> Lots:
        """Return lots for n platforms, a power of two, as nearly square as that can be."""
        rows = 2 ** ((n.bit_length() - 1) // 2)
        return cls(rows, n // rows, side)

    @classmethod
    def strip(cls, n: int, side: float, width: int = 4) -> Lots:
        """Return lots for n platforms, a power of two, in a strip of ``width`` lots from side to side."""
        cols = min(n, width)
        return cls(n // cols, cols, side)

    @property
    def corners(self) -> NDArray[np.float64]:
        """(n, 2) lower-left corners [m]: rows from left to right and back in turn."""
        row, col = np.divmod(np.arange(self.rows * self.cols), self.cols)
        col = np.where(row % 2, self.cols - 1 - col, col)
        return np.asarray(np.column_stack((col, row)) * self.side, np.float64)

    def places(self, rng: np.random.Generator, margin: float = 0.1) -> NDArray[np.float64]:
        """Return (n, 2) random places [m], in each lot one, ``margin`` of its side away from its edges."""
        inside = rng.uniform(margin, 1.0 - margin, (self.rows * self.cols, 2))
        return np.asarray(self.corners + self.side * inside, np.float64)

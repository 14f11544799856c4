"""What a measurement averages: the square block of cells about a place, by kinds of sensors."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from vedette.errors import InputError
from vedette.maps import GridFrame

WIDEST = 15  # cells


@dataclass(frozen=True)
class Spots:
    """The team's kinds of sensors: each measures the mean over ``side x side`` cells, 1 for a point sensor.

    A **spot** is a kind and a cell, numbered ``kind * cells + cell``; at the border the block is cut off.

    Raises:
        InputError: no kind, one twice, a side that is even, below 1 or above 15.
    """

    frame: GridFrame
    sides: tuple[int, ...] = (1,)  # [cells], odd

    def __post_init__(self) -> None:
        if not self.sides or len(set(self.sides)) != len(self.sides):
            raise InputError(f"footprints: sides must be given once each; got {list(self.sides)}")
        for side in self.sides:
            if not (1 <= side <= WIDEST and side % 2 == 1):
                raise InputError(f"footprints: a side must be odd, 1 to {WIDEST} cells; got {side}")

    @property
    def count(self) -> int:
        """How many there are."""
        return len(self.sides) * self.frame.size

    def of(self, side: int, cells: NDArray[np.integer]) -> NDArray[np.int64]:
        """Return the spots of a kind about flat cells."""
        return np.asarray(self.sides.index(side) * self.frame.size + np.asarray(cells), np.int64)

    @cached_property
    def weights(self) -> sp.csr_matrix:
        """``W``, sparse (spots, n): the share of each cell in what is measured at a spot; rows sum to 1."""
        weights = sp.csr_matrix(
            sp.vstack([sp.kron(*(_window(n, side) for n in self.frame.shape)) for side in self.sides])
        )
        weights.eliminate_zeros()  # which SciPy's product keeps where blocks are wide in a narrow grid
        return weights

    @cached_property
    def whole(self) -> NDArray[np.bool_]:
        """(spots,) Where no border cuts the block off."""
        rows, cols = np.divmod(np.arange(self.frame.size), self.frame.cols)
        margin = np.minimum.reduce((rows, cols, self.frame.rows - 1 - rows, self.frame.cols - 1 - cols))
        return np.concatenate([margin >= side // 2 for side in self.sides])

    def planes(self, numbers: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return numbers of all spots as a plane for each kind, (kinds, R, C)."""
        return numbers.reshape(len(self.sides), *self.frame.shape)


def _window(n: int, side: int) -> sp.spmatrix:
    """Return the means over windows of ``side`` cells in a row of n, (n, n)."""
    reach = min(side // 2, n - 1)
    ones = sp.diags([np.ones(n - abs(k)) for k in range(-reach, reach + 1)], list(range(-reach, reach + 1)))
    return sp.diags(1.0 / np.asarray(ones.sum(axis=1)).ravel()) @ ones

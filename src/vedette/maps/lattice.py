"""The team's common grid: which cells there can be, and which of them are the team's at all."""

from __future__ import annotations

import hashlib
import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from vedette.errors import InputError
from vedette.maps.area import Area
from vedette.maps.frame import GridFrame

HALF = 4096  # cells from the origin to each side, where nobody says how far the ground goes
MOST_CELLS = (2 * HALF) ** 2  # that a lattice may have


@dataclass(frozen=True)
class Lattice:
    """What all robots of a team must agree on, so that a cell is the same to each of them.

    Evidence, planning cells and impacts are numbered on ``frame``, but only what is seen is held, planned on
    and sent. A map's lattice is the map; a team that does not know its ground has one about its frame's
    origin, or about its area.
    """

    frame: GridFrame  # of all cells that there can be; what lies outside does not exist
    area: Area | None = None  # None: all of the frame
    bounded: bool = True  # the ground to explore is known to be this; False: nobody knows how much there is

    @classmethod
    def open(
        cls, resolution: float, origin: tuple[float, float] = (0.0, 0.0), area: Area | None = None
    ) -> Lattice:
        """Return the lattice of ground whose extent is not known.

        Args:
            resolution: cell side [m].
            origin: a corner of cells [m], team frame.
            area: where the team has leave to work; None: wherever it gets.

        Raises:
            InputError: the resolution cannot be, or the area has too many cells.
        """
        if not (math.isfinite(resolution) and 1e-3 <= resolution <= 1e3):
            raise InputError(f"resolution: {resolution:g} m; give 0.001 to 1000")
        if area is None:
            low, high = (-HALF, -HALF), (HALF, HALF)
        else:
            x0, y0, x1, y1 = area.box
            low = (math.floor((y0 - origin[1]) / resolution), math.floor((x0 - origin[0]) / resolution))
            high = (math.ceil((y1 - origin[1]) / resolution), math.ceil((x1 - origin[0]) / resolution))
        rows, cols = high[0] - low[0], high[1] - low[1]
        if rows * cols > MOST_CELLS:
            raise InputError(
                f"area: {cols} x {rows} cells of {resolution:g} m; at most {MOST_CELLS} are planned on, so "
                "give a smaller area or a larger resolution"
            )
        corner = origin[0] + low[1] * resolution, origin[1] + low[0] * resolution
        lattice = cls(GridFrame(resolution, rows, cols, *corner), area, bounded=area is not None)
        if lattice.cells == 0:
            raise InputError(f"area: no cell of {resolution:g} m has its middle in it; give a larger one")
        return lattice

    @cached_property
    def cells(self) -> int | None:
        """Number of cells that are the team's ground; None: nobody knows."""
        if self.area is None:
            return self.frame.size if self.bounded else None
        return int(np.count_nonzero(self.area.holds(self.frame)))

    @property
    def room(self) -> str:
        """Where the cells lie, in words."""
        x_min, x_max, y_min, y_max = self.frame.extent
        return f"x {x_min:.1f} to {x_max:.1f} m, y {y_min:.1f} to {y_max:.1f} m"

    @property
    def mark(self) -> int:
        """64 bits, equal for two robots (up to 2^-64) iff their lattices are."""
        return int.from_bytes(hashlib.blake2b(repr(self).encode(), digest_size=8).digest(), "little")

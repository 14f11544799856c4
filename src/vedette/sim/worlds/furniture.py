"""Put furniture on a floor so that a robot still gets everywhere."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vedette.sim.worlds.floor_plan import FloorPlan
from vedette.sim.worlds.rect import Rect
from vedette.sim.worlds.size import WorldScale

_PASSAGE = 0.7  # left beside every piece that does not touch what is there [m]
_DOORSTEP = 1.0  # depth kept clear on both sides of a door [m]


@dataclass(frozen=True)
class Piece:
    """Furniture seen from above, its back along row 0; the parts lie in a box that is placed as one."""

    height: int
    width: int
    parts: tuple[Rect, ...]

    def turned(self) -> Piece:
        """Return the piece turned by a quarter."""
        parts = (Rect(p.col, self.height - p.row_end, p.col_end, self.height - p.row) for p in self.parts)
        return Piece(self.width, self.height, tuple(parts))


class Floor:
    """A floor that is being furnished: walls and furniture, and what must stay clear."""

    def __init__(self, plan: FloorPlan, cells: WorldScale) -> None:
        self.cells = cells
        self.solid = plan.solid()
        self.placed: list[tuple[Rect, Piece]] = []
        self._clear = np.zeros_like(self.solid)
        for gap in (*plan.doors, *plan.openings):
            deep, wide = cells(_DOORSTEP), cells(0.1)
            tall = gap.height > gap.width
            by_row, by_col = (wide, deep) if tall else (deep, wide)
            step = Rect(gap.row - by_row, gap.col - by_col, gap.row_end + by_row, gap.col_end + by_col)
            step.of(self._clear)[...] = True

    def put(self, piece: Piece, row: int, col: int) -> bool:
        """Place a piece with its box's corner at ``(row, col)`` if it fits; tell whether it did.

        Each side of the box either touches a wall or furniture along its whole length, or leaves a passage
        there; opposite sides do not both touch.
        """
        box = Rect(row, col, row + piece.height, col + piece.width)
        rows, cols = self.solid.shape
        if box.row < 1 or box.col < 1 or box.row_end >= rows or box.col_end >= cols:
            return False
        below, above, left, right = self._touching(box)
        if (below and above) or (left and right) or box.of(self._clear).any():
            return False
        free = self.cells(_PASSAGE)
        around = Rect(
            box.row - free * (not below),
            box.col - free * (not left),
            box.row_end + free * (not above),
            box.col_end + free * (not right),
        )
        if around.of(self.solid).any():
            return False
        for part in piece.parts:
            self._part(box, part).of(self.solid)[...] = True
        self.placed.append((box, piece))
        return True

    def remove(self, box: Rect, piece: Piece) -> None:
        """Take a placed piece away."""
        self.placed.remove((box, piece))
        for part in piece.parts:
            self._part(box, part).of(self.solid)[...] = False

    def _touching(self, box: Rect) -> tuple[bool, bool, bool, bool]:
        rows, cols = box.slices
        return (
            bool(self.solid[box.row - 1, cols].all()),
            bool(self.solid[box.row_end, cols].all()),
            bool(self.solid[rows, box.col - 1].all()),
            bool(self.solid[rows, box.col_end].all()),
        )

    @staticmethod
    def _part(box: Rect, part: Rect) -> Rect:
        return Rect(box.row + part.row, box.col + part.col, box.row + part.row_end, box.col + part.col_end)

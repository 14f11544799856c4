"""Where a team has leave to work: in its area, if it has one, and outside of what has been forbidden."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vedette.maps.area import Area
from vedette.maps.frame import OCCUPIED, GridFrame


@dataclass(frozen=True)
class Leave:
    """A team's area and its no-go areas."""

    area: Area | None = None  # None: everywhere
    no_go: tuple[Area, ...] = ()

    def __bool__(self) -> bool:
        """Tell whether anything is not the team's."""
        return self.area is not None or bool(self.no_go)

    def holds(self, frame: GridFrame) -> NDArray[np.bool_]:
        """Return ``(R, C)``: which cells of a grid have their centre where the team may work."""
        inside = np.ones(frame.shape, np.bool_) if self.area is None else self.area.holds(frame)
        for each in self.no_go:
            inside &= ~each.holds(frame)
        return inside

    def close(self, classes: NDArray[np.uint8], frame: GridFrame) -> NDArray[np.uint8]:
        """Return the ``(R, C)`` classes of a grid with walls wherever the team may not work.

        A no-go area is closed with a cell around it, lest its edge cuts into a cell that is not.
        """
        inside = np.ones(frame.shape, np.bool_) if self.area is None else self.area.holds(frame)
        if self.no_go:
            inside &= ~self.forbidden(frame)
        return np.where(inside, classes, np.uint8(OCCUPIED))

    def forbidden(self, frame: GridFrame) -> NDArray[np.bool_]:
        """Return ``(R, C)``: which cells lie in a no-go area, or beside one that does."""
        rows, cols = frame.shape
        wider = GridFrame(
            frame.resolution,
            rows + 2,
            cols + 2,
            frame.origin_x - frame.resolution,
            frame.origin_y - frame.resolution,
        )
        inside = np.zeros(wider.shape, np.bool_)
        for each in self.no_go:
            inside |= each.holds(wider)
        around: NDArray[np.bool_] = np.zeros(frame.shape, np.bool_)
        for row in range(3):
            for col in range(3):
                around |= inside[row : row + rows, col : col + cols]
        return around

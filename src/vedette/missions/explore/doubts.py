"""Which occupied cells may be so by mistake: a robot that has nothing else left tries the ways they close."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from vedette.maps import OCCUPIED, GridFrame
from vedette.maps.disc import cells_under

SURE = 12  # own log-odds from which what was seen occupied mostly is [0.2 nats]
SETTLED = 0.5  # so far beyond its rim nothing is doubted any more where a robot could not get on [m]


@dataclass(eq=False)
class Doubts:
    """What one robot doubts of the map.

    A return that noise puts before the wall, or one that grazes a corner, leaves a cell occupied that is
    free. In a way little wider than the robot one of them closes it. Doubtful is what the robot itself has
    seldom seen occupied, and a cell that juts out alone from what is.
    """

    radius: float  # of the robot [m]
    _settled: list[tuple[float, float]] = field(default_factory=list)  # where it could not get on [m]

    def about(self, classes: NDArray[np.uint8], own: NDArray[np.int8], frame: GridFrame) -> NDArray[np.bool_]:
        """Return the doubtful cells of a grid, ``(R, C)``, by its classes and the robot's own log-odds."""
        occupied = classes == OCCUPIED
        doubtful: NDArray[np.bool_] = occupied & (((own > 0) & (own < SURE)) | jutting_out(occupied))
        for x, y in self._settled:
            doubtful.flat[cells_under(frame, x, y, self.radius + SETTLED)] = False
        return doubtful

    def settle(self, x: float, y: float) -> None:
        """Note that the robot could not get on from here [m], team frame: what stands here does stand."""
        self._settled.append((x, y))


def jutting_out(occupied: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return the occupied cells that lie between no two others: not in a wall, but on its face, or alone."""
    rows, cols = occupied.shape
    padded = np.pad(occupied, 1)

    def beside(up: int, right: int) -> NDArray[np.bool_]:
        return padded[1 + up : 1 + up + rows, 1 + right : 1 + right + cols]

    between = np.zeros_like(occupied)
    for up, right in ((0, 1), (1, 0), (1, 1), (1, -1)):
        between |= beside(up, right) & beside(-up, -right)
    return occupied & ~between

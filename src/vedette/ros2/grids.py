"""The robot's own map, as it stands after all that came."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vedette.maps import FREE, OCCUPIED, UNKNOWN
from vedette.missions.explore.own_map import OwnMap
from vedette.ros2.door import Grid, Patch
from vedette.ros2.transforms import Matrix, place

FREE_TO, OCCUPIED_FROM = 25, 65  # occupancy that is sure enough [%], as map_saver has it
AGAIN = 5.0  # a map is told again so often, news or not [s]


@dataclass
class Grids:
    """Keeps the newest map; times are the mission's [s]."""

    latest: Grid | None = None
    _fresh: bool = False  # something came since it was told
    _told: float = -AGAIN

    def take(self, told: Grid | Patch) -> None:
        """Take in a whole map, or cells of the present one; those beyond it are left out."""
        if isinstance(told, Grid):
            self.latest, self._fresh = told, True
            return
        if self.latest is None:
            return
        occupancy = self.latest.occupancy.copy()
        rows, cols = (max(at, 0) for at in (told.row, told.col))
        part = told.occupancy[rows - told.row :, cols - told.col :]
        part = part[: max(occupancy.shape[0] - rows, 0), : max(occupancy.shape[1] - cols, 0)]
        occupancy[rows : rows + part.shape[0], cols : cols + part.shape[1]] = part
        self.latest, self._fresh = replace(self.latest, occupancy=occupancy), True

    def due(self, T_team_frame: Matrix, now: float) -> OwnMap | None:
        """Return the map if it is to be told now; ``T_team_frame``: of the frame that it is in."""
        if self.latest is None or not (self._fresh or now >= self._told + AGAIN):
            return None
        self._fresh, self._told = False, now
        x, y, heading = place(T_team_frame @ self.latest.T)
        return OwnMap(classes_of_occupancy(self.latest.occupancy), self.latest.resolution, x, y, heading)


def classes_of_occupancy(occupancy: NDArray[np.int8]) -> NDArray[np.uint8]:
    """Return each cell's class; what is neither sure to be free nor to be occupied is unknown."""
    classes = np.full(occupancy.shape, UNKNOWN, np.uint8)
    classes[(occupancy >= 0) & (occupancy <= FREE_TO)] = FREE
    classes[occupancy >= OCCUPIED_FROM] = OCCUPIED
    return classes

"""Regions as units of commitment: to go on to another room costs seconds more than the way there."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from vedette.domains.mapping.belief import MapBelief
from vedette.domains.mapping.platform import MappingPlatform
from vedette.maps import FREE

HALF_A_DOOR = 0.65  # rooms are what is wider than this about their middle lines [m]
TO_LEAVE = 3.0  # to change rooms counts as so much more of a way [s]


@dataclass(eq=False)
class RegionPlatform(MappingPlatform):
    """Takes ways between rooms for longer than they are, so that tours finish a room before the next."""

    def prepare(self, belief: MapBelief) -> None:
        """As every platform; then make the ways between rooms longer."""
        super().prepare(belief)
        if self.stops is None or self.ground is None or not len(self.stops):
            return
        rooms = regions(belief.classes, belief.frame.resolution).ravel()
        own = rooms[self.ground.source]
        of = rooms[[belief.frame.flat(x, y) for x, y in self.stops.views]]
        leaves = np.where(of != own, np.float32(TO_LEAVE), np.float32(0.0))
        changes = np.where(of[:, None] != of, np.float32(TO_LEAVE), np.float32(0.0))
        self.stops = replace(
            self.stops, first_leg=self.stops.first_leg + leaves, legs=self.stops.legs + changes
        )


def regions(classes: NDArray[np.uint8], resolution: float) -> NDArray[np.int32]:
    """Return ``(R, C)`` the room of each cell: the nearest free ground that is wider than a door."""
    clear = ndimage.distance_transform_edt(np.pad(classes == FREE, 1))[1:-1, 1:-1] * resolution
    rooms, count = ndimage.label(clear > HALF_A_DOOR)
    if not count:
        return np.zeros(classes.shape, np.int32)
    rows, cols = ndimage.distance_transform_edt(rooms == 0, return_distances=False, return_indices=True)
    return np.asarray(rooms[rows, cols], np.int32)

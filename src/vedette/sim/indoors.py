"""Where a map's inside is, when its outside is free as well."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from vedette.kernels.components import components, largest
from vedette.kernels.frontier import traversable
from vedette.maps import FREE
from vedette.maps.world import World, standable


def indoors(world: World, radius: float) -> NDArray[np.bool_]:
    """Return ``bool[rows, cols]``: where a disc of ``radius`` [m] fits in the largest area between walls.

    A cell is between walls if on all four sides there comes one, or a gap too narrow for the disc, before the
    grid ends. So a team starts inside a building though the map calls its surroundings free. Where nothing is
    between walls, the largest area counts as it is.
    """
    places = standable(world, radius)
    between = places & _between_walls(world, radius)
    if not between.any():
        return largest(places)
    labels = components(places)
    return np.asarray(between & (labels == np.bincount(labels[between]).argmax()))


def _between_walls(world: World, radius: float) -> NDArray[np.bool_]:
    margin = math.ceil(radius / world.frame.resolution) + 1
    around = np.pad(world.classes(), margin, constant_values=FREE)  # the grid's end is no wall
    wall = ~traversable(around, radius, world.frame.resolution)[margin:-margin, margin:-margin]
    met = np.logical_or.accumulate
    across = met(wall, axis=1) & met(wall[:, ::-1], axis=1)[:, ::-1]
    return np.asarray(across & met(wall, axis=0) & met(wall[::-1], axis=0)[::-1])

"""An old map of the building, from its file, as a team expects what it has not seen by it."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from vedette.domains.mapping.prior import PriorMap
from vedette.errors import InputError
from vedette.maps import UNKNOWN, read_map
from vedette.maps.lattice import Lattice
from vedette.missions.explore.own_map import OwnMap


def read_prior(path: Path, lattice: Lattice) -> PriorMap:
    """Return what an old map has to say of a team's ground; its places are in the team's frame.

    Raises:
        InputError: it cannot be read, or knows nothing of that ground.
    """
    try:
        frame, classes = read_map(path, takes_resolution=False)
    except InputError as error:
        raise InputError(f"prior: {error}") from None
    saved = OwnMap(classes, frame.resolution, frame.origin_x, frame.origin_y, 0.0)
    rows, cols = saved.bounds(lattice.frame).extent
    part = lattice.frame.window(rows, cols)
    said = saved.laid(part) if part.size else np.empty((0, 0), np.uint8)
    if not np.any(said != UNKNOWN):
        raise InputError(f"prior: {path}: nothing of the team's ground is known in it; leave it out")
    return PriorMap.of(said, part)

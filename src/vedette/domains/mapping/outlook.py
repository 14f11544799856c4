"""What the frontiers still promise: what tells a team that it is time to gather up what it left behind."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vedette.domains.mapping.impact import MIN_SHARE
from vedette.domains.mapping.sightings import measured_model
from vedette.kernels import coverage

SIGHT = 3.0  # how far a look goes, whatever the team's lidars reach [m]
RAYS = 64  # in a look


def mean_promise(
    classes: NDArray[np.uint8],
    resolution: float,
    frontiers: tuple[NDArray[np.int64], NDArray[np.int64]],
    counts: NDArray[np.int64],
    unknown: NDArray[np.uint16],
    factor: int,
) -> float:
    """``sum_f n_f E_f / sum_f n_f``: area that a look from a frontier is expected to reveal, by its length.

    It depends on nothing but the team's map and sightings, so all robots with equal evidence get the same.
    0 on a map without frontiers.  docs/theory.md (V65)

    Args:
        classes: (R, C) team map.
        resolution: cell side [m].
        frontiers: cells and starts as ``find_frontiers`` returns them.
        counts: (4, BINS) the team's sightings.
        unknown: (r, c) unknown cells of each planning cell.
        factor: side of a planning cell [cells].

    Returns:
        The mean [m^2], each frontier weighing as many as it has cells.
    """
    lengths = np.diff(frontiers[1])
    if not len(lengths):
        return 0.0
    reach = SIGHT / resolution
    middles = members_in_the_middle(*frontiers, classes.shape[1])
    table = measured_model(counts, resolution, int(np.ceil(reach)), by_distance=True).table
    starts, cells, shares = coverage.footprints(
        classes, middles, np.zeros(len(middles)), reach, 2.0 * np.pi, table, True, RAYS, factor, MIN_SHARE
    )
    looks = np.repeat(np.arange(len(lengths)), np.diff(starts))
    revealed = np.bincount(looks, shares * unknown.ravel()[cells], minlength=len(lengths))
    return float((lengths * revealed).sum() / lengths.sum()) * resolution**2


def members_in_the_middle(
    cells: NDArray[np.int64], starts: NDArray[np.int64], cols: int
) -> NDArray[np.int64]:
    """Return of each frontier the cell nearest its centroid, ``(K,)`` flat cells; of several the first."""
    sizes = np.diff(starts)
    owner = np.repeat(np.arange(len(sizes)), sizes)
    squared = np.zeros(len(cells), np.int64)
    for axis in np.divmod(cells, cols):
        squared += (sizes[owner] * axis - np.add.reduceat(axis, starts[:-1])[owner]) ** 2
    return cells[np.lexsort((cells, squared, owner))[starts[:-1]]]

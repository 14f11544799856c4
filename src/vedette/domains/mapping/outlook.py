"""What the frontiers still promise: what tells a team that it is time to gather up what it left behind."""

from __future__ import annotations

import numpy as np
import scipy
from numpy.typing import NDArray

from vedette.domains.mapping.frontier_worth import middles
from vedette.domains.mapping.impact import MIN_SHARE
from vedette.domains.mapping.sightings import measured_model
from vedette.kernels import coverage
from vedette.maps import GridFrame

SIGHT = 3.0  # how far a look goes, whatever the team's lidars reach [m]
RAYS = 64  # in a look


def promises(
    classes: NDArray[np.uint8],
    berths: NDArray[np.uint8],
    resolution: float,
    frontiers: tuple[NDArray[np.int64], NDArray[np.int64]],
    counts: NDArray[np.int64],
    unknown: NDArray[np.uint16],
    factor: int,
) -> NDArray[np.float64]:
    """``E_f``: the area that a look from each frontier is expected to reveal; docs/theory.md (V65).

    It depends on nothing but the team's map and sightings, so all robots with equal evidence get the same.

    Args:
        classes: (R, C) team map.
        berths: (R, C) of its cells.
        resolution: cell side [m].
        frontiers: cells and starts as ``find_frontiers`` returns them.
        counts: (ROWS, BINS) the team's sightings.
        unknown: (r, c) unknown cells of each planning cell.
        factor: side of a planning cell [cells].

    Returns:
        (K,) [m^2].
    """
    count = len(frontiers[1]) - 1
    if not count:
        return np.zeros(0)
    reach = SIGHT / resolution
    middles = members_in_the_middle(*frontiers, classes.shape[1])
    table = measured_model(counts, resolution, int(np.ceil(reach)), by_distance=True).table
    starts, cells, shares = coverage.footprints(
        classes, berths, middles, np.zeros(count), reach, 2.0 * np.pi, table, True, RAYS, factor, MIN_SHARE
    )
    looks = np.repeat(np.arange(count), np.diff(starts))
    revealed = np.bincount(looks, shares * unknown.ravel()[cells], minlength=count)
    return np.asarray(revealed * resolution**2, np.float64)


def mean_promise(promised: NDArray[np.float64], starts: NDArray[np.int64]) -> float:
    """``sum_f n_f E_f / sum_f n_f`` [m^2]: each frontier weighs as many as it has cells; (V65).

    0 on a map without frontiers.
    """
    lengths = np.diff(starts)
    return float((lengths * promised).sum() / lengths.sum()) if len(lengths) else 0.0


def known_share(
    frame: GridFrame, frontiers: tuple[NDArray[np.int64], NDArray[np.int64]], promised: NDArray[np.float64]
) -> float:
    """``K / (K + H)``: of the work that is left, the share that is known; docs/theory.md (V230).

    K is the length of the shortest tree through the frontiers' middles, H how far somebody drives who sees
    what they promise in a swath of twice a look [m]. 1 where they promise nothing.

    Args:
        frame: of the window.
        frontiers: cells and starts as ``find_frontiers`` returns them.
        promised: (K,) area that a look from each is expected to reveal [m^2].
    """
    hidden = float(promised.sum()) / (2.0 * SIGHT)
    if hidden == 0.0:
        return 1.0
    places = middles(frame, *frontiers)
    apart = np.hypot(*(places[:, None] - places).T)
    tree = float(scipy.sparse.csgraph.minimum_spanning_tree(apart).sum())
    return tree / (tree + hidden)


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

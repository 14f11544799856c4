"""Priority areas: what is in them is worth more, and so are the frontiers by which one gets there."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from vedette.domains.mapping.approach import ways_to
from vedette.domains.mapping.frontier_worth import middles
from vedette.maps import UNKNOWN, GridFrame
from vedette.maps.area import Area

PULL = 10.0  # area that the frontiers stand for as ways to a priority area, all together, by its factor [m^2]
FADING = 3.0  # a frontier so much farther from it than another stands for 1 / e of what that does [m]
REACHED = 0.5  # of an area's cells are known: whoever is there finds its own way

Priorities = Sequence[tuple[Area, float]]  # areas, and how many times as much all in them is worth


def priority_factors(frame: GridFrame, priorities: Priorities) -> NDArray[np.float32]:
    """Return ``(R, C)``: how many times as much each cell of a grid is worth; the most of all areas."""
    factors = np.ones(frame.shape, np.float32)
    for area, factor in priorities:
        inside = area.holds(frame)
        factors[inside] = np.maximum(factors[inside], np.float32(factor))
    return factors


def pull(
    frame: GridFrame,
    classes: NDArray[np.uint8],
    frontiers: tuple[NDArray[np.int64], NDArray[np.int64]],
    priorities: Priorities,
    factor: int,
) -> NDArray[np.float64]:
    """Return ``(K,)`` the area [m^2] that each frontier stands for as the way to what has priority.

    ``P phi (1 - 2 k) e_f / sum_g e_g``, ``e_f = exp(-d_f / 3 m)``, with *d_f* the way from it to the area if
    all that is unknown can be driven through, *phi* the area's factor and *k* the known share of it, until
    half of it is known.  docs/mapping.md (V149)

    Args:
        frame: of the window.
        classes: ``(R, C)`` of the window.
        frontiers: cells and starts, as ``find_frontiers`` returns them.
        priorities: areas with their factors.
        factor: side of a planning cell [cells].
    """
    cells, starts = frontiers
    more = np.zeros(len(starts) - 1)
    if not len(more):
        return more
    for area, times in priorities:
        known = np.count_nonzero(area.holds(frame) & (classes != UNKNOWN)) * frame.resolution**2
        rest = 1.0 - known / area.square_metres / REACHED
        if rest > 0.0:
            ways = ways_to(area, frame, classes, frontiers, factor)
            ways = area.distance(middles(frame, cells, starts)) if ways is None else ways
            near = np.exp(-(ways - ways.min()) / FADING)
            more += PULL * times * rest * near / near.sum()
    return more

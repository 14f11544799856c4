"""Priority areas: what is in them is worth more, and so are the frontiers by which one gets there."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from vedette.domains.mapping.frontier_worth import middles
from vedette.maps import UNKNOWN, GridFrame
from vedette.maps.area import Area

PULL = 3.0  # area that the frontier nearest to a priority area stands for beside its own, by its factor [m^2]
FADING = 3.0  # a frontier so much farther from it than the nearest one stands for 1 / e of that [m]
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
) -> NDArray[np.float64]:
    """Return ``(K,)`` the area [m^2] that each frontier stands for as the way to what has priority.

    ``P phi (1 - 2 k) exp(-(d_f - min d) / 3 m)`` with *d_f* its distance to the area, *phi* the factor and
    *k* the known share of it, until half of it is known.  docs/mapping.md (V149)

    Args:
        frame: of the window.
        classes: ``(R, C)`` of the window.
        frontiers: cells and starts, as ``find_frontiers`` returns them.
        priorities: areas with their factors.
    """
    cells, starts = frontiers
    more = np.zeros(len(starts) - 1)
    if not priorities or not len(more):
        return more
    places = middles(frame, cells, starts)
    for area, factor in priorities:
        known = np.count_nonzero(area.holds(frame) & (classes != UNKNOWN)) * frame.resolution**2
        rest = 1.0 - known / area.square_metres / REACHED
        if rest > 0.0:
            away = area.distance(places)
            more += PULL * factor * rest * np.exp(-(away - away.min()) / FADING)
    return more

"""Patrols that need no negotiation: a lawn-mower's strip each, and places at random. The yardsticks."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vedette.domains.monitoring.platform import lawnmower
from vedette.domains.monitoring.ways import Place, Way, passable
from vedette.kernels.distance import shortcut, shortest_path
from vedette.maps import GridFrame


def strip(frame: GridFrame, here: Place, i: int, of: int, length: float) -> Way:
    """Return vehicle i's lawn-mower over its own one of equal strips, as dense as a way of ``length`` [m] is.

    The strips lie side by side along the area's longer side; there and back again until the way is gone.
    """
    x0, x1, y0, y1 = frame.extent
    edge = 0.5 * frame.resolution
    box = [x0 + edge, x1 - edge, y0 + edge, y1 - edge]
    across = 0 if box[1] - box[0] >= box[3] - box[2] else 2
    low, width = box[across], (box[across + 1] - box[across]) / of
    box[across], box[across + 1] = low + i * width, low + (i + 1) * width
    wide, high = box[1] - box[0], box[3] - box[2]
    lines = max(1, int((length - high) / max(wide, edge)))
    places = list(lawnmower(tuple(box), max(high / lines, frame.resolution)).places)
    if np.hypot(*np.subtract(places[-1], here)) < np.hypot(*np.subtract(places[0], here)):
        places.reverse()
    return _to_and_fro(here, places, length)


def at_random(frame: GridFrame, here: Place, length: float, rng: np.random.Generator) -> Way:
    """Return a way from place to place, each anywhere alike, until it is so long [m]."""
    x0, x1, y0, y1 = frame.extent
    edge = 0.5 * frame.resolution
    places: list[Place] = []
    way = Way((here, here))
    while way.length < length and len(places) < _MOST:
        places.append((float(rng.uniform(x0 + edge, x1 - edge)), float(rng.uniform(y0 + edge, y1 - edge))))
        way = Way((here, *places))
    return way


def around(way: Way, frame: GridFrame, blocked: NDArray[np.bool_]) -> Way:
    """Return a way over the same places that goes round cells which cannot be entered, (R, C).

    Places that are such cells, or that nobody gets to, are left out.
    """
    free = ~blocked
    places = [way.places[0]]
    for place in way.places[1:]:
        leg = Way((places[-1], place))
        if passable(leg, frame, blocked, leg.length) is leg:
            places.append(place)
        elif free[frame.cell(*place)]:
            here, there = (frame.flat(*at) for at in (places[-1], place))
            path = shortest_path(free, here, there, frame.resolution)
            if len(path):
                corners = frame.centres(shortcut(free, path)).tolist()
                places += [*((x, y) for x, y in corners), place]
    return Way(tuple(places) if len(places) > 1 else (places[0], places[0]))


_MOST = 10_000  # places of a patrol


def _to_and_fro(here: Place, places: list[Place], length: float) -> Way:
    """Return the way over places and back again, as often as it takes to be so long [m]."""
    once = Way(tuple(places))
    if once.length == 0.0:
        return Way((here, places[0]))
    tour = list(places)
    way = Way((here, *tour))
    while way.length < length and len(tour) < _MOST:
        places = places[::-1]
        tour += places[1:]
        way = Way((here, *tour))
    return way

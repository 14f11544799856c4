"""Ways over the field: lines between places at constant speed, and where one measures along them."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vedette.maps import GridFrame

Floats = NDArray[np.float64]
Place = tuple[float, float]


@dataclass(frozen=True)
class Way:
    """A strategy: from a place along straight legs, and then stay; places in the team frame [m]."""

    places: tuple[Place, ...]  # the first is where it begins
    step: int = 0  # at which it begins

    @property
    def length(self) -> float:
        """Of all legs [m]."""
        return float(self._marks[-1])

    @property
    def _marks(self) -> Floats:
        """How far along the way each place lies [m]."""
        legs = np.diff(np.array(self.places), axis=0)
        return np.concatenate(([0.0], np.cumsum(np.hypot(legs[:, 0], legs[:, 1]))))

    def at(self, distances: Floats) -> Floats:
        """Return the places (m, 2) so far along the way [m]; beyond its end, the end."""
        x, y = np.array(self.places).T
        return np.column_stack((np.interp(distances, self._marks, x), np.interp(distances, self._marks, y)))

    def after(self, distance: float) -> Way:
        """Return what is left of the way."""
        [(x, y)] = self.at(np.array([distance])).tolist()
        left = tuple(place for place, mark in zip(self.places, self._marks, strict=True) if mark > distance)
        return replace(self, places=((x, y), *left))


def passable(way: Way, frame: GridFrame, blocked: NDArray[np.bool_] | None, most: float) -> Way:
    """Return the way as far as it is free and no longer than ``most`` [m]; a blocked cell stops it before.

    Args:
        way: as one would like to go.
        frame: of the field; beyond it there is no way.
        blocked: (R, C) cells that cannot be entered; None: a flyer.
        most: budget left [m].
    """
    length = min(way.length, most)
    distances = np.linspace(0.0, length, max(2, int(np.ceil(4.0 * length / frame.resolution)) + 1))
    places = way.at(distances)
    free = frame.holds(places)
    if blocked is not None:
        row, col = (
            np.floor((places[:, ::-1] - (frame.origin_y, frame.origin_x)) / frame.resolution).astype(int).T
        )
        free[free] = ~blocked[row[free], col[free]]
    free[0] = True
    reached = float(distances[len(free) - 1 if free.all() else int(np.argmin(free)) - 1])
    if reached == way.length:
        return way
    marks = zip(way.places, way._marks, strict=True)
    [(x, y)] = way.at(np.array([reached])).tolist()
    return replace(way, places=(*(place for place, mark in marks if mark < reached or mark == 0.0), (x, y)))


def fan(place: Place, reach: float, bearings: int) -> list[Way]:
    """Return ways in two legs of half the reach each, the second in any of the same bearings; and staying."""
    turns = 2.0 * np.pi * np.arange(bearings) / bearings
    ahead = 0.5 * reach * np.column_stack((np.cos(turns), np.sin(turns)))
    ways = [Way((place, place))]
    for first in ahead:
        middle = np.array(place) + first
        ways += [Way((place, tuple(middle.tolist()), tuple((middle + second).tolist()))) for second in ahead]
    return ways

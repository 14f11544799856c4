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


def along(places: Floats, distances: Floats) -> Floats:
    """Return where one is, (W, M, 2), so far (W, M) [m] along each of many ways (W, P, 2)."""
    legs = np.diff(places, axis=1)
    lengths = np.hypot(legs[..., 0], legs[..., 1])
    marks = np.cumsum(lengths, axis=1) - lengths
    out = np.repeat(places[:, :1], distances.shape[1], axis=1)
    for leg, length, mark in zip(legs.swapaxes(0, 1), lengths.T, marks.T, strict=True):
        done = np.clip(distances - mark[:, None], 0.0, length[:, None])
        out += (
            leg[:, None]
            * np.divide(done, length[:, None], out=np.zeros_like(done), where=done > 0.0)[..., None]
        )
    return np.asarray(out)


def reached(places: Floats, frame: GridFrame, blocked: NDArray[np.bool_] | None, most: float) -> Floats:
    """Return how far one gets along each of many ways of as many places (W, P, 2), (W,) [m].

    Args:
        places: as one would like to go.
        frame: of the field; beyond it there is no way.
        blocked: (R, C) cells that cannot be entered, before which a way ends; None: a flyer.
        most: budget left [m].
    """
    lengths = np.minimum(np.hypot(*np.diff(places, axis=1).T).sum(axis=0), most)
    count = max(2, int(np.ceil(4.0 * lengths.max(initial=0.0) / frame.resolution)) + 1)
    distances: Floats = lengths[:, None] * np.linspace(0.0, 1.0, count)
    points = along(places, distances).reshape(-1, 2)
    free = frame.holds(points)
    if blocked is not None:
        row, col = cells_of(frame, points[free])
        free[free] = ~blocked[row, col]
    free = free.reshape(distances.shape)
    free[:, 0] = True
    last = np.where(free.all(axis=1), count - 1, np.argmin(free, axis=1) - 1)
    return np.asarray(distances[np.arange(len(places)), last])


def cells_of(frame: GridFrame, points: Floats) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return row and column of points (m, 2) [m]; they may lie outside the grid."""
    col, row = np.floor((points - (frame.origin_x, frame.origin_y)) / frame.resolution).astype(np.int64).T
    return row, col


def cut(way: Way, length: float) -> Way:
    """Return the way up to so far along it [m]."""
    if length >= way.length:
        return way
    marks = zip(way.places, way._marks, strict=True)
    [(x, y)] = way.at(np.array([length])).tolist()
    return replace(way, places=(*(place for place, mark in marks if mark < length or mark == 0.0), (x, y)))


def passable(way: Way, frame: GridFrame, blocked: NDArray[np.bool_] | None, most: float) -> Way:
    """Return the way as far as one gets along it, as `reached`."""
    return cut(way, float(reached(np.array([way.places]), frame, blocked, most)[0]))


def fan(place: Place, reach: float, bearings: int) -> list[Way]:
    """Return ways in two legs of half the reach each, the second in any of the same bearings; and staying."""
    turns = 2.0 * np.pi * np.arange(bearings) / bearings
    ahead = 0.5 * reach * np.column_stack((np.cos(turns), np.sin(turns)))
    ways = [Way((place, place, place))]
    for first in ahead:
        middle = np.array(place) + first
        ways += [Way((place, tuple(middle.tolist()), tuple((middle + second).tolist()))) for second in ahead]
    return ways

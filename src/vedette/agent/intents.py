"""What robots beacon of their motion, and where that takes them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

GAP = 0.1  # between two rims that pass [m]
HORIZON = 3.0  # of a beaconed path [m]
TICK = 0.2  # of the foreseen motion [s]


@dataclass(frozen=True, eq=False)
class Intent:
    """What a robot beacons of its motion; positions in metres from the grid's lower-left corner."""

    priority: int  # its index: lower goes first
    x: float
    y: float
    path: NDArray[np.float64]  # (L, 2) its next ~3 m, from where it is; empty: it stands still
    radius: float = 0.2  # [m]
    speed: float = 0.5  # [m/s]
    slowed: float = 0.0  # time without progress [s]

    @property
    def rank(self) -> tuple[bool, int]:
        """Lower goes first: moving before standing, then by priority."""
        return len(self.path) == 0, self.priority

    @cached_property
    def foreseen(self) -> NDArray[np.float64]:
        """Places ``(T, 2)`` every ``TICK`` seconds if the robot drives its path freely; one if it stands."""
        xy = np.empty((len(self.path) + 1, 2))
        xy[0], xy[1:] = (self.x, self.y), self.path
        if len(xy) == 1:
            return xy
        step = xy[1:] - xy[:-1]
        arc = np.zeros(len(xy))
        np.cumsum(np.sqrt((step * step).sum(axis=1)), out=arc[1:])
        along = np.arange(0.0, arc[-1] + self.speed * TICK, self.speed * TICK)
        way = np.empty((len(along), 2))
        way[:, 0], way[:, 1] = np.interp(along, arc, xy[:, 0]), np.interp(along, arc, xy[:, 1])
        return way

    def away(self, other: Intent) -> float:
        """Return how far the centres are from each other now [m]."""
        return float(np.hypot(other.x - self.x, other.y - self.y))


def apart(mine: NDArray[np.float64], theirs: Sequence[NDArray[np.float64]]) -> NDArray[np.float64]:
    """Return the distances of my foreseen motion from others', ``(n, T)`` [m], tick for tick.

    Who is at its end first waits there.
    """
    ways = np.empty((len(theirs) + 1, max(map(len, (mine, *theirs))), 2))
    for whole, way in zip(ways, (mine, *theirs), strict=True):
        whole[: len(way)], whole[len(way) :] = way, way[-1]
    between: NDArray[np.float64] = np.hypot(*(ways[1:] - ways[0]).transpose(2, 0, 1))
    return between

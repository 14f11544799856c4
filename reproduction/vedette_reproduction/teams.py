"""Random teams on which claims are tried: robots whose candidate sightings are discs of cells."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Float = NDArray[np.float64]
CANDIDATES = 6  # of each platform
RADIUS = 2.5  # of a sighting [cells]
REACH = 6.0  # how far a sighting may be from its platform [cells]
SIDE = 24  # of the fixed area [cells]
LOT = 8  # side of the area that each platform brings where the density is constant [cells]


@dataclass(frozen=True, eq=False)
class Team:
    """Weights of the cells, and every platform's candidate miss probabilities."""

    weights: Float  # (N,) [nat]
    candidates: list[list[Float]]  # (N,) each

    @property
    def n(self) -> int:
        """Number of platforms."""
        return len(self.candidates)


Kind = Callable[[int, np.random.Generator], Team]


def fixed_area(n: int, rng: np.random.Generator) -> Team:
    """Return n platforms anywhere in an area of 24 x 24 cells, whatever n is."""
    return _team(n, SIDE, rng.uniform(0, SIDE, (n, 2)), rng)


def constant_density(n: int, rng: np.random.Generator) -> Team:
    """Return n platforms in an area of 64 cells each, neighbours in number neighbours in place."""
    across = int(np.ceil(np.sqrt(n)))
    lots = np.array([(i // across, _winding(i, across)) for i in range(n)])
    return _team(n, LOT * across, LOT * (lots + rng.uniform(0.2, 0.8, (n, 2))), rng)


def same_list(n: int, rng: np.random.Generator) -> Team:
    """Return n platforms with the same n places to go to, a second look at any of which is worth nothing."""
    weights = np.sort(rng.uniform(0.5, 1.0, n))[::-1].copy()
    return Team(weights, [[1.0 - row for row in np.eye(n)] for _ in range(n)])


def separable(n: int, rng: np.random.Generator) -> Team:
    """Return n platforms that each see cells of their own only (paper, eq. (11))."""
    weights = rng.uniform(0.5, 1.0, 4 * n)
    candidates = []
    for i in range(n):
        misses = np.ones((CANDIDATES, 4 * n))
        misses[:, 4 * i : 4 * i + 4] = rng.uniform(size=(CANDIDATES, 4))
        candidates.append(list(misses))
    return Team(weights, candidates)


def _winding(i: int, across: int) -> int:
    row, col = divmod(i, across)
    return col if row % 2 == 0 else across - 1 - col


def _team(n: int, side: int, places: Float, rng: np.random.Generator) -> Team:
    rows, cols = np.divmod(np.arange(side * side), side)
    candidates = []
    for place in places:
        shifts = rng.uniform(-REACH, REACH, (CANDIDATES, 2))
        middles = np.clip(place + shifts, 0.0, side - 1.0)
        away = np.hypot(rows - middles[:, :1], cols - middles[:, 1:])
        candidates.append(list(np.where(away <= RADIUS, rng.uniform(0.0, 0.5, (CANDIDATES, 1)), 1.0)))
    return Team(rng.uniform(0.5, 1.0, side * side) * np.log(2.0), candidates)

"""Pairs of maps: of one place with a known truth, of different places, and of places that look alike."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from bench.frames.places import corridor, hotel, racks, symmetric
from bench.frames.robots import REACH, Mapped, anywhere, looked, mapped
from vedette.align.pose import FramePose
from vedette.kernels.distance import distance_field
from vedette.logs import RecordedLog, read_carmen
from vedette.maps import FREE
from vedette.maps.world import World, standable
from vedette.sim.worlds import GENERATORS

LOG_REACH = 20.0  # of a log's beams that count [m]
WAYS = 6.0, 22.0  # how far about its start a robot has explored [m]
STRETCHES = 0.15, 0.6  # of a log that a robot has
OVERLAPS = 0.1, 1.0  # of two maps of one place, drawn evenly
TRIES, NEAR_ENOUGH = 4, 0.05  # second maps made for one overlap, and how near it may be
SIZES = 20.0, 36.0  # of generated places [m]
STANDS = 0.25  # room that a start has about it [m]


@dataclass(frozen=True, eq=False)
class Pair:
    """Two maps, and whether they are of one place."""

    place: str
    a: Mapped
    b: Mapped
    together: bool  # of one place, whose frames lie as the maps' poses say

    @property
    def truth(self) -> FramePose:
        """T_a_b, if they are of one place."""
        return self.a.pose.inverse().after(self.b.pose)

    @property
    def common(self) -> float:
        """Free ground that both have mapped [m^2]."""
        if not self.together:
            return 0.0
        free = self.b.frame.centres(np.flatnonzero(self.b.classes == FREE))
        places = self.truth.places(free)
        inside = places[self.a.frame.holds(places)]
        col, row = np.floor(
            (inside - (self.a.frame.origin_x, self.a.frame.origin_y)) / self.a.frame.resolution
        ).T
        both = np.count_nonzero(self.a.classes[row.astype(int), col.astype(int)] == FREE)
        return float(both) * self.b.frame.resolution**2

    @property
    def least(self) -> float:
        """Free ground of the map that has less [m^2]."""
        sizes = [np.count_nonzero(m.classes == FREE) * m.frame.resolution**2 for m in (self.a, self.b)]
        return float(min(sizes))

    @property
    def overlap(self) -> float:
        """Share of the smaller map's free ground that the other has mapped too, 0..1."""
        return self.common / self.least if self.least else 0.0


@dataclass(frozen=True)
class Sources:
    """Where real places are, beside the generated ones."""

    floors: tuple[Path, ...]
    logs: tuple[Path, ...]

    @property
    def places(self) -> tuple[str, ...]:
        """All kinds of places, by name."""
        return (*GENERATORS, *(path.name for path in (*self.floors, *self.logs)))

    def two_of_one(self, number: int, place: str) -> Pair:
        """Return a pair of one place."""
        rng = np.random.default_rng([1, number])
        log = self._log(place)
        if log is not None:
            return _shares(place, log, rng)
        return _explored(place, self._world(place, rng), rng)

    def two_places(self, number: int) -> Pair:
        """Return a pair of different places: other floors, or other ones of a kind."""
        rng = np.random.default_rng([2, number])
        first, second = (str(name) for name in rng.choice(self.places, 2, replace=number % 2 == 0))
        if first == second and first not in GENERATORS:
            second = str(rng.choice(list(GENERATORS)))
        a, b = (self._alone(place, rng) for place in (first, second))
        return Pair(f"{first} / {second}", a, b, False)

    def two_alike(self, number: int) -> Pair:
        """Return a pair of one place that looks alike from afar."""
        rng = np.random.default_rng([3, number])
        kind = list(ALIKE)[number % len(ALIKE)]
        return _explored(kind, ALIKE[kind](rng), rng, tries=1)

    def _alone(self, place: str, rng: np.random.Generator) -> Mapped:
        log = self._log(place)
        if log is not None:
            return _share(log, 0, rng)
        world = self._world(place, rng)
        start = int(rng.choice(np.flatnonzero(standable(world, STANDS))))
        return mapped(looked(world, start, rng.uniform(*WAYS), rng), REACH, anywhere(rng))

    def _log(self, place: str) -> RecordedLog | None:
        return next((_log(path) for path in self.logs if path.name == place), None)

    def _world(self, place: str, rng: np.random.Generator) -> World:
        for path in self.floors:
            if path.name == place:
                return _floor(path)
        return _generated(place, rng)


def _generated(kind: str, rng: np.random.Generator) -> World:
    width, height = np.round(rng.uniform(*SIZES, 2)).tolist()
    return GENERATORS[kind](rng, width, height, 0.1)


def _symmetric(rng: np.random.Generator) -> World:
    return symmetric(_generated("office", rng))


ALIKE: dict[str, Callable[[np.random.Generator], World]] = {
    "hotel": hotel,
    "racks": racks,
    "corridor": corridor,
    "symmetric": _symmetric,
}


@cache
def _floor(path: Path) -> World:
    return World.from_map(path)


@cache
def _log(path: Path) -> RecordedLog:
    return read_carmen(path)


def _explored(place: str, world: World, rng: np.random.Generator, tries: int = TRIES) -> Pair:
    """Return what two robots have mapped, the second about the best of so many starts for the overlap drawn.

    One try is a start anywhere within what both explore. Where places look alike in parts that is enough: if
    each robot has seen another of the equal parts, no map can tell.
    """
    ok = standable(world, STANDS)
    cells = np.flatnonzero(ok)
    start = int(rng.choice(cells))
    field = distance_field(ok, start, world.frame.resolution).ravel()[cells]
    near, far = 0.0, float(field[np.isfinite(field)].max())
    ways = rng.uniform(*WAYS) * np.array([1.0, rng.uniform(0.7, 1.4)])
    first = mapped(looked(world, start, float(ways[0]), rng), REACH, anywhere(rng))
    wanted, apart = rng.uniform(*OVERLAPS), rng.uniform(0.0, min(far, 0.9 * float(ways.sum())))
    pairs: list[Pair] = []
    for _ in range(tries):
        other = int(cells[np.argmin(np.abs(field - apart) + rng.uniform(0.0, 0.5, len(cells)))])
        second = mapped(looked(world, other, float(ways[1]), rng), REACH, anywhere(rng))
        pairs.append(Pair(place, first, second, True))
        off = pairs[-1].overlap - wanted
        if abs(off) <= NEAR_ENOUGH:
            break
        near, far = (apart, far) if off > 0.0 else (near, apart)
        apart = (near + min(far, apart + float(ways.sum()))) / 2.0
    return min(pairs, key=lambda pair: abs(pair.overlap - wanted))


def _shares(place: str, log: RecordedLog, rng: np.random.Generator) -> Pair:
    """Return maps of two stretches of a log; where both run, the scans go to them in turn."""
    first, wanted = _share(log, 0, rng), rng.uniform(*OVERLAPS)
    pairs: list[Pair] = []
    for _ in range(TRIES):
        pairs.append(Pair(place, first, _share(log, 1, rng), True))
        if abs(pairs[-1].overlap - wanted) <= NEAR_ENOUGH:
            break
    return min(pairs, key=lambda pair: abs(pair.overlap - wanted))


def _share(log: RecordedLog, parity: int, rng: np.random.Generator) -> Mapped:
    """Return a map of every other scan of a stretch of a log."""
    count = len(log.scans)
    length = rng.uniform(*STRETCHES) * count
    first = int(rng.uniform(0.0, count - length))
    return mapped(log.scans[first - first % 2 + parity : int(first + length) : 2], LOG_REACH, anywhere(rng))

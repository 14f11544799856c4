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
SIZES = 20.0, 36.0  # of generated places [m]


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
        for path in self.logs:
            if path.name == place:
                return Pair(place, *_shares(_log(path), rng), True)
        return Pair(place, *_explored(self._world(place, rng), rng), True)

    def two_places(self, number: int) -> Pair:
        """Return a pair of different places: other floors, or other ones of a kind."""
        rng = np.random.default_rng([2, number])
        first, second = (str(name) for name in rng.choice(self.places, 2, replace=number % 2 == 0))
        if first == second and first not in GENERATORS:
            second = str(rng.choice(list(GENERATORS)))
        maps = [self.two_of_one(int(rng.integers(1 << 30)), place) for place in (first, second)]
        return Pair(f"{first} / {second}", maps[0].a, maps[1].b, False)

    def two_alike(self, number: int) -> Pair:
        """Return a pair of one place that looks alike from afar."""
        rng = np.random.default_rng([3, number])
        kind = list(ALIKE)[number % len(ALIKE)]
        return Pair(kind, *_explored(ALIKE[kind](rng), rng), True)

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


def _explored(world: World, rng: np.random.Generator) -> tuple[Mapped, Mapped]:
    """Return what two robots have mapped about two starts, the second's near the first's reach."""
    ok = standable(world, 0.25)
    cells = np.flatnonzero(ok)
    start = int(rng.choice(cells))
    field = distance_field(ok, start, world.frame.resolution).ravel()
    reach = rng.uniform(*WAYS) * np.array([1.0, rng.uniform(0.7, 1.4)])
    apart = min(rng.uniform(0.0, 0.9) * reach.sum(), float(field[cells][np.isfinite(field[cells])].max()))
    other = int(cells[np.argmin(np.abs(field[cells] - apart) + rng.uniform(0.0, 0.5, len(cells)))])
    first, second = (
        mapped(looked(world, at, way, rng), REACH, anywhere(rng))
        for at, way in zip((start, other), reach.tolist(), strict=True)
    )
    return first, second


def _shares(log: RecordedLog, rng: np.random.Generator) -> tuple[Mapped, Mapped]:
    """Return maps of two stretches of a log; where both run, the scans go to them in turn."""
    count = len(log.scans)
    length = rng.uniform(0.15, 0.6, 2) * count
    first = rng.uniform(0.0, count - length)
    maps = [
        mapped(log.scans[int(at) + parity : int(at + long) : 2], LOG_REACH, anywhere(rng))
        for parity, at, long in zip((0, 1), first.tolist(), length.tolist(), strict=True)
    ]
    return maps[0], maps[1]

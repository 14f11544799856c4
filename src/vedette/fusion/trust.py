"""Whose evidence to believe: a function of the evidence alone, in integers, so that all judge alike.

docs/trust.md (V73)
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vedette.fusion.link import Key
from vedette.kernels.tiles import CELLS, SIDE, Tiling

MARGIN = 0.45  # so near to a wall nothing contradicts: three deviations of 15 cm [m]
SHARE = 4  # two contradict each other in one part in so many of what both have something to say on, ...
LEAST_SHUT = 2.0  # ... of what is open, where there is at least so much of wall; or ... [m]
LEAST_WALL = 6.0  # ... of all walls, where they contradict each other about so much [m]
APART = (
    600  # so long after one robot's last look at a tile another one's first may see a changed world [0.1 s]
)
STANDS = 100  # who holds to something for less may still correct it [0.1 s]
WEAKLY_FREE, WEAKLY_OCCUPIED, FREE, OCCUPIED = 1, 2, 3, 4  # codes of evidence
FREE_PART = 4  # one cell in so many may be unknown in the open: a mate may have stood there
_STEPS = np.array((-1, 0, 1))

Read = Callable[[NDArray[np.int64]], NDArray[np.uint8]]


class Times(NamedTuple):
    """From when on a contributor has held to what it says of a tile, and when it last changed it [0.1 s].

    It holds to it from its first word on, or since it last took back much of that.
    """

    since: int
    changed: int


TimesOf = Mapping[Key, Mapping[int, Times]]  # by contributor and tile


class Views(NamedTuple):
    """What a contributor firmly says of a tile, each a set of its 1024 cells as bits of one integer."""

    walls: int  # firmly occupied
    near: int  # within the margin of a wall
    free: int  # firmly free
    open: int  # firmly free, and within the margin there is no wall, and hardly anything unknown


class Comparison(NamedTuple):
    """How far two contributors agree about a tile [cells]."""

    against: int  # walls of either where it is open to the other
    alike: int  # walls of either near one of the other
    open: int  # that are free to one and open to the other

    @classmethod
    def of(cls, a: Views, b: Views) -> Comparison:
        """Compare two views of one tile."""
        return cls(
            (a.walls & b.open).bit_count() + (b.walls & a.open).bit_count(),
            (a.walls & b.near).bit_count() + (b.walls & a.near).bit_count(),
            (a.free & b.open).bit_count() + (b.free & a.open).bit_count(),
        )

    @classmethod
    def total(cls, tallies: Iterable[Comparison]) -> Comparison:
        """Add them up."""
        return cls(*map(sum, zip((0, 0, 0), *tallies, strict=True)))


@dataclass
class Trust:
    """Finds who contradicts whom; kept up tile by tile, as evidence comes."""

    tiling: Tiling
    resolution: float  # [m]
    _views: dict[Key, dict[int, Views]] = field(default_factory=dict)
    _tallies: dict[tuple[Key, Key], dict[int, Comparison]] = field(default_factory=lambda: defaultdict(dict))

    @property
    def margin(self) -> int:
        """Cells within which nothing contradicts a wall; less than a tile."""
        return min(max(round(MARGIN / self.resolution), 1), SIDE - 1)

    def cells(self, length: float) -> int:
        """Return how many cells a wall of so many metres has."""
        return max(round(length / self.resolution), 2)

    def see(self, key: Key, changed: NDArray[np.int64], read: Read) -> None:
        """Take in what a contributor says of some tiles; ``read``: its codes, ``(T, 1024)``."""
        beside = np.unique(self._beside(changed))  # the margin reaches over rims
        tiles = beside[beside >= 0]
        views = self._views.setdefault(key, {})
        for tile, view in zip(tiles.tolist(), self._look(tiles, read), strict=True):
            if any(view) or tile in views:
                views[tile] = view
        for other, theirs in self._views.items():
            if other[0] != key[0]:
                pair = (key, other) if key < other else (other, key)
                for tile in tiles.tolist():
                    if tile in views and tile in theirs:
                        self._compare(pair, tile, views[tile], theirs[tile])

    def _compare(self, pair: tuple[Key, Key], tile: int, a: Views, b: Views) -> None:
        tally = Comparison.of(a, b)
        if any(tally):
            self._tallies[pair][tile] = tally
        else:
            self._tallies[pair].pop(tile, None)

    def forget(self, key: Key) -> None:
        """Take in that nothing of what a contributor has said lies where it was taken to lie."""
        self._views.pop(key, None)
        for pair in [pair for pair in self._tallies if key in pair]:
            del self._tallies[pair]

    def contradictions(
        self, times: Mapping[Key, Mapping[int, Times]], now: int
    ) -> dict[tuple[int, int], Comparison]:
        """Return how far pairs of robots contradict each other now, each with the lower number first.

        Only what stood at the same time counts, and what neither has corrected lately. ``now`` [0.1 s].
        """
        pairs: dict[tuple[int, int], Comparison] = {}
        for (a, b), tallies in self._tallies.items():
            if not any(tally.against for tally in tallies.values()):
                continue
            one, two = times[a], times[b]
            valid = [t for tile, t in tallies.items() if _counts(one.get(tile), two.get(tile), now)]
            robots = min(a[0], b[0]), max(a[0], b[0])
            pairs[robots] = Comparison.total([*valid, pairs.get(robots, Comparison(0, 0, 0))])
        return pairs

    def out(self, times: TimesOf, now: int, gone: frozenset[int] = frozenset()) -> frozenset[int]:
        """Return the robots that are not believed; ``gone``: who counts as no accuser, for other reasons."""
        found = self.contradictions(times, now)
        firm = {pair: t.against for pair, t in found.items() if self.is_firm(t)}
        return liars({pair: cells for pair, cells in firm.items() if gone.isdisjoint(pair)})

    def is_firm(self, tally: Comparison) -> bool:
        """Tell whether two robots cannot both be right: of what either says much is so to nobody else."""
        against, walls = tally.against, tally.against + tally.alike
        return self.is_shut(tally) or (against >= self.cells(LEAST_WALL) and SHARE * against >= walls)

    def is_shut(self, tally: Comparison) -> bool:
        """Tell whether much of what is open to one is wall to the other."""
        against, opens = tally.against, tally.against + tally.open
        return against >= self.cells(LEAST_SHUT) and SHARE * against >= opens

    def _beside(self, tiles: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return ``(T, 3, 3)``: each tile and those around it; -1 beyond the grid."""
        across, down = self.tiling.across, self.tiling.count // self.tiling.across
        row, col = np.divmod(tiles, across)
        rows = row[:, None, None] + _STEPS[:, None]
        cols = col[:, None, None] + _STEPS[None, :]
        inside = (rows >= 0) & (rows < down) & (cols >= 0) & (cols < across)
        return np.where(inside, rows * across + cols, -1)

    def _look(self, tiles: NDArray[np.int64], read: Read) -> list[Views]:
        """Return what a contributor firmly says of tiles, by the tiles and those beside them."""
        m, beside = self.margin, self._beside(tiles)
        around, where = np.unique(beside, return_inverse=True)
        codes = np.zeros((len(around), CELLS), np.uint8)
        codes[around >= 0] = read(around[around >= 0])
        blocks = codes[where.reshape(-1, 3, 3)].reshape(-1, 3, 3, SIDE, SIDE).transpose(0, 1, 3, 2, 4)
        rim = slice(SIDE - m, 2 * SIDE + m)
        part = blocks.reshape(-1, 3 * SIDE, 3 * SIDE)[:, rim, rim]
        walls, firm, own = part == OCCUPIED, part == FREE, slice(m, m + SIDE)
        free = _within(firm | (part == WEAKLY_FREE), m)
        known = FREE_PART * ((2 * m + 1) ** 2 - free) <= (2 * m + 1) ** 2
        blocked = _within(walls | (part == WEAKLY_OCCUPIED), m) > 0
        is_open = firm[:, own, own] & known & ~blocked
        sets = walls[:, own, own], _within(walls, m) > 0, (part == FREE)[:, own, own], is_open
        return [Views(*view) for view in zip(*map(_bits, sets), strict=True)]


def liars(contradictions: Mapping[tuple[int, int], int]) -> frozenset[int]:
    """Return whom to take out, so that the others agree; each pair of robots with its number of cells.

    Who contradicts the most others explains the most, and goes first: if at least two of these contradict
    fewer than it does. Of two nobody goes, for either may be right.
    """
    left, gone = dict(contradictions), set[int]()
    while left:
        against: dict[int, list[int]] = defaultdict(list)
        for (a, b), cells in left.items():
            against[a].append(cells)
            against[b].append(cells)
        ranks = {robot: (len(cells), sum(cells), -robot) for robot, cells in against.items()}
        worst = max(ranks, key=ranks.__getitem__)
        accusers = [a if b == worst else b for a, b in left if worst in (a, b)]
        if sum(len(against[other]) < len(accusers) for other in accusers) < 2:
            break
        gone.add(worst)
        left = {pair: cells for pair, cells in left.items() if worst not in pair}
    return frozenset(gone)


def _counts(a: Times | None, b: Times | None, now: int) -> bool:
    """Tell whether two contributors hold to what they say of a tile, and said it at the same time."""
    if a is None or b is None or now - max(a.since, b.since) < STANDS:
        return False
    return a.since <= b.changed + APART and b.since <= a.changed + APART


def _within(masks: NDArray[np.bool_], m: int) -> NDArray[np.int32]:
    """Return how many cells of the square of ``2 m + 1`` around each are in a mask; without its rim of m."""
    side = 2 * m + 1
    padded = np.pad(masks, ((0, 0), (1, 0), (1, 0)))
    sums = padded.cumsum(axis=1, dtype=np.int32).cumsum(axis=2, dtype=np.int32)
    rows = sums[:, side:] - sums[:, :-side]
    counts: NDArray[np.int32] = rows[:, :, side:] - rows[:, :, :-side]
    return counts


def _bits(masks: NDArray[np.bool_]) -> list[int]:
    packed = np.packbits(masks.reshape(len(masks), CELLS), axis=1)
    return [int.from_bytes(row.tobytes(), "big") for row in packed]

"""The impact of a mapping strategy: what it shows, and what it costs.

What it shows are quantised log-misses per planning cell and time layer, sparse; what it costs is one integer.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from vedette.kernels.coverage import LAYERS
from vedette.kernels.misses import CERTAIN, STEPS_PER_NAT, Keys, Misses, MissesCodec, SparseMisses
from vedette.maps import GridFrame
from vedette.maps.swept import most_cells_swept
from vedette.number import many
from vedette.team import Most

# Shares are rounded to eighths: neighbouring cells then mostly agree, and messages are short.
_LEVELS = np.array([round(-np.log1p(-k / 8) * STEPS_PER_NAT) for k in range(8)] + [64], np.uint8)
MIN_SHARE = 1 / 16  # a smaller share rounds to nothing
_EVEN_ODDS = 11  # log-misses from which a cell is more likely seen than missed
PRICE_STEPS = 1 << 16  # of a price, to the unit of the objective
_PRICE_BYTES = 7  # of a price that travels
_PRICED = 1 << 7  # in an encoding's fourth byte, the highest of the number of runs: a price comes last


@dataclass(frozen=True, eq=False)
class MapImpact(SparseMisses):
    """What strategies show, and what they cost together: ``*`` multiplies misses and adds prices."""

    price: int = 0  # in steps of 1/65536 of the objective's unit, never below 0

    def __eq__(self, other: object) -> bool:
        return isinstance(other, MapImpact) and self.price == other.price and super().__eq__(other)

    def __hash__(self) -> int:
        return hash((super().__hash__(), self.price))


Impact: TypeAlias = MapImpact
NOTHING = Impact(np.empty(0, np.uint32), np.empty(0, np.uint8))


def quantise(share: NDArray[np.float32]) -> Misses:
    """Round probabilities of being seen to the nearest log-miss level, halves up, once."""
    eighths = np.floor(np.clip(share, 0, 1) * 8 + 0.5).astype(np.intp)
    misses: Misses = _LEVELS[eighths]
    return misses


def final_miss(impact: Impact, size: int) -> NDArray[np.float32]:
    """Miss probability of every planning cell after the last layer, shape (size,)."""
    missed = np.ones(size, np.float32)
    cells, those = cells_missed(impact)
    missed[cells] = those
    return missed


def cells_missed(impact: Impact) -> tuple[NDArray[np.uint32], NDArray[np.float32]]:
    """Return the planning cells that are looked at, increasing, and how likely each is missed in the end."""
    cell = impact.keys // np.uint32(LAYERS)
    first = np.flatnonzero(np.diff(cell, prepend=np.uint32(2**32 - 1)))
    total = np.add.reduceat(impact.misses, first, dtype=np.float64) if len(first) else np.empty(0)
    return cell[first], np.where(total >= CERTAIN, 0.0, np.exp(-total / STEPS_PER_NAT)).astype(np.float32)


def on_map(impact: Impact, worlds: int) -> Impact:
    """Return an impact over planning cells in so many worlds as one over planning cells: its mean in them.

    A cell that is seen in some of the worlds only is seen as likely as there are such; rounded to log-misses.
    """
    if worlds == 1 or not len(impact.keys):
        return impact
    keys, misses = impact.keys.astype(np.int64), impact.misses.astype(np.float64)
    cell, layer = np.divmod(keys, LAYERS)
    cells, owner = np.unique(cell // worlds, return_inverse=True)
    added = np.zeros((len(cells), worlds, LAYERS))
    added[owner, cell % worlds, layer] = misses
    missed = np.exp(-np.minimum(np.cumsum(added, axis=2), CERTAIN) / STEPS_PER_NAT).mean(axis=1)
    levels = np.rint(np.minimum(-np.log(missed) * STEPS_PER_NAT, CERTAIN))
    steps = np.diff(levels, axis=1, prepend=0.0)
    row, layer = np.nonzero(steps)
    mean = (cells[row] * LAYERS + layer).astype(np.uint32), steps[row, layer].astype(np.uint8)
    return Impact(*mean, impact.price)


def moved(impact: Impact, planning: GridFrame, onto: GridFrame) -> Impact:
    """Return an impact over planning cells as one over those of another grid, without what lies outside."""
    if planning == onto:
        return impact
    cells, layers = np.divmod(impact.keys, np.uint32(LAYERS))
    x, y = planning.centres(cells).T
    col = np.floor((x - onto.origin_x) / onto.resolution).astype(np.int64)
    row = np.floor((y - onto.origin_y) / onto.resolution).astype(np.int64)
    inside = (row >= 0) & (row < onto.rows) & (col >= 0) & (col < onto.cols)
    keys = ((row * onto.cols + col) * LAYERS + layers)[inside].astype(np.uint32)
    return Impact(keys, impact.misses[inside], impact.price)


def promised(
    impact: Impact, edges: NDArray[np.float64], worlds: int = 1
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Return the planning cells that are more likely seen than missed in all worlds, and by when [s].

    That is by the end of the first layer by which it is so, ``edges`` (LAYERS,).
    """
    cells, layers = np.divmod(impact.keys.astype(np.int64), LAYERS)
    sums = np.cumsum(impact.misses, dtype=np.int64)
    first = _first_of_each(cells)
    before = np.repeat((sums - impact.misses)[first], np.diff(np.append(np.flatnonzero(first), len(cells))))
    likely = sums - before >= _EVEN_ODDS
    cells, layers = cells[likely], layers[likely]
    soonest = _first_of_each(cells)
    cells, layers = cells[soonest] // worlds, layers[soonest]
    bounds = np.flatnonzero(_first_of_each(cells))
    in_all = np.diff(np.append(bounds, len(cells))) == worlds
    last = np.maximum.reduceat(layers, bounds) if len(bounds) else layers
    return cells[bounds[in_all]], edges[last[in_all]]


def _first_of_each(cells: NDArray[np.int64] | NDArray[np.uint32]) -> NDArray[np.bool_]:
    """Tell which entries, in order of their cells, are the first of their cell."""
    first = np.ones(len(cells), np.bool_)
    first[1:] = cells[1:] != cells[:-1]
    return first


def discounted(impact: Impact, halvings: int) -> Impact:
    """Return an impact that shows each cell with so many times half its chance, at its price."""
    return Impact(*less_likely(impact, halvings), impact.price)


def less_likely(looks: SparseMisses, halvings: int) -> tuple[Keys, Misses]:
    """Return ``1 - (1 - m) / 2**halvings`` for each miss probability m, rounded to log-misses."""
    seen = 1.0 - np.exp(-np.arange(CERTAIN + 1) / STEPS_PER_NAT)
    seen[CERTAIN] = 1.0
    less = np.round(-np.log1p(-seen / 2**halvings) * STEPS_PER_NAT).astype(np.uint8)[looks.misses]
    return looks.keys[less > 0], less[less > 0]


def check_claim(
    impact: SparseMisses,
    robots: int,
    most: Most,
    stops: int,
    side: float,
    edges: NDArray[np.float64],
    worlds: int = 1,
) -> None:
    """Raise ``ValueError`` for what so many robots cannot see, wherever they are and whatever the map.

    By the edge t of a layer a robot has seen what comes within its range on a way of ``speed t``, and at most
    one disc a stop. A stop counts a planning cell once, at most as surely as a share of 1 does.

    Args:
        impact: of so many robots, combined.
        robots: how many.
        most: the team's limits.
        stops: in a tour, at most.
        side: of a planning cell [m].
        edges: (LAYERS,) upper edge of each layer [s]; the last takes all later arrivals.
        worlds: in each of which a cell is one.
    """
    discs = worlds * stops * most_cells_swept(most.range, 0.0, side)
    seen = np.minimum(worlds * most_cells_swept(most.range, most.speed * edges, side), discs)
    seen[-1] = discs
    if len(impact.keys) > robots * seen.min():  # else there are not as many cells as are allowed by any edge
        claimed = _cells_claimed(impact)
        if np.any(claimed > robots * seen):
            late = int(np.argmax(claimed > robots * seen))
            limit = f"{many(robots, 'robot')} with {seen[late]:.0f} at most each"
            raise ValueError(f"impact claims {claimed[late]} cells by {edges[late]:g} s; {limit}")
    if impact.misses.sum(dtype=np.int64) > robots * discs * int(_LEVELS[-1]):
        raise ValueError(f"impact claims to see more surely than {many(robots, 'robot')} can")


def _cells_claimed(impact: SparseMisses) -> NDArray[np.int64]:
    """Return how many planning cells are looked at by the end of each layer, (LAYERS,)."""
    earliest = _first_of_each(impact.keys // np.uint32(LAYERS))
    cells: NDArray[np.int64] = np.bincount(impact.keys[earliest] % np.uint32(LAYERS), minlength=LAYERS)
    return np.cumsum(cells)


class MapImpactCodec:
    """Impacts over so many planning cells as bytes, layer by layer, then the price if there is one."""

    def __init__(self, cells: int) -> None:
        """Take the planning grid's size."""
        self._looks = MissesCodec(cells, LAYERS)

    @property
    def bound(self) -> int:
        """Largest encoding of any impact [bytes]; no team size in it."""
        return self._looks.bound + _PRICE_BYTES

    def encode(self, impact: Impact) -> bytes:
        """Return at most ``bound`` bytes."""
        data = self._looks.encode(impact)
        if not impact.price:
            return data
        head, rest = data[:3] + bytes((data[3] | _PRICED,)), data[4:]
        return head + rest + impact.price.to_bytes(_PRICE_BYTES, "little")

    def decode(self, payload: bytes) -> Impact:
        """Return the impact.

        Raises:
            ValueError: the payload is not an impact over these cells.
        """
        price = 0
        if len(payload) > 3 + _PRICE_BYTES and payload[3] & _PRICED:
            price = int.from_bytes(payload[-_PRICE_BYTES:], "little")
            payload = payload[:3] + bytes((payload[3] ^ _PRICED,)) + payload[4:-_PRICE_BYTES]
            if not price:
                raise ValueError("impact has a price of nothing")
        looks = self._looks.decode(payload)
        if isinstance(looks, MapImpact) and looks.price == price:  # it was written in this process
            return looks
        return Impact(*looks.sparse, price)

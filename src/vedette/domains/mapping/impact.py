"""The impact of a mapping strategy: quantised log-misses per planning cell and time layer, sparse."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from vedette.kernels.coverage import LAYERS
from vedette.kernels.misses import CERTAIN, STEPS_PER_NAT, Misses, MissesCodec, SparseMisses
from vedette.maps import GridFrame
from vedette.maps.swept import most_cells_swept
from vedette.number import many
from vedette.team import Most

# Shares are rounded to eighths: neighbouring cells then mostly agree, and messages are short.
_LEVELS = np.array([round(-np.log1p(-k / 8) * STEPS_PER_NAT) for k in range(8)] + [64], np.uint8)
MIN_SHARE = 1 / 16  # a smaller share rounds to nothing
_EVEN_ODDS = 11  # log-misses from which a cell is more likely seen than missed


Impact: TypeAlias = SparseMisses
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
    return Impact(keys, impact.misses[inside])


def promised(impact: Impact, edges: NDArray[np.float64]) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Return the planning cells that are more likely seen than missed, and by when [s].

    That is by the end of the first layer by which it is so, ``edges`` (LAYERS,).
    """
    cells, layers = np.divmod(impact.keys.astype(np.int64), LAYERS)
    sums = np.cumsum(impact.misses, dtype=np.int64)
    first = _first_of_each(cells)
    before = np.repeat((sums - impact.misses)[first], np.diff(np.append(np.flatnonzero(first), len(cells))))
    likely = sums - before >= _EVEN_ODDS
    cells, layers = cells[likely], layers[likely]
    soonest = _first_of_each(cells)
    return cells[soonest], edges[layers[soonest]]


def _first_of_each(cells: NDArray[np.int64] | NDArray[np.uint32]) -> NDArray[np.bool_]:
    """Tell which entries, in order of their cells, are the first of their cell."""
    first = np.ones(len(cells), np.bool_)
    first[1:] = cells[1:] != cells[:-1]
    return first


def discounted(impact: Impact, halvings: int) -> Impact:
    """Return ``1 - (1 - m) / 2**halvings`` for each miss probability m, rounded to log-misses."""
    seen = 1.0 - np.exp(-np.arange(CERTAIN + 1) / STEPS_PER_NAT)
    seen[CERTAIN] = 1.0
    less = np.round(-np.log1p(-seen / 2**halvings) * STEPS_PER_NAT).astype(np.uint8)[impact.misses]
    return Impact(impact.keys[less > 0], less[less > 0])


def check_claim(
    impact: Impact, robots: int, most: Most, stops: int, side: float, edges: NDArray[np.float64]
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
    """
    discs = stops * most_cells_swept(most.range, 0.0, side)
    seen = np.minimum(most_cells_swept(most.range, most.speed * edges, side), discs)
    seen[-1] = discs
    if len(impact.keys) > robots * seen.min():  # else there are not as many cells as are allowed by any edge
        claimed = _cells_claimed(impact)
        if np.any(claimed > robots * seen):
            late = int(np.argmax(claimed > robots * seen))
            limit = f"{many(robots, 'robot')} with {seen[late]:.0f} at most each"
            raise ValueError(f"impact claims {claimed[late]} cells by {edges[late]:g} s; {limit}")
    if impact.misses.sum(dtype=np.int64) > robots * discs * int(_LEVELS[-1]):
        raise ValueError(f"impact claims to see more surely than {many(robots, 'robot')} can")


def _cells_claimed(impact: Impact) -> NDArray[np.int64]:
    """Return how many planning cells are looked at by the end of each layer, (LAYERS,)."""
    earliest = _first_of_each(impact.keys // np.uint32(LAYERS))
    cells: NDArray[np.int64] = np.bincount(impact.keys[earliest] % np.uint32(LAYERS), minlength=LAYERS)
    return np.cumsum(cells)


class MapImpactCodec(MissesCodec):
    """Impacts over so many planning cells as bytes, layer by layer."""

    def __init__(self, cells: int) -> None:
        super().__init__(cells, LAYERS)

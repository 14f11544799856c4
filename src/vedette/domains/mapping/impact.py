"""The impact of a mapping strategy: quantised log-misses per planning cell and time layer, sparse."""

from __future__ import annotations

import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from vedette.kernels.coverage import LAYERS
from vedette.kernels.misses import CERTAIN, STEPS_PER_NAT, Misses, SparseMisses
from vedette.maps.swept import most_cells_swept
from vedette.team import PlatformSpec

# Shares are rounded to eighths: neighbouring cells then mostly agree, and messages deflate well.
_LEVELS = np.array([round(-np.log1p(-k / 8) * STEPS_PER_NAT) for k in range(8)] + [64], np.uint8)
MIN_SHARE = 1 / 16  # a smaller share rounds to nothing


Impact: TypeAlias = SparseMisses
NOTHING = Impact(np.empty(0, np.uint32), np.empty(0, np.uint8))


def quantise(share: NDArray[np.float32]) -> Misses:
    """Round probabilities of being seen to the nearest log-miss level, halves up, once."""
    eighths = np.floor(np.clip(share, 0, 1) * 8 + 0.5).astype(np.intp)
    misses: Misses = _LEVELS[eighths]
    return misses


def final_miss(impact: Impact, size: int) -> NDArray[np.float32]:
    """Miss probability of every planning cell after the last layer, shape (size,)."""
    total = np.bincount(impact.keys // LAYERS, impact.misses, minlength=size)
    return np.where(total >= CERTAIN, 0.0, np.exp(-total / STEPS_PER_NAT)).astype(np.float32)


@dataclass(frozen=True)
class Most:
    """What no robot of the team exceeds."""

    range: float  # of the lidar [m]
    speed: float  # [m/s]

    @classmethod
    def of(cls, specs: Sequence[PlatformSpec]) -> Most:
        """Return the limits of a team; uncertain poses blur footprints over the lidar's range."""
        reaches = [spec.range + 4.0 * spec.pose_std for spec in specs]
        return cls(max(reaches), max(spec.speed for spec in specs))


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
    cell = impact.keys // np.uint32(LAYERS)
    earliest = np.ones(len(cell), np.bool_)  # of each cell's layers
    earliest[1:] = cell[1:] != cell[:-1]
    claimed = np.cumsum(np.bincount(impact.keys[earliest] % np.uint32(LAYERS), minlength=LAYERS))
    discs = stops * most_cells_swept(most.range, 0.0, side)
    seen = np.minimum(most_cells_swept(most.range, most.speed * edges, side), discs)
    seen[-1] = discs
    if np.any(claimed > robots * seen):
        late = int(np.argmax(claimed > robots * seen))
        limit = f"{robots} robots see {seen[late]:.0f} each"
        raise ValueError(f"impact claims {claimed[late]} cells by {edges[late]:g} s; {limit}")
    if impact.misses.sum(dtype=np.int64) > robots * discs * int(_LEVELS[-1]):
        raise ValueError(f"impact claims to see more surely than {robots} robots can")


class ImpactCodec:
    """Impacts as bytes: planning cells by gaps, layers and log-misses apart, deflated."""

    def __init__(self, cells: int) -> None:
        self._cells = cells

    def encode(self, impact: Impact) -> bytes:
        """Return at most ``bound`` bytes for any impact over this many planning cells."""
        layer = (impact.keys % LAYERS).astype(np.uint8)  # bytes: sorted by radix
        order = np.argsort(layer, kind="stable")
        cell = (impact.keys // LAYERS).astype(np.int64)[order]
        counts = np.bincount(layer, minlength=LAYERS).astype("<u4")
        gap = np.diff(cell, prepend=0)
        gap[np.cumsum(counts)[:-1][counts[1:] > 0]] = cell[np.cumsum(counts)[:-1][counts[1:] > 0]]
        small = np.minimum(gap, 255).astype(np.uint8)
        large = gap[gap >= 255].astype("<u4")
        body = b"".join((counts.tobytes(), small.tobytes(), impact.misses[order].tobytes(), large.tobytes()))
        return zlib.compress(body, 4, wbits=-15)  # a twentieth more than the default level, in half the time

    def decode(self, payload: bytes) -> Impact:
        """Return the impact.

        Raises:
            ValueError: the payload is not an impact over this many planning cells.
        """
        try:
            unpacker = zlib.decompressobj(wbits=-15)
            body = unpacker.decompress(payload, self._largest_body + 1)
        except zlib.error as error:
            raise ValueError(f"impact does not inflate: {error}") from None
        if not unpacker.eof or unpacker.unused_data or len(body) < 4 * LAYERS:
            raise ValueError("impact is cut short or too large")
        counts = np.frombuffer(body, "<u4", LAYERS).astype(np.int64)
        total = int(counts.sum())
        if len(body) < 4 * LAYERS + 2 * total:
            raise ValueError("impact has fewer entries than it declares")
        small = np.frombuffer(body, np.uint8, total, 4 * LAYERS)
        misses = np.frombuffer(body, np.uint8, total, 4 * LAYERS + total)
        large = body[4 * LAYERS + 2 * total :]
        wide = small == 255
        if len(large) != 4 * int(np.count_nonzero(wide)):
            raise ValueError("impact has the wrong number of wide gaps")
        gap = small.astype(np.int64)
        gap[wide] = np.frombuffer(large, "<u4")
        cell = np.cumsum(gap)
        firsts = (np.cumsum(counts) - counts)[counts > 0]
        before = np.where(firsts > 0, cell[firsts - 1], 0)
        cell -= np.repeat(before, counts[counts > 0])
        if total and (cell.min() < 0 or cell.max() >= self._cells or misses.min() == 0):
            raise ValueError("impact has a cell outside the map or an empty entry")
        keys = cell * LAYERS + np.repeat(np.arange(LAYERS), counts)
        order = np.argsort(keys, kind="stable")
        keys = keys[order]
        if np.any(np.diff(keys) <= 0):
            raise ValueError("impact has the same cell and layer twice")
        return Impact(keys.astype(np.uint32), misses[order])

    @property
    def bound(self) -> int:
        """Largest encoding of any impact over this many planning cells [bytes]; no team size in it."""
        return self._largest_body + 5 * (self._largest_body // 16383 + 1) + 64  # deflate at its worst

    @property
    def _largest_body(self) -> int:
        """Counts, two bytes an entry, four more a wide gap: a layer's gaps sum to less than the cells."""
        return 4 * LAYERS + LAYERS * (2 * self._cells + 4 * (self._cells // 255))

"""One writer's tiles at one version, and exact differences between versions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from vedette.fusion.tiles import CELLS, CLASSES, Tiling, codes_of

ValueT = TypeVar("ValueT", np.uint8, np.int32)  # of a cell

NONE: NDArray[np.int64] = np.empty(0, dtype=np.int64)  # no tiles
_LAST_STAMP = np.iinfo(np.uint16).max


@dataclass(frozen=True, eq=False)
class Delta(Generic[ValueT]):
    """What turns a snapshot of any version in ``[base, version)`` into the snapshot ``version``."""

    base: int
    version: int
    tiles: NDArray[np.int64]  # (T,) increasing tile ids
    mask: NDArray[np.bool_]  # (T, 1024) cells that are given
    values: NDArray[ValueT]  # (mask.sum(),) their values, in the order of the mask
    counts: NDArray[np.int64] | None = None  # (K,), when they are given

    @property
    def size(self) -> int:
        """Bytes, about: half of one a cell."""
        return len(self.tiles) * CELLS // 2


@dataclass(frozen=True, eq=False)
class Change(Generic[ValueT]):
    """Tiles that a snapshot has just replaced."""

    tiles: NDArray[np.int64]  # (T,)
    before: NDArray[ValueT]  # (T, 1024)
    after: NDArray[ValueT]  # (T, 1024)
    more_counts: NDArray[np.int64]  # (K,) new minus old


class Snapshot(Generic[ValueT]):
    """One writer's cell values and counts as of one ``version``; 0 is blank.

    Every holder's copy equals the writer's own at that version: a difference is applied whole or not at
    all, so "the later version wins" merges copies, and merging is idempotent and commutative. Each cell
    remembers the version that last changed it (from 65535 versions on, that it changed late: differences
    then repeat some cells). Memory: 3 or 6 bytes a cell, allocated by the system as tiles fill.
    """

    def __init__(self, tile_count: int, counts_size: int, dtype: type[ValueT]) -> None:
        self.version = 0
        self.values: NDArray[ValueT] = np.zeros((tile_count, CELLS), dtype=dtype)
        self.counts: NDArray[np.int64] = np.zeros(counts_size, dtype=np.int64)
        self._stamps: NDArray[np.uint16] = np.zeros((tile_count, CELLS), dtype=np.uint16)
        self._versions: NDArray[np.int64] = np.zeros(tile_count, dtype=np.int64)
        self._counts_version = 0

    @property
    def known_tiles(self) -> NDArray[np.int64]:
        """Tiles ever written, increasing."""
        return np.flatnonzero(self._versions)

    def write(
        self, tiles: NDArray[np.int64], blocks: NDArray[ValueT], counts: NDArray[np.int64] | None = None
    ) -> Change[ValueT] | None:
        """As the writer: set ``(len(tiles), 1024)`` values; a new version if anything differs, else None."""
        mask = blocks != self.values[tiles]
        rows = np.flatnonzero(mask.any(axis=1))
        fresh = counts if counts is not None and not np.array_equal(counts, self.counts) else None
        if len(rows) == 0 and fresh is None:
            return None
        mask = mask[rows]
        delta = Delta(self.version, self.version + 1, tiles[rows], mask, blocks[rows][mask], fresh)
        return self.apply(delta)

    def since(self, base: int) -> Delta[ValueT]:
        """Return the difference from version ``base`` to this one."""
        tiles = np.flatnonzero(self._versions > base)
        mask = self._stamps[tiles] > min(base, _LAST_STAMP - 1)
        counts = self.counts.copy() if self._counts_version > base else None
        return Delta(base, self.version, tiles, mask, self.values[tiles][mask], counts)

    def apply(self, delta: Delta[ValueT]) -> Change[ValueT] | None:
        """Advance to ``delta.version``; None if it is old news or does not connect to this version."""
        if not delta.base <= self.version < delta.version:
            return None
        before = self.values[delta.tiles]
        after = before.copy()
        after[delta.mask] = delta.values
        stamps = self._stamps[delta.tiles]
        stamps[delta.mask] = min(delta.version, _LAST_STAMP)
        self.values[delta.tiles] = after
        self._stamps[delta.tiles] = stamps
        self._versions[delta.tiles] = delta.version
        self.version = delta.version
        return Change(delta.tiles, before, after, self._replace_counts(delta))

    def _replace_counts(self, delta: Delta[ValueT]) -> NDArray[np.int64]:
        if delta.counts is None:
            return np.zeros_like(self.counts)
        more = delta.counts - self.counts
        self.counts = delta.counts.copy()
        self._counts_version = delta.version
        return more


def tiles_to_publish(
    tiling: Tiling, own: NDArray[np.int8], changed: NDArray[np.int64] | None, published: Snapshot[np.uint8]
) -> NDArray[np.int64]:
    """Return the tiles that hold ``changed`` cells, or (None) all whose class differs from the published."""
    if own.shape != (tiling.rows, tiling.cols):
        raise ValueError(f"own evidence has shape {own.shape}; the team map has {(tiling.rows, tiling.cols)}")
    if changed is not None:
        return tiling.holding(changed)
    everywhere = np.arange(tiling.count)
    classes = CLASSES[codes_of(tiling.gather(own, everywhere))]
    return np.flatnonzero((classes != CLASSES[published.values]).any(axis=1))

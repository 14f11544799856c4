"""One writer's tiles at one version, and exact differences between versions."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Generic, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from vedette.fusion.seals import Seal
from vedette.fusion.shared import SharedTiles
from vedette.fusion.tiles import CLASSES, codes_of
from vedette.kernels.tiles import CELLS, TiledGrid, Tiling

ValueT = TypeVar("ValueT", np.uint8, np.int32)  # of a cell

NONE: NDArray[np.int64] = np.empty(0, dtype=np.int64)  # no tiles
_LAST_STAMP = np.iinfo(np.uint16).max


class Voucher(NamedTuple):
    """What goes with signed evidence."""

    times: NDArray[
        np.int64
    ]  # (T, 2) of each tile: since when it is held to, and when it last changed [0.1 s]
    particulars: bytes | None  # what the writer tells beside cells and counts, when it is given
    place: bytes | None  # where the writer is, when it is given
    seal: Seal
    certificate: bytes  # the writer's; empty for who has it


@dataclass(frozen=True, eq=False)
class Delta(Generic[ValueT]):
    """What turns a snapshot of any version in ``[base, version)`` into the snapshot ``version``."""

    base: int
    version: int
    tiles: NDArray[np.int64]  # (T,) increasing tile ids
    mask: NDArray[np.bool_]  # (T, 1024) cells that are given
    values: NDArray[ValueT]  # (mask.sum(),) their values, in the order of the mask
    counts: NDArray[np.int64] | None = None  # (K,), when they are given
    voucher: Voucher | None = None  # where evidence is signed

    @property
    def size(self) -> int:
        """Bytes, about: half of one a cell."""
        return len(self.tiles) * CELLS // 2

    @property
    def seal(self) -> Seal:
        """The writer's word for it, where evidence is signed."""
        assert self.voucher is not None
        return self.voucher.seal

    @property
    def certificate(self) -> bytes:
        """The writer's; empty for who has it."""
        assert self.voucher is not None
        return self.voucher.certificate

    def certified(self, certificate: bytes) -> Delta[ValueT]:
        """Return the same with a certificate."""
        assert self.voucher is not None
        return replace(self, voucher=self.voucher._replace(certificate=certificate))


@dataclass(frozen=True, eq=False)
class Change:
    """What a snapshot has just replaced."""

    tiles: NDArray[np.int64]  # (T,)
    more_counts: NDArray[np.int64]  # (K,) new minus old


class Snapshot(Generic[ValueT]):
    """One writer's cell values and counts as of one ``version``; 0 is blank.

    Every holder's copy equals the writer's own at that version: a difference is applied whole or not at
    all, so "the later version wins" merges copies, and merging is idempotent and commutative. Each cell
    remembers the version that last changed it (from 65535 versions on, that it changed late: differences
    then repeat some cells). A difference from version 0 is the whole: what it does not give is blank.
    Memory: 3 or 6 bytes a cell of the tiles ever written, once for all who hold the same.
    """

    def __init__(self, tiling: Tiling, counts_size: int, dtype: type[ValueT]) -> None:
        self.version = 0
        self._whole_before = 0  # differences from earlier versions are told whole
        self.tiling = tiling
        self.values: SharedTiles[ValueT] = SharedTiles(dtype)
        self.counts: NDArray[np.int64] = np.zeros(counts_size, dtype=np.int64)
        self._stamps: SharedTiles[np.uint16] = SharedTiles(np.uint16)
        self._versions: dict[int, int] = {}  # of each tile
        self._counts_version = 0

    @property
    def known_tiles(self) -> NDArray[np.int64]:
        """Tiles ever written, increasing."""
        return self.values.held

    def write(
        self, tiles: NDArray[np.int64], blocks: NDArray[ValueT], counts: NDArray[np.int64] | None = None
    ) -> Change | None:
        """As the writer: set ``(len(tiles), 1024)`` values; a new version if anything differs, else None."""
        delta = self._changed(tiles, blocks, counts)
        return None if delta is None else self.apply(delta)

    def _changed(
        self, tiles: NDArray[np.int64], blocks: NDArray[ValueT], counts: NDArray[np.int64] | None
    ) -> Delta[ValueT] | None:
        mask = blocks != self.values.read(tiles)
        rows = np.flatnonzero(mask.any(axis=1))
        fresh = counts if counts is not None and not np.array_equal(counts, self.counts) else None
        if len(rows) == 0 and fresh is None:
            return None
        mask = mask[rows]
        return Delta(self.version, self.version + 1, tiles[rows], mask, blocks[rows][mask], fresh)

    def since(self, base: int) -> Delta[ValueT]:
        """Return the difference from version ``base`` to this one."""
        base = base if base >= self._whole_before else 0
        late = [tile for tile, version in self._versions.items() if version > base]
        tiles = np.sort(np.array(late, np.int64))
        mask = self._stamps.read(tiles) > self._stamp(base, _LAST_STAMP - 1)
        counts = self.counts.copy() if self._counts_version > base else None
        return Delta(base, self.version, tiles, mask, self.values.read(tiles)[mask], counts)

    def apply(self, delta: Delta[ValueT]) -> Change | None:
        """Advance to ``delta.version``; None if it is old news or does not connect to this version."""
        if not delta.base <= self.version < delta.version:
            return None
        delta, values = self._after(delta)
        stamps = self._stamps.read(delta.tiles)
        stamps[delta.mask] = self._stamp(delta.version, _LAST_STAMP)
        self.values.write(delta.tiles, values)
        self._stamps.write(delta.tiles, stamps)
        self._versions |= dict.fromkeys(delta.tiles.tolist(), delta.version)
        self.version = delta.version
        return Change(delta.tiles, self._replace_counts(delta))

    def overtake(self, version: int) -> None:
        """As the writer: go on above a version that was told in its name, and tell the whole anew."""
        self.version = self._whole_before = self._counts_version = version + 1
        tiles = self.known_tiles
        self._versions = dict.fromkeys(self._versions, self.version)
        self._stamps.write(tiles, np.minimum(self._stamps.read(tiles), 1))

    def _stamp(self, version: int, most: int) -> int:
        """Return a version as cells remember it, at most ``most``."""
        return min(max(version - max(self._whole_before - 1, 0), 0), most)

    def _after(self, delta: Delta[ValueT]) -> tuple[Delta[ValueT], NDArray[ValueT]]:
        """Return a difference that connects, all it blanks included, and ``(T, 1024)`` its tiles after it."""
        if delta.base == 0 < self.version:
            delta = self._blanking(delta)
        values = self.values.read(delta.tiles)
        values[delta.mask] = delta.values
        return delta, values

    def _blanking(self, delta: Delta[ValueT]) -> Delta[ValueT]:
        """Return the whole, with all cells given that are blank in it but are not so here."""
        tiles = np.union1d(self.known_tiles, delta.tiles)
        rows = np.searchsorted(tiles, delta.tiles)
        before = self.values.read(tiles)
        mask, values = before != 0, np.zeros_like(before)
        given = np.zeros(mask.shape, np.bool_)
        given[rows] = delta.mask
        values[given] = delta.values
        mask |= given
        return Delta(0, delta.version, tiles, mask, values[mask], delta.counts, delta.voucher)

    def _replace_counts(self, delta: Delta[ValueT]) -> NDArray[np.int64]:
        if delta.counts is None:
            return np.zeros_like(self.counts)
        more = delta.counts - self.counts
        self.counts = delta.counts.copy()
        self._counts_version = delta.version
        return more


def tiles_to_publish(
    own: TiledGrid[np.int8], changed: NDArray[np.int64] | None, published: Snapshot[np.uint8]
) -> NDArray[np.int64]:
    """Return the tiles that hold ``changed`` cells, or (None) all whose class differs from the published."""
    if own.tiling != published.tiling:
        raise ValueError(f"own evidence lies on {own.tiling}; the team map on {published.tiling}")
    if changed is not None:
        return own.tiling.holding(changed)
    held = np.union1d(own.held, published.values.held)
    classes = CLASSES[codes_of(own.read(held))]
    differs: NDArray[np.int64] = held[(classes != CLASSES[published.values.read(held)]).any(axis=1)]
    return differs

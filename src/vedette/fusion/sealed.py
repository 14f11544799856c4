"""A snapshot that its writer signs: every holder can tell that it is the writer's, whoever passed it on."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vedette.fusion.merkle import Merkle, Nodes
from vedette.fusion.seals import Seal
from vedette.fusion.snapshots import Change, Delta, Snapshot, Voucher
from vedette.fusion.tiles import CLASSES
from vedette.fusion.trust import FREE, Times
from vedette.kernels.tiles import Tiling

CORRECTED = 8  # cells of a tile whose firm evidence is taken back at once: the writer corrects itself


class SealedSnapshot(Snapshot[np.uint8]):
    """A snapshot whose tiles, counts, particulars and place are leaves of a Merkle tree; the root is signed.

    So whoever holds a version can check a difference to a later one by one signature, and pass it on.
    """

    def __init__(self, tiling: Tiling, counts_size: int) -> None:
        super().__init__(tiling, counts_size, np.uint8)
        self.seal = Seal(0, b"")  # for the version that is held
        self.root = b""
        self.times: dict[int, Times] = {}  # of each tile
        self.particulars = b""
        self._particulars_version = 0
        self.place = b""
        self._place_version = 0
        self._tree = Merkle(tiling.count + 3)
        self._tried: tuple[Delta[np.uint8], bytes, Nodes] | None = None

    def put_seal(self, seal: Seal) -> None:
        """As the writer: sign the version that is held."""
        self.seal = seal

    def put(
        self,
        tiles: NDArray[np.int64],
        blocks: NDArray[np.uint8],
        counts: NDArray[np.int64] | None,
        particulars: bytes,
        place: bytes,
        now: int,
        restates: bool = False,
    ) -> Change | None:
        """As the writer: ``write``, at a time [0.1 s], with what it tells beside cells and counts.

        ``restates``: a new version even if there is nothing new but the time and the place.
        """
        delta = self._changed(tiles, blocks, counts)
        told = particulars if particulars != self.particulars else None
        if delta is None and told is None and not restates:
            return None
        if delta is None:
            delta = Delta(self.version, self.version + 1, tiles[:0], blocks[:0] > 0, blocks[:0, 0])
        at = place if place != self.place else None
        times = np.stack((self._since(delta, now), np.full(len(delta.tiles), now)), axis=1)
        return self.apply(replace(delta, voucher=Voucher(times, told, at, Seal(now, b""), b"")))

    def _since(self, delta: Delta[np.uint8], now: int) -> NDArray[np.int64]:
        """Return ``(T,)`` from when on the writer has held to what it firmly says of each tile [0.1 s]."""
        before = self.values.read(delta.tiles)
        after = before.copy()
        after[delta.mask] = delta.values
        back = ((before >= FREE) & (CLASSES[before] != CLASSES[after])).sum(axis=1)
        earlier = [self.times.get(tile, Times(now, now)).since for tile in delta.tiles.tolist()]
        return np.where(back >= CORRECTED, now, np.array(earlier, np.int64))

    def root_after(self, delta: Delta[np.uint8]) -> bytes:
        """Return the root that there would be after a difference that connects; nothing changes."""
        assert delta.voucher is not None
        after, values = self._after(delta)
        times = dict(zip(delta.tiles.tolist(), delta.voucher.times.astype("<i8"), strict=True))
        leaves = {
            tile: block.tobytes() + times[tile].tobytes() if block.any() else b""
            for tile, block in zip(after.tiles.tolist(), values, strict=True)
        }
        if delta.counts is not None:
            leaves[self.tiling.count] = delta.counts.astype("<i8").tobytes() if delta.counts.any() else b""
        if delta.voucher.particulars is not None:
            leaves[self.tiling.count + 1] = delta.voucher.particulars
        if delta.voucher.place is not None:
            leaves[self.tiling.count + 2] = delta.voucher.place
        root, nodes = self._tree.with_leaves(leaves)
        self._tried = delta, root, nodes
        return root

    def apply(self, delta: Delta[np.uint8]) -> Change | None:
        """Advance to ``delta.version``, signed or not; None if it is old news or does not connect."""
        if not delta.base <= self.version < delta.version:
            return None
        voucher = delta.voucher
        assert voucher is not None
        if self._tried is None or self._tried[0] is not delta:
            self.root_after(delta)
        assert self._tried is not None
        _, self.root, nodes = self._tried
        self._tried = None
        change = super().apply(delta)
        self._tree.put(nodes)
        self.seal = voucher.seal
        told = zip(delta.tiles.tolist(), voucher.times.tolist(), strict=True)
        self.times |= {tile: Times(*times) for tile, times in told}
        if voucher.particulars is not None:
            self.particulars, self._particulars_version = voucher.particulars, delta.version
        if voucher.place is not None:
            self.place, self._place_version = voucher.place, delta.version
        return change

    def since(self, base: int) -> Delta[np.uint8]:
        """Return the difference from version ``base`` to this one, with the writer's word for it."""
        delta = super().since(base)
        times = np.array([self.times[tile] for tile in delta.tiles.tolist()], np.int64).reshape(-1, 2)
        told = self.particulars if self._particulars_version > base else None
        at = self.place if self._place_version > base else None
        return replace(delta, voucher=Voucher(times, told, at, self.seal, b""))

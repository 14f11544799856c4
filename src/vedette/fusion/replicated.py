"""Replicated evidence: everybody's own evidence, kept apart by contributor, summed into the team map."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np
from numpy.typing import NDArray

from vedette.fusion.codec import EvidenceCodec
from vedette.fusion.contributors import Contributors
from vedette.fusion.link import RESEND_AFTER, Key
from vedette.fusion.packing import CodePacking
from vedette.fusion.replicated_map import ReplicatedMap
from vedette.fusion.snapshots import NONE, Change, Delta, Snapshot, tiles_to_publish
from vedette.fusion.tiles import WORDS, classes_of, codes_of
from vedette.kernels.tiles import CELLS, TiledGrid, Tiling


class ReplicatedEvidence(ReplicatedMap[Snapshot[np.uint8]]):
    """Team evidence = sum over contributors of the latest known snapshot of each one's own evidence.

    Memory is O(contributors x the area each has seen), 3 bytes a cell, beside a byte a cell for the team;
    of all that robots in one process hold alike, each tile once.
    ``own`` grids are int8 log-odds; times are seconds of any one clock of this robot.
    """

    def __init__(
        self, robot: int, boot: int, shape: tuple[int, int], counts_size: int, *, mark: int = 0
    ) -> None:
        """Start with nothing known; ``boot < 2**38`` must differ from those of the robot's earlier starts."""
        tiling = Tiling(*shape)
        contributors: Contributors[Snapshot[np.uint8], Delta[np.uint8]] = Contributors(
            robot, boot, lambda: Snapshot(tiling, counts_size, np.uint8), RESEND_AFTER
        )
        codec = EvidenceCodec(tiling, counts_size, CodePacking())
        super().__init__(tiling, counts_size, mark, codec, contributors)

    def publish(
        self, own: TiledGrid[np.int8], changed: NDArray[np.int64] | None, counts: NDArray[np.int64] | None
    ) -> NDArray[np.int64]:
        """Share the tiles of ``own`` that hold ``changed`` flat cells (None: find those whose class changed).

        Returns the tiles in which the team map changed.
        """
        published = self._contributors.own
        tiles = tiles_to_publish(own, changed, published)
        change = published.write(tiles, codes_of(own.read(tiles)), counts)
        return self._merge({self._contributors.key: change})

    def _merge(self, changes: Mapping[Key, Change | None]) -> NDArray[np.int64]:
        """Add up anew what has changed, tile by tile."""
        changed = [NONE]
        for change in changes.values():
            if change is not None:
                self.counts += change.more_counts
                changed.append(change.tiles)
        tiles = np.unique(np.concatenate(changed))
        return self.show(tiles, classes_of(summed(self._contributors.copies.values(), tiles)))


def summed(copies: Iterable[Snapshot[np.uint8]], tiles: NDArray[np.int64]) -> NDArray[np.int32]:
    """Return ``(T, 1024)`` packed sums of what some contributors say of tiles."""
    words = np.zeros((len(tiles), CELLS), np.int32)
    for copy in copies:
        held = np.flatnonzero(copy.values.holds(tiles))
        if len(held):
            words[held] += WORDS.take(copy.values.read(tiles[held]))
    return words

"""A team map from copies of everybody's evidence: how the copies are exchanged."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import Any, Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from vedette.fusion.codec import EvidenceCodec
from vedette.fusion.contributors import Contributors
from vedette.fusion.link import Key
from vedette.fusion.snapshots import Change, Delta, Snapshot
from vedette.fusion.tiles import TeamMap
from vedette.kernels.tiles import Tiling

SnapshotT = TypeVar("SnapshotT", bound=Snapshot[Any])


class ReplicatedMap(TeamMap, ABC, Generic[SnapshotT]):
    """The team's map as a function of what everybody has said, each held apart, on any graph."""

    def __init__(
        self,
        tiling: Tiling,
        counts_size: int,
        mark: int,
        codec: EvidenceCodec[np.uint8],
        contributors: Contributors[SnapshotT, Delta[np.uint8]],
    ) -> None:
        """Start with nothing known; ``contributors`` are this robot's, who writes its own."""
        super().__init__(tiling, counts_size, mark)
        self._codec, self._contributors = codec, contributors

    def contributors(self) -> int:
        """Return how many robots' evidence this robot holds; each start of a robot counts."""
        return len(self._contributors.known())

    def set_neighbours(self, neighbours: Sequence[int]) -> None:
        """Exchange with exactly these robots from now on; the graph may have cycles."""
        self._contributors.set_neighbours(neighbours)

    def outgoing(self, neighbour: int, now: float) -> bytes | None:
        """Return what the neighbour lacks, and what it waits to see acknowledged; None if nothing."""
        payload = self._contributors.tell(neighbour, now)
        return None if payload is None else self._codec.encode(payload)

    def receive(self, neighbour: int, payload: bytes, now: float) -> NDArray[np.int64]:
        """Merge a neighbour's payload; returns the tiles in which the team map changed.

        What its contributor has not signed, where evidence is signed, is left out. Raises ValueError, and
        changes nothing, if the payload is malformed.
        """
        news = self._contributors.hear(neighbour, self._codec.decode(payload), now)
        return self._merge({key: self._contributors.copies[key].apply(delta) for key, delta in news})

    @abstractmethod
    def _merge(self, changes: Mapping[Key, Change | None]) -> NDArray[np.int64]:
        """Add up anew what has changed of whose copy; return the tiles in which the team map changed."""

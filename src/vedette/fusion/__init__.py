"""Fusing what the robots know: one interface, two ways (replicated evidence, the paper's channel filter)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from vedette.fusion.channel import ChannelFilter
from vedette.fusion.replicated import ReplicatedEvidence
from vedette.fusion.tiles import FIRM
from vedette.kernels.tiles import SIDE, TiledGrid
from vedette.maps.bounds import Extent

__all__ = ["FIRM", "SIDE", "ChannelFilter", "Fusion", "ReplicatedEvidence", "ShownMap"]


class ShownMap(Protocol):
    """A map of the team, as one robot knows it."""

    @property
    def classes(self) -> TiledGrid[np.uint8]:
        """Of each cell: UNKNOWN, FREE or OCCUPIED."""
        ...

    @property
    def known(self) -> Extent:
        """Rows and columns outside of which the map is unknown."""
        ...

    @property
    def counts(self) -> NDArray[np.int64]:
        """``(counts_size,)`` team sum of everybody's published counts."""
        ...


class Fusion(ShownMap, Protocol):
    """One robot's share in the team's evidence: no I/O and no clock; payloads go between neighbours.

    A robot calls ``publish`` at a steady rate, then ``outgoing`` for each neighbour, and ``receive`` for each
    payload that arrives. Payloads may be lost, repeated or reordered. A new link opens with a greeting either
    way; evidence follows with the next ``outgoing``.
    """

    @property
    def digest(self) -> int:
        """Equal for two robots iff their classes and counts are equal."""
        ...

    def contributors(self) -> int:
        """Return the number of robots with evidence in the team map."""
        ...

    def publish(
        self, own: TiledGrid[np.int8], changed: NDArray[np.int64] | None, counts: NDArray[np.int64] | None
    ) -> NDArray[np.int64]:
        """Share the robot's own log-odds and counts; return the tiles whose team map changed."""
        ...

    def set_neighbours(self, neighbours: Sequence[int]) -> None:
        """Exchange with exactly these robots from now on."""
        ...

    def outgoing(self, neighbour: int, now: float) -> bytes | None:
        """Return the next payload for a neighbour (KeyError if it is none), or None if there is no news."""
        ...

    def receive(self, neighbour: int, payload: bytes, now: float) -> NDArray[np.int64]:
        """Merge a payload (ValueError if malformed); return the tiles whose team map changed."""
        ...

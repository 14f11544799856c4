"""The edges of a tree, over each of which goes one sum either way: for maps and steps alike."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Generic, Protocol, TypeVar

from vedette.fusion.link import Boots, EvidenceLink, NewsT, Payload, check_boot

SESSION_BITS = 24


class Edge(Protocol[NewsT]):
    """One end of a tree edge: the latest sums either way; what crosses it is state, not increments."""

    link: EvidenceLink[NewsT]

    @property
    def heard(self) -> int:
        """Version of the sum that came from the neighbour."""

    @property
    def told(self) -> int:
        """Version of the sum that goes to the neighbour."""


EdgeT = TypeVar("EdgeT", bound=Edge[Any])


class Edges(dict[int, EdgeT], Generic[EdgeT, NewsT]):
    """A robot's edges by neighbour. Every edge that is made is a new session, with a number of its own.

    Absolute sums under a version number: so loss, repetition and reordering do no harm. Robots are anonymous.
    """

    def __init__(self, robot: int, boot: int, resend_after: float) -> None:
        super().__init__()
        check_boot(boot)
        self._robot, self._boot, self._session = robot, boot, 0
        self._boots = Boots()
        self._resend_after = resend_after

    def set_neighbours(
        self,
        neighbours: Sequence[int],
        lose: Callable[[EdgeT], None],
        make: Callable[[EvidenceLink[NewsT]], EdgeT],
    ) -> None:
        """Let the edges to other robots go, then make those that are not there."""
        for edge in [self.pop(n) for n in self.keys() - set(neighbours)]:
            lose(edge)
        for neighbour in neighbours:
            if neighbour not in self:
                self._session += 1
                nonce = (self._boot << SESSION_BITS) + self._session
                self[neighbour] = make(EvidenceLink(self._robot, nonce, self._resend_after))

    def tell(self, neighbour: int, since: Callable[[int], NewsT], now: float) -> Payload[NewsT] | None:
        """Return what the neighbour lacks, and what it waits to see acknowledged; None if nothing."""
        edge = self[neighbour]
        held = {(neighbour, edge.link.peer): edge.heard} if edge.link.peer >= 0 else {}
        return edge.link.tell(held, [(edge.link.key, edge.told, since)], now)

    def hear(self, neighbour: int, payload: Payload[NewsT], now: float) -> tuple[EdgeT, bool] | None:
        """Return the edge over which a payload came, and whether the neighbour has begun it anew.

        None for a payload from a robot that is no neighbour, or from its past. Raises ValueError, and changes
        nothing, if it claims what cannot be.
        """
        keys = [key for key, _ in payload.sections]
        if len(keys) > 1 or any(key != (neighbour, payload.nonce) for key in keys):
            raise ValueError("fusion payload: a section is not the neighbour's own sum")
        edge = self.get(neighbour)
        if edge is None:
            return None
        payload.check(edge.link.key, edge.told)
        boot, peer = payload.nonce >> SESSION_BITS, edge.link.peer
        is_earlier = boot == peer >> SESSION_BITS and payload.nonce < peer
        if self._boots.is_stale(neighbour, boot) or is_earlier:
            return None
        edge.link.hear(payload, now)
        return edge, peer not in (-1, payload.nonce)

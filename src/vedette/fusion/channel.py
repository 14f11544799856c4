"""The paper's way: an additive channel filter for every edge of a tree, in its loss-proof form."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vedette.fusion.codec import EvidenceCodec
from vedette.fusion.edges import Edges
from vedette.fusion.link import RESEND_AFTER, EvidenceLink
from vedette.fusion.packing import WordPacking, join_word, split_word
from vedette.fusion.snapshots import NONE, Delta, Snapshot, tiles_to_publish
from vedette.fusion.tiles import (
    CLASSES,
    WORDS,
    TeamMap,
    classes_of,
    code_of_sums,
    codes_of,
    saturated,
)
from vedette.kernels.tiles import TiledGrid, Tiling


@dataclass(eq=False)
class MapEdge:
    """One end of a tree edge: the latest ``mu`` either way; their sum is the edge's common information."""

    link: EvidenceLink[Delta[np.int32]]
    inbox: Snapshot[np.int32]  # mu_{k->i}: sum over the robots behind the neighbour
    outbox: Snapshot[np.int32]  # mu_{i->k}: sum over the robots on this side

    @property
    def heard(self) -> int:
        """Version of the inbox."""
        return self.inbox.version

    @property
    def told(self) -> int:
        """Version of the outbox."""
        return self.outbox.version


class ChannelFilter(TeamMap):
    """``mu_{i->j} = own_i + sum_{k != j} mu_{k->i}``; team = ``own_i + sum_k mu_{k->i}``, exact on a tree.

    What crosses an edge is state, not increments: absolute sums under a version number, so that loss,
    repetition and reordering do no harm. Robots are anonymous and memory is O(neighbours). The
    neighbours must form a tree: on a cycle everybody's evidence would run round and be counted for ever.

    When an edge goes, what came over it leaves the sum, or it would count twice once those robots re-attach
    elsewhere. It is kept apart as *inherited* codes, merged over the team by maximum (idempotent: it never
    counts twice nor accumulates), and shown only where no living robot has evidence. So a dead robot's map
    survives; its counts do not.
    """

    def __init__(
        self,
        robot: int,
        boot: int,
        shape: tuple[int, int],
        counts_size: int,
        *,
        mark: int = 0,
        resend_after: float = RESEND_AFTER,
    ) -> None:
        """Start with nothing known; ``boot < 2**38`` must differ from those of the robot's earlier starts."""
        super().__init__(Tiling(*shape), counts_size, mark)
        self._size = counts_size + 1  # the last count is 1 for every robot that has published
        self._codec = EvidenceCodec(self._tiling, self._size, WordPacking())
        self._own = Snapshot(self._tiling, self._size, np.uint8)
        self._inherited: TiledGrid[np.uint8] = TiledGrid(self._tiling, np.uint8)
        self._robots = 0
        self._edges: Edges[MapEdge, Delta[np.int32]] = Edges(robot, boot, resend_after)

    def contributors(self) -> int:
        """Return how many robots on the tree have published evidence."""
        return self._robots

    def publish(
        self, own: TiledGrid[np.int8], changed: NDArray[np.int64] | None, counts: NDArray[np.int64] | None
    ) -> NDArray[np.int64]:
        """Share the tiles of ``own`` that hold ``changed`` flat cells (None: find those whose class changed).

        Returns the tiles in which the team map changed.
        """
        tiles = tiles_to_publish(own, changed, self._own)
        counts = self._own.counts[:-1] if counts is None else counts
        change = self._own.write(tiles, codes_of(own.read(tiles)), np.append(counts, 1))
        return NONE if change is None else self._update(change.tiles)

    def set_neighbours(self, neighbours: Sequence[int]) -> None:
        """Take these as the neighbours on the tree; evidence from lost ones is kept as inherited."""
        self._edges.set_neighbours(
            neighbours, self._inherit, lambda link: MapEdge(link, self._box(), self._box())
        )
        self._update(np.sort(self._inherited.held))

    def outgoing(self, neighbour: int, now: float) -> bytes | None:
        """Return what the neighbour lacks, and what it waits to see acknowledged; None if nothing."""
        payload = self._edges.tell(neighbour, self._edges[neighbour].outbox.since, now)
        return None if payload is None else self._codec.encode(payload)

    def receive(self, neighbour: int, payload: bytes, now: float) -> NDArray[np.int64]:
        """Take over a neighbour's sums; returns the tiles in which the team map changed.

        A payload from a robot that is no neighbour, or from its past, is ignored. Raises ValueError, and
        changes nothing, if the payload is malformed.
        """
        message = self._codec.decode(payload)
        heard = self._edges.hear(neighbour, message, now)
        if heard is None:
            return NONE
        edge, anew = heard
        changed = [self._blank(edge)] if anew else [NONE]
        for _, delta in message.sections:
            change = edge.inbox.apply(delta)
            if change is not None:
                changed.append(self._update(change.tiles))
        return np.unique(np.concatenate(changed))

    def _box(self) -> Snapshot[np.int32]:
        return Snapshot(self._tiling, self._size, np.int32)

    def _blank(self, edge: MapEdge) -> NDArray[np.int64]:
        """The neighbour has started anew: inherit what came from it, and expect its sums from the start."""
        self._inherit(edge)
        tiles = edge.inbox.known_tiles
        edge.inbox = self._box()
        return self._update(tiles)

    def _inherit(self, edge: MapEdge) -> None:
        tiles = edge.inbox.known_tiles
        code, live = split_word(edge.inbox.values.read(tiles))
        theirs = np.maximum(code, code_of_sums(live))
        self._inherited.write(tiles, np.maximum(self._inherited.read(tiles), theirs))

    def _update(self, tiles: NDArray[np.int64]) -> NDArray[np.int64]:
        """Recompute the sums of some tiles, what each edge carries of them, and what the map shows."""
        total = WORDS[self._own.values.read(tiles)]
        counts = self._own.counts.copy()
        inherited = self._inherited.read(tiles)
        live, code = {}, {}
        for neighbour, edge in self._edges.items():
            code[neighbour], live[neighbour] = split_word(edge.inbox.values.read(tiles))
            inherited = np.maximum(inherited, code[neighbour])
            total = saturated(total + live[neighbour])
            counts += edge.inbox.counts
        self._inherited.write(tiles, inherited)  # so it holds every tile that anybody has told of
        for neighbour, edge in self._edges.items():
            told, _ = split_word(
                edge.outbox.values.read(tiles)
            )  # never taken back, or two echoes would alternate
            news = np.where(inherited > code[neighbour], inherited, told)
            sums = join_word(news, saturated(total - live[neighbour]))
            edge.outbox.write(tiles, sums, counts - edge.inbox.counts)
        self.counts[:] = counts[:-1]
        self._robots = int(counts[-1])
        shown = np.where(total == 0, CLASSES[inherited], classes_of(total))
        return self.show(tiles, shown)

"""The paper's scale-free way for step evidence: sums of likelihoods that ride the round along a tree."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Generic, TypeVar

from vedette.errors import InputError
from vedette.fusion.edges import Edges
from vedette.fusion.link import RESEND_AFTER, EvidenceLink
from vedette.fusion.steps.elements import Elements
from vedette.fusion.steps.totals import Totals
from vedette.fusion.steps.wire import Entries, check_step, decode, encode, pack, unpack

E = TypeVar("E")


@dataclass(eq=False)
class StepEdge(Generic[E]):
    """One end of a tree edge: the latest sums from there, and when the sums to there last changed."""

    link: EvidenceLink[Entries]
    inbox: dict[int, E] = field(default_factory=dict)  # step -> mu_{l->i}(k)
    heard: int = 0  # version of the inbox
    robots: int = 0  # behind the neighbour that have published
    stamps: dict[int, int] = field(default_factory=dict)  # step -> version at which mu_{i->l}(k) last changed
    told: int = 1  # version of what goes to the neighbour


class StepSums(Totals[E]):
    """``mu_{i->j}(k) = own_i(k) + sum_{l != j} mu_{l->i}(k)``; ``total(k) = own_i(k) + sum_l mu_{l->i}(k)``.

    Theory (V28), for every step k. What crosses an edge is state, not increments: absolute sums under a
    version, so that loss, repetition and reordering do no harm. Robots are anonymous, a step's message is as
    long for a thousand robots as for two, and memory is O(neighbours x window). The neighbours must form a
    tree: on a cycle evidence would run round and be counted for ever.

    Steps older than the newest one known by more than ``window`` are **closed**: their totals no longer
    change, and the caller keeps them in its belief (``Refilter`` does). Evidence later than that is lost.

    When the tree changes, what came over the edges that go leaves the open totals, and the sums are rebuilt
    along the new edges from what every living robot keeps of its own. So of steps that are open everywhere,
    nothing of a living robot is lost or counted twice once the new tree has settled. Meanwhile totals may
    miss robots or hold some twice; therefore no step is closed within ``window`` steps of a change of tree.
    A dead robot's evidence stays where its steps were closed, and is lost where they were open: at most its
    last ``2 window`` steps, if the tree changes once. A robot that restarts counts as dead. One that joins
    late, or a part of the team that was cut off for longer than that, gets the open steps only.
    """

    def __init__(
        self,
        robot: int,
        boot: int,
        elements: Elements[E],
        *,
        window: int,
        resend_after: float = RESEND_AFTER,
    ) -> None:
        """Start with nothing known; ``boot < 2**38`` must differ from those of the robot's earlier starts.

        ``window`` [steps] must exceed the time that evidence takes across the team.
        """
        super().__init__(elements)
        if window < 1:
            raise InputError(f"window must be at least 1 step; got {window}")
        self._window = window
        self._has_published = False
        self._edges: Edges[StepEdge[E], Entries] = Edges(robot, boot, resend_after)
        self._newest = -1
        self._hold = -1  # no step is closed before the newest one is this
        self._open_from = 0

    @property
    def digest(self) -> int:
        """64 bits that agree iff the totals of the newest step and the ``window`` before it do."""
        self.seal(self._newest - self._window)
        return super().digest

    @property
    def open_from(self) -> int:
        """First step that is not closed."""
        return self._open_from

    def publish(self, step: int, element: E) -> None:
        """Add the robot's own evidence of a step; that of a closed step is ignored."""
        check_step(step)
        self._has_published = True
        self._newest = max(self._newest, step)
        if step < self._open_from:
            return
        self._change(step, element, None)
        self._advance()

    def forget(self, before: int) -> None:
        """Drop the totals of earlier steps that are closed."""
        super().forget(min(before, self._open_from))

    def contributors(self) -> int:
        """Return how many robots on the tree have published evidence."""
        return self._has_published + sum(edge.robots for edge in self._edges.values())

    def set_neighbours(self, neighbours: Sequence[int]) -> None:
        """Take these as the neighbours on the tree; call it at every robot when the tree changes anywhere."""
        self._edges.set_neighbours(neighbours, lose=self._blank, make=self._new_edge)
        self._count()
        self._hold = self._newest + self._window

    def outgoing(self, neighbour: int, now: float) -> bytes | None:
        """Return what the neighbour lacks, and what it waits to see acknowledged; None if nothing."""
        payload = self._edges.tell(neighbour, partial(self._since, self._edges[neighbour]), now)
        return None if payload is None else encode(payload)

    def receive(self, neighbour: int, payload: bytes, now: float) -> None:
        """Take over a neighbour's sums (ValueError if malformed, and nothing changes).

        A payload from a robot that is no neighbour, or from its past, is ignored.
        """
        message = decode(payload)
        news = [(sums, self._decoded(sums)) for _, sums in message.sections]
        heard = self._edges.hear(neighbour, message, now)
        if heard is None:
            return
        edge, anew = heard
        if anew:
            self._blank(edge)
            self._count()
        for sums, elements in news:
            if sums.base <= edge.heard < sums.version:
                self._apply(edge, sums, elements)

    def _apply(self, edge: StepEdge[E], sums: Entries, elements: list[tuple[int, E]]) -> None:
        edge.heard = sums.version
        if edge.robots != sums.robots:
            edge.robots = sums.robots
            self._count(edge)
        for step, element in elements:
            self._newest = max(self._newest, step)
            if step < self._open_from:
                continue
            before = edge.inbox.get(step, self._elements.zero())
            edge.inbox[step] = element
            self._change(step, self._elements.subtract(element, before), edge)
        self._advance()

    def _change(self, step: int, more: E, source: StepEdge[E] | None) -> None:
        """Add to a total, and note that the sums to everybody but the source have changed."""
        self.add(step, more)
        for edge in self._edges.values():
            if edge is not source:
                edge.told += 1
                edge.stamps[step] = edge.told

    def _count(self, source: StepEdge[E] | None = None) -> None:
        """Note that the number of robots told to everybody but the source has changed."""
        for edge in self._edges.values():
            if edge is not source:
                edge.told += 1

    def _since(self, edge: StepEdge[E], base: int) -> Entries:
        """Return the sums for a neighbour that changed after a version: totals less what came from there."""
        entries = bytearray()
        for step, stamp in edge.stamps.items():
            if stamp > base:
                back = edge.inbox.get(step, self._elements.zero())
                mu = self._elements.subtract(self.total(step), back)
                entries += pack(step, self._elements.encode(mu))
        return Entries(base, edge.told, bytes(entries), self.contributors() - edge.robots)

    def _advance(self) -> None:
        """Close what is older than the window, unless the tree has just changed."""
        fresh = self._newest - self._window
        if self._newest < self._hold or fresh <= self._open_from:
            return
        self._open_from = fresh
        for edge in self._edges.values():
            edge.inbox = {k: element for k, element in edge.inbox.items() if k >= fresh}
            edge.stamps = {k: stamp for k, stamp in edge.stamps.items() if k >= fresh}

    def _new_edge(self, link: EvidenceLink[Entries]) -> StepEdge[E]:
        return StepEdge(link, stamps={step: 1 for step in self.steps() if step >= self._open_from})

    def _blank(self, edge: StepEdge[E]) -> None:
        """Take what came over an edge out of the open totals: it goes, or starts anew."""
        inbox, edge.inbox = edge.inbox, {}
        edge.heard = edge.robots = 0
        for step, element in inbox.items():
            self._change(step, self._elements.subtract(self._elements.zero(), element), edge)

    def _decoded(self, sums: Entries) -> list[tuple[int, E]]:
        entries = unpack(sums.data, self._elements.most_bytes)
        return [(step, self._elements.decode(data)) for step, data, _ in entries]

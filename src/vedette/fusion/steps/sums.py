"""The paper's scale-free way for step evidence: sums of likelihoods that ride the round along a tree."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Generic, TypeVar

from vedette.errors import InputError
from vedette.fusion.link import Boots, Key, Link, check_boot
from vedette.fusion.steps.elements import Elements
from vedette.fusion.steps.totals import Totals
from vedette.fusion.steps.wire import (
    Have,
    Payload,
    Section,
    check_step,
    decode,
    encode,
    pack,
    unpack,
)

E = TypeVar("E")

RESEND_AFTER = 2.5  # [s]
SESSION_BITS = 24


@dataclass(eq=False)
class Edge(Generic[E]):
    """One end of a tree edge: the latest sums from there, and when the sums to there last changed."""

    link: Link
    inbox: dict[int, E] = field(default_factory=dict)  # step -> mu_{l->i}(k)
    version: int = 0  # of the inbox
    robots: int = 0  # behind the neighbour that have published
    stamps: dict[int, int] = field(default_factory=dict)  # step -> version at which mu_{i->l}(k) last changed
    told: int = 0  # version of what goes to the neighbour


class StepSums(Generic[E]):
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
        check_boot(boot)
        if window < 1:
            raise InputError(f"window must be at least 1 step; got {window}")
        self._robot, self._boot, self._session = robot, boot, 0
        self._elements = elements
        self._window = window
        self._totals = Totals(elements)
        self._own: dict[int, E] = {}
        self._has_published = False
        self._edges: dict[int, Edge[E]] = {}
        self._boots = Boots()
        self._resend_after = resend_after
        self._newest = -1
        self._hold = -1  # no step is closed before the newest one is this
        self._open_from = 0

    @property
    def digest(self) -> int:
        """64 bits that agree iff the totals of the newest step and the ``window`` before it do."""
        self._totals.seal(self._newest - self._window)
        return self._totals.digest

    @property
    def open_from(self) -> int:
        """First step that is not closed."""
        return self._open_from

    def publish(self, step: int, element: E) -> None:
        """Add the robot's own evidence of a step; that of a closed step is ignored."""
        check_step(step)
        self._has_published = True
        self._reach(step)
        if step < self._open_from:
            return
        self._own[step] = self._elements.add(self._own.get(step, self._elements.zero()), element)
        self._change(step, element, None)
        self._advance()

    def total(self, step: int) -> E:
        """Return the sum over the robots on the tree of their evidence of a step."""
        return self._totals[step]

    def steps(self) -> list[int]:
        """Return the steps with evidence that are not forgotten, increasing."""
        return self._totals.steps()

    def take_changed(self) -> int | None:
        """Return the earliest step whose total changed since last asked, or None."""
        return self._totals.take_changed()

    def forget(self, before: int) -> None:
        """Drop the totals of earlier steps that are closed."""
        self._totals.forget(min(before, self._open_from))

    def contributors(self) -> int:
        """Return how many robots on the tree have published evidence."""
        return self._has_published + sum(edge.robots for edge in self._edges.values())

    def set_neighbours(self, neighbours: Sequence[int]) -> None:
        """Take these as the neighbours on the tree; call it at every robot when the tree changes anywhere."""
        for lost in self._edges.keys() - set(neighbours):
            self._blank(self._edges.pop(lost))
        for neighbour in neighbours:
            if neighbour not in self._edges:
                self._edges[neighbour] = self._new_edge()
        self._count()
        self._hold = self._newest + self._window

    def outgoing(self, neighbour: int, now: float) -> bytes | None:
        """Return what the neighbour lacks, and what it waits to see acknowledged; None if nothing."""
        edge = self._edges[neighbour]
        link = edge.link
        greeting = link.greeting(now)
        acknowledged = bool(link.owed) or (greeting is not None and link.peer >= 0)
        have = (Have(neighbour, link.peer, edge.version),) if acknowledged else ()
        link.owed.clear()
        key: Key = (self._robot, link.nonce)
        base = link.base(key, now)
        sections: tuple[Section, ...] = ()
        if link.met and base < edge.told:
            link.sending(key, base, edge.told, now)
            sections = (Section(*key, base, edge.told, self._since(edge, base), self._behind(edge)),)
        if greeting is None and not have and not sections:
            return None
        return encode(Payload(link.nonce, greeting, have, sections))

    def receive(self, neighbour: int, payload: bytes, now: float) -> None:
        """Take over a neighbour's sums (ValueError if malformed, and nothing changes).

        A payload from a robot that is no neighbour, or from its past, is ignored.
        """
        message = decode(payload)
        news = [(section, self._read(section)) for section in message.sections]
        edge = self._edges.get(neighbour)
        self._check(message, neighbour, edge)
        if edge is None or self._is_past(neighbour, edge, message.nonce):
            return
        if edge.link.peer not in (-1, message.nonce):
            self._blank(edge)
            self._count()
        edge.link.hear(message.nonce, message.greeting, message.versions, now)
        for section, entries in news:
            edge.link.owed.add((section.robot, section.nonce))
            if section.base <= edge.version < section.version:
                self._apply(edge, section, entries)

    def _apply(self, edge: Edge[E], section: Section, entries: list[tuple[int, E]]) -> None:
        edge.version = section.version
        if edge.robots != section.robots:
            edge.robots = section.robots
            self._count(edge)
        for step, element in entries:
            self._reach(step)
            if step < self._open_from:
                continue
            before = edge.inbox.get(step, self._elements.zero())
            edge.inbox[step] = element
            self._change(step, self._elements.subtract(element, before), edge)
        self._advance()

    def _change(self, step: int, more: E, source: Edge[E] | None) -> None:
        """Add to a total, and note that the sums to everybody but the source have changed."""
        self._totals.add(step, more)
        for edge in self._edges.values():
            if edge is not source:
                edge.told += 1
                edge.stamps[step] = edge.told

    def _count(self, source: Edge[E] | None = None) -> None:
        """Note that the number of robots told to everybody but the source has changed."""
        for edge in self._edges.values():
            if edge is not source:
                edge.told += 1

    def _behind(self, edge: Edge[E]) -> int:
        return self.contributors() - edge.robots

    def _since(self, edge: Edge[E], base: int) -> bytes:
        """Return the sums for a neighbour that changed after a version: totals less what came from there."""
        entries = bytearray()
        for step, stamp in edge.stamps.items():
            if stamp > base:
                back = edge.inbox.get(step, self._elements.zero())
                mu = self._elements.subtract(self._totals[step], back)
                entries += pack(step, self._elements.encode(mu))
        return bytes(entries)

    def _reach(self, step: int) -> None:
        self._newest = max(self._newest, step)

    def _advance(self) -> None:
        """Close what is older than the window, unless the tree has just changed."""
        fresh = self._newest - self._window
        if self._newest < self._hold or fresh <= self._open_from:
            return
        self._open_from = fresh
        self._own = {k: element for k, element in self._own.items() if k >= fresh}
        for edge in self._edges.values():
            edge.inbox = {k: element for k, element in edge.inbox.items() if k >= fresh}
            edge.stamps = {k: stamp for k, stamp in edge.stamps.items() if k >= fresh}

    def _new_edge(self) -> Edge[E]:
        self._session += 1
        edge: Edge[E] = Edge(Link((self._boot << SESSION_BITS) + self._session, self._resend_after))
        edge.told = 1
        edge.stamps = {step: 1 for step in self._totals.steps() if step >= self._open_from}
        return edge

    def _blank(self, edge: Edge[E]) -> None:
        """Take what came over an edge out of the open totals: it goes, or starts anew."""
        inbox, edge.inbox = edge.inbox, {}
        edge.version = edge.robots = 0
        for step, element in inbox.items():
            self._change(step, self._elements.subtract(self._elements.zero(), element), edge)

    def _is_past(self, neighbour: int, edge: Edge[E], nonce: int) -> bool:
        boot, peer = nonce >> SESSION_BITS, edge.link.peer
        return self._boots.is_stale(neighbour, boot) or (boot == peer >> SESSION_BITS and nonce < peer)

    def _read(self, section: Section) -> list[tuple[int, E]]:
        entries = unpack(section.entries, self._elements.most_bytes)
        return [(step, self._elements.decode(data)) for step, data, _ in entries]

    def _check(self, message: Payload, neighbour: int, edge: Edge[E] | None) -> None:
        keys = [(section.robot, section.nonce) for section in message.sections]
        if len(keys) > 1 or any(key != (neighbour, message.nonce) for key in keys):
            raise ValueError("step evidence: a section is not the neighbour's own sum")
        if edge is None:
            return
        if message.versions.get((self._robot, edge.link.nonce), 0) > edge.told:
            raise ValueError("step evidence: claims sums of this robot that it never sent")

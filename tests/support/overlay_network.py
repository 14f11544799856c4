"""Overlays and reliable links of many robots on simulated datagram links that do all that links can do."""

from __future__ import annotations

import heapq
import itertools
from collections import Counter, defaultdict, deque
from collections.abc import Hashable, Mapping
from dataclasses import dataclass, field
from typing import TypeVar

import numpy as np

from vedette.overlay import Overlay, Place, ReliableLink, Stamp
from vedette.overlay.peer import NOWHERE

Edge = tuple[int, int]
Life = tuple[int, int]  # robot and boot
T = TypeVar("T", bound=Hashable)
HELLO, DATA = b"H", b"D"
BUFFER = 100  # payloads that wait for a frozen robot
DRIFT = 1e-3  # of a clock that is skewed at all, at most
TALK = 0.5  # everybody says something to its neighbours on the tree so often [s]


@dataclass
class Faults:
    """What the links do to a payload."""

    loss: float = 0.0
    repeat: float = 0.0
    delay: tuple[float, float] = (0.001, 0.005)  # shortest and longest [s]: unequal ones reorder


@dataclass(eq=False)
class Node:
    """One robot: its overlay, its links, its clock, and what it has heard."""

    overlay: Overlay
    offset: float  # of its clock [s]
    rate: float = 1.0  # of its clock
    stamp: Stamp = NOWHERE  # the latest
    alive: bool = True
    frozen: bool = False
    inbox: deque[tuple[int, bytes]] = field(default_factory=lambda: deque(maxlen=BUFFER))
    links: dict[int, ReliableLink] = field(default_factory=dict)
    sessions: dict[int, tuple[int, int]] = field(
        default_factory=dict
    )  # boot and stamp that a link is open to
    told: Counter[int] = field(default_factory=Counter)  # messages sent in each session
    heard: Counter[int] = field(default_factory=Counter)  # messages delivered in each session
    delivered: int = 0
    scheduled: float = float("inf")

    def clock(self, time: float) -> float:
        """What its clock shows."""
        return self.offset + self.rate * time

    def time(self, clock: float) -> float:
        """When its clock shows this."""
        return (clock - self.offset) / self.rate


class Network:
    """Delivers payloads event by event, and checks after each what must always hold."""

    def __init__(
        self,
        n: int,
        edges: list[Edge],
        seed: int,
        *,
        lease: float = 3.0,
        notice: bool = False,
        talk: bool = False,
        skew: float = 0.0,
        check: bool = True,
    ) -> None:
        """``skew``: of clocks [s]; ``notice``: crashes are reported; ``talk``: neighbours keep talking."""
        self.checks = check
        self.rng = np.random.default_rng(seed)
        self.now, self.lease, self.notice, self.talk = 0.0, lease, notice, talk
        self.faults = Faults()
        self.near: dict[int, list[int]] = {i: [] for i in range(n)}
        for a, b in edges:
            self.near[a].append(b)
            self.near[b].append(a)
        self.cut: set[Edge] = set()  # directions in which nothing arrives
        self.bytes: Counter[Edge] = Counter()  # of hellos
        self.changes = 0  # of place
        self.parents: defaultdict[int, dict[Life, Life]] = defaultdict(dict)  # by stamp: parents of children
        self._uniform: list[float] = []
        self._queue: list[tuple[float, int, int, int, bytes]] = []  # time, count, receiver, sender, payload
        self._count = itertools.count()
        self.nodes: dict[int, Node] = {}
        for i in range(n):
            offset, rate = skew * self.rng.uniform(-1, 1), 1 + DRIFT * (skew > 0) * self.rng.uniform(-1, 1)
            self._boot_up(i, boot=int(self.rng.integers(1 << 38)), offset=float(offset), rate=float(rate))
        if talk:
            self._post(TALK, -1, -1, b"")

    # -- faults ------------------------------------------------------------------------------------

    def crash(self, i: int) -> None:
        """Kill a robot; its transport is closed, which its neighbours may be told."""
        self.nodes[i].alive = False
        for k in self.near[i] if self.notice else []:
            if self._runs(k):
                self._act(k, lost=i)

    def restart(self, i: int, boot: int) -> None:
        """Start a robot that has crashed, its memory empty."""
        old = self.nodes[i]
        self._boot_up(i, boot, old.offset, old.rate)

    def freeze(self, i: int) -> None:
        """Stop a robot: what arrives waits."""
        self.nodes[i].frozen = True

    def thaw(self, i: int) -> None:
        """Let a robot go on, with its old ideas."""
        node = self.nodes[i]
        node.frozen, node.scheduled = False, float("inf")
        while node.alive and node.inbox:
            self._act(i, *node.inbox.popleft())
        if node.alive:
            self._act(i)

    def leave(self, i: int) -> None:
        """Let a robot take its leave and end."""
        node = self.nodes[i]
        for to, payload in node.overlay.leave(node.clock(self.now)):
            self._send(i, to, HELLO + payload)
        node.alive = False

    def partition(self, part: set[int]) -> None:
        """Cut all links between a part of the team and the rest."""
        self.cut |= {(a, b) for a in self.near for b in self.near[a] if (a in part) != (b in part)}

    def heal(self) -> None:
        """End all faults; robots that have crashed stay so."""
        self.cut.clear()
        self.faults = Faults(loss=min(self.faults.loss, 0.05))
        for i, node in self.nodes.items():
            if node.frozen:
                self.thaw(i)

    # -- time --------------------------------------------------------------------------------------

    def run(self, seconds: float) -> None:
        """Let time pass."""
        end = self.now + seconds
        while self._queue and self._queue[0][0] <= end:
            self._happen()
        self.now = end

    def run_until_whole(self, at_most: float) -> float:
        """Let time pass until there is one tree a component; return how long it took [s]."""
        begin = self.now
        while not self.is_whole():
            if self.now > begin + at_most:
                raise AssertionError(f"no single tree after {at_most} s: {self.places()}")
            changes = self.changes
            while self.changes == changes and self.now <= begin + at_most:
                self._happen()
        return self.now - begin

    def _happen(self) -> None:
        self.now, _, to, sender, payload = heapq.heappop(self._queue)
        if to < 0:
            self._all_talk()
        elif payload and self._runs(to):
            self._act(to, sender, payload)
        elif payload and self.nodes[to].alive:
            self.nodes[to].inbox.append((sender, payload))
        elif self._runs(to) and self.now >= self.nodes[to].scheduled:
            self.nodes[to].scheduled = float("inf")
            self._act(to)

    def _runs(self, i: int) -> bool:
        return self.nodes[i].alive and not self.nodes[i].frozen

    def _post(self, time: float, to: int, sender: int, payload: bytes) -> None:
        heapq.heappush(self._queue, (time, next(self._count), to, sender, payload))

    def _boot_up(self, i: int, boot: int, offset: float, rate: float) -> None:
        clock = offset + rate * self.now
        self.nodes[i] = Node(Overlay(i, boot, clock, self.lease), offset, rate)
        self.nodes[i].overlay.peers(self.near[i], clock)
        self._act(i)

    # -- what a robot's runtime does -----------------------------------------------------------------

    def _act(self, i: int, sender: int = -1, payload: bytes = b"", lost: int = -1) -> None:
        """Let a robot take in a payload, or just the time, and send what it wants sent."""
        node = self.nodes[i]
        now = node.clock(self.now)
        before = node.overlay.place
        if lost >= 0:
            node.overlay.lost(lost, now)
        if payload[:1] == HELLO:
            node.overlay.hear(sender, payload[1:], now)
        self._follow(i, now)
        if payload[:1] == DATA and sender in node.links:
            for message in node.links[sender].hear(payload[1:], now):
                self._deliver(i, sender, message)
        for to, hello in node.overlay.tick(now):
            self._send(i, to, HELLO + hello)
        self._follow(i, now)
        for to, link in node.links.items():
            for packet in link.poll(now):
                self._send(i, to, DATA + packet)
            if link.lost and to in node.sessions:
                node.overlay.lost(to, now)
        wake = node.time(min([node.overlay.wake, *(link.wake for link in node.links.values())]))
        if wake < node.scheduled:
            node.scheduled = max(wake, self.now) + 1e-7  # clocks round
            self._post(node.scheduled, i, -1, b"")
        if node.overlay.place != before:
            self._check(i, before)

    def _follow(self, i: int, now: float) -> None:
        """Open links to new neighbours on the tree, close those to others."""
        node = self.nodes[i]
        place = node.overlay.place
        if not self.talk:
            return
        for k in node.sessions.keys() - set(place.neighbours):
            node.links[k].close()
            del node.sessions[k]
        for k in place.neighbours:
            session = (node.overlay.boot_of(k), place.epoch)
            if node.sessions.get(k) != session:
                node.links.setdefault(k, ReliableLink(node.overlay.boot, 2 * self.lease)).open(*session, now)
                node.sessions[k] = session
                node.told[k] = node.heard[k] = 0

    def _all_talk(self) -> None:
        for i, node in self.nodes.items():
            if self._runs(i):
                for k, (_, stamp) in node.sessions.items():
                    node.links[k].send(f"{stamp} {i} {node.told[k]}".encode(), node.clock(self.now))
                    node.told[k] += 1
                self._act(i)
        self._post(self.now + TALK, -1, -1, b"")

    def _send(self, sender: int, to: int, payload: bytes) -> None:
        if payload[:1] == HELLO:
            self.bytes[sender, to] += len(payload) - 1
        if (sender, to) in self.cut or to not in self.near[sender]:
            return
        copies = (self._chance() >= self.faults.loss) * (1 + (self._chance() < self.faults.repeat))
        low, high = self.faults.delay
        for _ in range(copies):
            self._post(self.now + low + (high - low) * self._chance(), to, sender, payload)

    def _chance(self) -> float:
        if not self._uniform:
            self._uniform = self.rng.random(1024).tolist()
        return self._uniform.pop()

    # -- what must hold ------------------------------------------------------------------------------

    def _deliver(self, i: int, sender: int, message: bytes) -> None:
        """Every message of a session comes once and in order, and only on its own tree."""
        node = self.nodes[i]
        stamp, author, count = map(int, message.split())
        assert (stamp, author) == (node.overlay.place.epoch, sender)
        assert count == node.heard[sender]
        node.heard[sender] += 1
        node.delivered += 1

    def _check(self, i: int, before: Place) -> None:
        """Stamps grow; a stamp's edges only ever grow too, and never form a cycle."""
        self.changes += 1
        if not self.checks:
            return
        node = self.nodes[i]
        place = node.overlay.place
        stamp = node.overlay._position.stamp
        assert stamp >= node.stamp
        node.stamp = stamp
        if place.epoch == before.epoch:
            assert place.parent == before.parent
            assert set(place.neighbours) >= set(before.neighbours)
        if place.parent is not None:
            family = self.parents[place.epoch]
            life, parent = (i, node.overlay.boot), (place.parent, node.overlay.boot_of(place.parent))
            assert family.setdefault(life, parent) == parent
            assert _is_acyclic(family, life)
        agreed = {k: places for k in self.nodes if (places := self._agreed_parent(k)) is not None}
        assert all(_is_acyclic(agreed, k) for k in (i, *place.neighbours))

    def _agreed_parent(self, i: int) -> int | None:
        mine = self.nodes[i].overlay.place
        if mine.parent is None:
            return None
        theirs = self.nodes[mine.parent].overlay.place
        return mine.parent if theirs.epoch == mine.epoch and i in theirs.neighbours else None

    def components(self) -> list[set[int]]:
        """Return who can reach whom over two-way links."""
        left = {i for i, node in self.nodes.items() if node.alive and not node.frozen}
        parts = []
        while left:
            part, ahead = set(), [left.pop()]
            while ahead:
                part.add(i := ahead.pop())
                near = {k for k in self.near[i] if k in left and not {(i, k), (k, i)} & self.cut}
                left -= near
                ahead += near
            parts.append(part)
        return parts

    def is_whole(self) -> bool:
        """Tell whether each component is one tree that all its robots see alike, its size included."""
        return all(self._is_tree(part) for part in self.components())

    def _is_tree(self, part: set[int]) -> bool:
        places = {i: self.nodes[i].overlay.place for i in part}
        if len({(place.epoch, place.size) for place in places.values()}) > 1:
            return False
        edges = {(i, k) for i, place in places.items() for k in place.neighbours}
        both = all((k, i) in edges for i, k in edges)
        return both and len(edges) == 2 * (len(part) - 1) and next(iter(places.values())).size == len(part)

    def places(self) -> dict[int, Place]:
        """Return where everybody is."""
        return {i: node.overlay.place for i, node in self.nodes.items() if node.alive}


def _is_acyclic(parents: Mapping[T, T], start: T) -> bool:
    at, seen = start, {start}
    while at in parents:
        at = parents[at]
        if at in seen:
            return False
        seen.add(at)
    return True


def random_graph(n: int, rng: np.random.Generator, extra: float = 0.5) -> list[Edge]:
    """Return a connected graph: a random tree, and ``extra * n`` links more."""
    edges = {(int(rng.integers(0, i)), i) for i in range(1, n)}
    for _ in range(round(extra * n)):
        a, b = sorted(rng.choice(n, 2, replace=False).tolist())
        edges.add((a, b))
    return sorted(edges)

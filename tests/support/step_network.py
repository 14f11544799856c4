"""A team of step or track fusion instances on lossy links, or in rounds on links that lose nothing."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Generic, Protocol, TypeVar

import numpy as np

Edges = list[tuple[int, int]]


class Exchange(Protocol):
    """What all ways of fusing have in common."""

    def set_neighbours(self, neighbours: Sequence[int]) -> None: ...

    def outgoing(self, neighbour: int, now: float) -> bytes | None: ...

    def receive(self, neighbour: int, payload: bytes, now: float) -> None: ...


X = TypeVar("X", bound=Exchange)


def chain(n: int) -> Edges:
    return [(i, i + 1) for i in range(n - 1)]


def ring(n: int) -> Edges:
    return [(i, (i + 1) % n) for i in range(n)]


def random_tree(n: int, rng: np.random.Generator) -> Edges:
    return [(int(rng.integers(0, i)), i) for i in range(1, n)]


class StepNetwork(Generic[X]):
    """Delivers payloads with loss, repetition and random delay; the clock moves in ``run`` and ``round``."""

    def __init__(
        self,
        make: Callable[[int], X],
        n: int,
        edges: Edges,
        rng: np.random.Generator,
        *,
        loss: float = 0.0,
        repeat: float = 0.0,
        most_delay: float = 0.02,
    ) -> None:
        self.robots: dict[int, X] = {i: make(i) for i in range(n)}
        self.now = 0.0
        self.sizes: list[int] = []  # of the payloads sent
        self.loss, self.repeat, self.most_delay = loss, repeat, most_delay
        self._rng = rng
        self._air: list[tuple[float, int, int, bytes]] = []
        self.connect(edges)

    def connect(self, edges: Edges) -> None:
        self.edges = edges
        for i, robot in self.robots.items():
            near = [b if a == i else a for a, b in edges if i in (a, b)]
            robot.set_neighbours([k for k in near if k in self.robots])

    def kill(self, i: int) -> X:
        """Robot i falls silent; its edges go with the next ``connect``."""
        return self.robots.pop(i)

    def run(self, seconds: int) -> None:
        """Each second, everybody sends to its neighbours, and due payloads arrive in random order."""
        for _ in range(seconds):
            for a, b in self._pairs():
                payload = self.robots[a].outgoing(b, self.now)
                if payload is not None:
                    self._send(a, b, payload)
            self.now += 1.0
            due = [m for m in self._air if m[0] <= self.now]
            self._air = [m for m in self._air if m[0] > self.now]
            for index in self._rng.permutation(len(due)).tolist():
                _, a, b, payload = due[index]
                if b in self.robots:
                    self.robots[b].receive(a, payload, self.now)

    def meet(self) -> None:
        """Exchange greetings, which evidence waits for."""
        for _ in range(2):
            self.round()

    def round(self, root: int = 0) -> None:
        """One round of the agents: news up the tree to the root, then down, nothing lost; takes a second."""
        order = self._outwards(root)
        for parent, child in reversed(order):
            self._hand(child, parent)
        for parent, child in order:
            self._hand(parent, child)
        self.now += 1.0

    def is_quiet(self) -> bool:
        """Nobody has anything left to say, now or later."""
        later = self.now + 100.0
        return all(self.robots[a].outgoing(b, later) is None for a, b in self._pairs())

    def _pairs(self) -> Edges:
        both = [*self.edges, *((b, a) for a, b in self.edges)]
        return [(a, b) for a, b in both if a in self.robots and b in self.robots]

    def _outwards(self, root: int) -> Edges:
        found, order = {root}, []
        grown = True
        while grown:
            new = [(a, b) for a, b in self._pairs() if a in found and b not in found]
            order += new
            found.update(b for _, b in new)
            grown = bool(new)
        return order

    def _hand(self, a: int, b: int) -> None:
        payload = self.robots[a].outgoing(b, self.now)
        if payload is not None:
            self.sizes.append(len(payload))
            self.robots[b].receive(a, payload, self.now)

    def _send(self, a: int, b: int, payload: bytes) -> None:
        self.sizes.append(len(payload))
        for _ in range(1 + (self._rng.random() < self.repeat)):
            if self._rng.random() >= self.loss:
                self._air.append((self.now + self._rng.uniform(0, self.most_delay), a, b, payload))

"""A team of fusion instances on lossy links, and the brute-force map that they should agree on."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np
from numpy.typing import NDArray

from vedette.fusion import FIRM, Fusion
from vedette.kernels.tiles import TiledGrid
from vedette.maps import FREE, OCCUPIED, UNKNOWN

Edges = list[tuple[int, int]]
SHAPE = (50, 70)  # 2 x 3 tiles, padded both ways
COUNTS = 3


def sparse_evidence(rng: np.random.Generator, shape: tuple[int, int] = SHAPE) -> NDArray[np.int8]:
    """Random log-odds: a patch observed, the rest unknown."""
    own = np.zeros(shape, dtype=np.int8)
    row, col = rng.integers(0, shape[0] - 5), rng.integers(0, shape[1] - 5)
    patch = own[row : row + rng.integers(5, 30), col : col + rng.integers(5, 30)]
    patch[:] = rng.integers(-12, 13, patch.shape)
    return own


def expected_classes(owns: Iterable[NDArray[np.int8]]) -> NDArray[np.uint8]:
    """Brute force: sum the levels sign * (1 or 2), cell by cell."""
    levels = [np.sign(o).astype(int) * np.where(np.abs(o.astype(int)) >= FIRM, 2, 1) for o in owns]
    total = np.sum(levels, axis=0)
    seen = np.any([level != 0 for level in levels], axis=0)
    classes = np.where(total > 0, OCCUPIED, np.where(total < 0, FREE, np.where(seen, OCCUPIED, UNKNOWN)))
    return classes.astype(np.uint8)


def ring(n: int) -> Edges:
    return [(i, (i + 1) % n) for i in range(n)]


def random_tree(n: int, rng: np.random.Generator) -> Edges:
    return [(int(rng.integers(0, i)), i) for i in range(1, n)]


class Network:
    """Delivers payloads with loss, repetition and random delay; the clock only moves in ``run``."""

    def __init__(
        self,
        make: Callable[[int], Fusion],
        n: int,
        edges: Edges,
        rng: np.random.Generator,
        *,
        loss: float = 0.0,
        repeat: float = 0.0,
        most_delay: float = 0.02,
    ) -> None:
        self.robots: dict[int, Fusion] = {i: make(i) for i in range(n)}
        self.own = {i: np.zeros(SHAPE, dtype=np.int8) for i in range(n)}
        self.counts = {i: np.zeros(COUNTS, dtype=np.int64) for i in range(n)}
        self.now = 0.0
        self.sent_bytes = 0
        self.loss, self.repeat, self.most_delay = loss, repeat, most_delay
        self._rng = rng
        self._air: list[tuple[float, int, int, bytes]] = []
        self.connect(edges)

    def connect(self, edges: Edges) -> None:
        self.edges = edges
        for i, robot in self.robots.items():
            near = [b if a == i else a for a, b in edges if i in (a, b)]
            robot.set_neighbours([k for k in near if k in self.robots])

    def observe(self, i: int, own: NDArray[np.int8], counts: NDArray[np.int64] | None = None) -> None:
        """Robot i's evidence becomes ``own`` and is published."""
        changed = np.flatnonzero(self.own[i] != own)
        self.own[i] = own
        if counts is not None:
            self.counts[i] = counts
        self.robots[i].publish(TiledGrid.of(own), changed, counts)

    def run(self, rounds: int) -> None:
        """One second a round: everybody sends to its neighbours, due payloads arrive in random order."""
        for _ in range(rounds):
            for a, b in [*self.edges, *((b, a) for a, b in self.edges)]:
                if a in self.robots and b in self.robots:
                    self._send(a, b)
            self.now += 1.0
            due = [m for m in self._air if m[0] <= self.now]
            self._air = [m for m in self._air if m[0] > self.now]
            for index in self._rng.permutation(len(due)).tolist():
                _, a, b, payload = due[index]
                if b in self.robots:
                    self.robots[b].receive(a, payload, self.now)

    def _send(self, a: int, b: int) -> None:
        payload = self.robots[a].outgoing(b, self.now)
        if payload is None:
            return
        self.sent_bytes += len(payload)
        for _ in range(1 + (self._rng.random() < self.repeat)):
            if self._rng.random() >= self.loss:
                self._air.append((self.now + self._rng.uniform(0, self.most_delay), a, b, payload))

    def is_quiet(self) -> bool:
        """Nobody has anything left to say, now or later."""
        later = self.now + 100.0
        pairs = [*self.edges, *((b, a) for a, b in self.edges)]
        live = [(a, b) for a, b in pairs if a in self.robots and b in self.robots]
        return all(self.robots[a].outgoing(b, later) is None for a, b in live)

"""Who talks to whom: an undirected tree over the platforms."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from vedette.errors import InputError, brief
from vedette.number import is_whole, many


@dataclass(frozen=True)
class Tree:
    """``n`` platforms, numbered from 0, joined without a cycle by ``n - 1`` undirected links.

    Raises:
        InputError: no platform; what is no link, or one out of range, to itself or given twice; a cycle; a
            part cut off.
    """

    n: int
    edges: tuple[tuple[int, int], ...]  # each (lower, higher)

    def __post_init__(self) -> None:
        _check_whole("n", self.n)
        edges = _pairs(self.edges)
        if len(edges) < self.n - 1:
            need = f"{self.n} platforms need {many(self.n - 1, 'edge')} to be connected"
            raise InputError(f"tree: {need}; got {len(edges)}")
        group = list(range(self.n))  # group[i] leads to the least platform that i is joined to
        for a, b in edges:
            if not (0 <= a < self.n and 0 <= b < self.n):
                raise InputError(f"tree: edge ({a}, {b}) is out of range; platforms are 0 to {self.n - 1}")
            if (first := _leader(group, a)) == (second := _leader(group, b)):
                raise InputError(f"tree: edge ({a}, {b}) closes a cycle; remove it")
            group[max(first, second)] = min(first, second)
        # n - 1 edges without a cycle leave nobody cut off
        object.__setattr__(self, "n", int(self.n))
        object.__setattr__(self, "edges", tuple((min(pair), max(pair)) for pair in edges))

    @classmethod
    def from_edges(cls, edges: Iterable[tuple[int, int]]) -> Tree:
        """Return the tree with these links; no link at all is the tree of one platform."""
        pairs = _pairs(edges)
        return cls(1 + max((max(pair) for pair in pairs), default=0), pairs)

    @classmethod
    def chain(cls, n: int) -> Tree:
        """Return ``0 - 1 - ... - n-1`` (paper, Fig. 1)."""
        _check_whole("n", n)
        return cls(n, tuple((i - 1, i) for i in range(1, n)))

    @classmethod
    def star(cls, n: int) -> Tree:
        """Return platform 0 linked to all others."""
        _check_whole("n", n)
        return cls(n, tuple((0, i) for i in range(1, n)))

    @classmethod
    def balanced(cls, n: int, branching: int = 2) -> Tree:
        """Return the tree filled level by level, each platform with up to ``branching`` below it."""
        _check_whole("n", n)
        _check_whole("branching", branching)
        return cls(n, tuple(((i - 1) // branching, i) for i in range(1, n)))

    @classmethod
    def random(cls, n: int, *, seed: int | np.random.Generator) -> Tree:
        """Return one of the ``n^(n-2)`` labelled trees, each equally likely (Prüfer's code)."""
        _check_whole("n", n)
        if not isinstance(seed, np.random.Generator) and not (is_whole(seed) and seed >= 0):
            raise InputError(f"tree: seed must be a whole number >= 0 or a Generator; got {brief(seed)}")
        if n < 3:
            return cls.chain(n)
        code = [int(i) for i in np.random.default_rng(seed).integers(n, size=n - 2)]
        links_left = [1 + code.count(i) for i in range(n)]
        edges = []
        for inner in code:
            leaf = links_left.index(1)
            edges.append((min(leaf, inner), max(leaf, inner)))
            links_left[leaf] -= 1
            links_left[inner] -= 1
        a, b = (i for i, left in enumerate(links_left) if left == 1)
        return cls(n, (*edges, (a, b)))

    def neighbours(self, i: int) -> tuple[int, ...]:
        """Return the platforms linked to ``i``, ascending."""
        self._check_platform(i)
        return self._adjacent[i]

    def parents(self, root: int = 0) -> tuple[int | None, ...]:
        """Return each platform's neighbour on the way to the root; ``None`` for the root itself."""
        parents: list[int | None] = [None] * self.n
        for before, here in zip(self.tour(root), self.tour(root)[1:], strict=False):
            if here != root and parents[here] is None and parents[before] != here:
                parents[here] = before
        return tuple(parents)

    def tour(self, root: int = 0) -> tuple[int, ...]:
        """Return the Euler tour from the root, children ascending: ``2n - 1`` visits, each link both ways."""
        self._check_platform(root)
        visits, ahead = [root], {i: list(reversed(self.neighbours(i))) for i in range(self.n)}
        way = [root]
        while way:
            if ahead[way[-1]]:
                child = ahead[way[-1]].pop()
                ahead[child].remove(way[-1])
                way.append(child)
            else:
                way.pop()
            visits.extend(way[-1:])
        return tuple(visits)

    def _check_platform(self, i: int) -> None:
        if not is_whole(i) or not 0 <= i < self.n:
            raise InputError(f"tree: there is no platform {brief(i)}; they are 0 to {self.n - 1}")

    @property
    def is_chain(self) -> bool:
        """Whether no platform has more than two neighbours."""
        return all(len(links) <= 2 for links in self._adjacent)

    @cached_property
    def _adjacent(self) -> tuple[tuple[int, ...], ...]:
        links: list[list[int]] = [[] for _ in range(self.n)]
        for a, b in self.edges:
            links[a].append(b)
            links[b].append(a)
        return tuple(tuple(sorted(own)) for own in links)


def _check_whole(name: str, number: int) -> None:
    if not is_whole(number):
        raise InputError(f"tree: {name} must be a whole number; got {brief(number)}")
    if number < 1:
        raise InputError(f"tree: {name} must be at least 1; got {number}")


def _pairs(edges: Iterable[tuple[int, int]]) -> tuple[tuple[int, int], ...]:
    """Return links as pairs of platform numbers."""
    try:
        pairs = [(a, b) for a, b in edges]
        if not all(is_whole(end) for pair in pairs for end in pair):
            raise TypeError
    except (TypeError, ValueError):
        want = "edges must be pairs of platform numbers, as [(0, 1), (1, 2)]"
        raise InputError(f"tree: {want}; got {brief(edges)}") from None
    return tuple((int(a), int(b)) for a, b in pairs)


def _leader(group: list[int], i: int) -> int:
    """Return the least platform joined to ``i`` so far, shortening the way there."""
    while group[i] != i:
        group[i] = group[group[i]]
        i = group[i]
    return i

"""The trees that teams talk on: some follow space, some do not."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vedette.negotiation import Tree

SEED = 0  # of the random tree
TREES = ("chain", "star", "balanced", "random")


def make(name: str, places: NDArray[np.float64]) -> Tree:
    """Return a tree over platforms at places (n, 2) that are numbered along a serpentine."""
    n = len(places)
    match name:
        case "chain":
            return Tree.chain(n)
        case "star":
            return Tree.star(n)
        case "balanced":
            return balanced_in_space(places)
    return Tree.random(n, seed=SEED)


def balanced_in_space(places: NDArray[np.float64]) -> Tree:
    """Return the binary tree filled level by level whose every branch is one side of a cut through space.

    The platform on the cut is the branch's top; each side is cut across where it is longer.
    """
    n = len(places)
    seated = np.empty(n, np.intp)  # the platform on each node of Tree.balanced(n)
    waiting = [(0, np.arange(n))]
    while waiting:
        node, members = waiting.pop()
        axis = int(np.argmax(np.ptp(places[members], axis=0)))
        members = members[np.argsort(places[members, axis], kind="stable")]
        first = _size(2 * node + 1, n)
        seated[node] = members[first]
        sides = (2 * node + 1, members[:first]), (2 * node + 2, members[first + 1 :])
        waiting.extend((child, side) for child, side in sides if len(side))
    return Tree.from_edges((seated[a], seated[b]) for a, b in Tree.balanced(n).edges)


def _size(node: int, n: int) -> int:
    """Return the size of the branch at a node of the binary tree of n nodes filled by levels."""
    size, first, last = 0, node, node
    while first < n:
        size += min(last, n - 1) - first + 1
        first, last = 2 * first + 1, 2 * last + 2
    return size

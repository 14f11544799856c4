"""Random problems, and a post office that delivers a round's messages in any order that links allow."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from vedette import Objective
from vedette.negotiation import Chooser, Message, Negotiator, Outgoing, TokenNode, Tree

Float = NDArray[np.float64]
Node = Negotiator[Float]


def misses(rng: np.random.Generator, n: int, k: int, cells: int = 12) -> list[list[Float]]:
    """Candidate lists of random miss probabilities, about a third of them exactly 0 or 1."""
    m = rng.uniform(size=(n, k, cells))
    m[rng.uniform(size=m.shape) < 0.2] = 0.0
    m[rng.uniform(size=m.shape) < 0.4] = 1.0
    return [list(own) for own in m]


def informations(rng: np.random.Generator, n: int, k: int, d: int = 3) -> list[list[Float]]:
    """Candidate lists of rank-one information matrices."""
    h = rng.normal(size=(n, k, d))
    return [list(own) for own in np.einsum("nki,nkj->nkij", h, h)]


class Longest(Objective[None, float]):
    """``-max``: the longest of the platforms' times, neither monotone nor submodular; nothing is best."""

    def nothing(self, belief: None) -> float:
        """No time."""
        return 0.0

    def combine(self, a: float, b: float) -> float:
        """The longer."""
        return max(a, b)

    def value(self, belief: None, impact: float) -> float:
        """Shorter is better."""
        return -impact


class Witness(Chooser[Float, Float]):
    """A chooser that compares the rest of the team it is told with the impacts that the others have."""

    team: Sequence[Chooser[Float, Float]] = ()
    replies: int = 0

    def reply(self, others: Float) -> bool:
        """Check, then choose."""
        truth = self.nothing()
        for mate in self.team:
            truth = truth if mate is self else self.combine(truth, mate.impact)
        np.testing.assert_allclose(others, truth, rtol=1e-12, atol=0.0)
        np.testing.assert_array_equal(others == 0.0, truth == 0.0)
        self.replies += 1
        return super().reply(others)


def token_nodes(
    team: Sequence[Chooser[Float, Float]], tree: Tree, max_sweeps: int = 50
) -> list[TokenNode[Float]]:
    """One token node a platform, platform 0 the root."""
    parents = tree.parents()
    return [
        TokenNode(tree.neighbours(i), parents[i], own, max_sweeps=max_sweeps) for i, own in enumerate(team)
    ]


def deliver(nodes: Sequence[Node], rng: np.random.Generator) -> list[tuple[int, int, Message[Float]]]:
    """Start the nodes and deliver in random order, in order on each link; return (from, to, message)."""
    waiting = [int(i) for i in rng.permutation(len(nodes))]
    links: dict[tuple[int, int], list[Message[Float]]] = {}
    log: list[tuple[int, int, Message[Float]]] = []

    def post(sender: int, sends: list[Outgoing[Float]]) -> None:
        for send in sends:
            links.setdefault((sender, send.to), []).append(send.message)

    while waiting or links:
        if waiting and (not links or rng.uniform() < 0.3):
            i = waiting.pop()
            post(i, nodes[i].start())
            continue
        sender, to = list(links)[rng.integers(len(links))]
        message = links[sender, to].pop(0)
        if not links[sender, to]:
            del links[sender, to]
        log.append((sender, to, message))
        post(to, nodes[to].receive(sender, message))
    return log

"""What a round is expected to take is what it takes, hop by hop."""

from __future__ import annotations

import heapq
from itertools import count

import numpy as np
import pytest

from tests.support.random_teams import Float, misses
from vedette import Coverage, Tree
from vedette.missions.flying import RoundTimes
from vedette.negotiation import Chooser, Message, Negotiator, Outgoing, TokenNode, node_of
from vedette.negotiation.multistart import MultistartNode

SWEEPS = 3  # that are expected of a round of the token, at most


def hops(scheme: str, tree: Tree, seed: int) -> float:
    """Return after how many hops one after the other the last platform hears of the end.

    Infinite where the token went round more often than is expected.
    """
    rng = np.random.default_rng(seed)
    weights, candidates = rng.uniform(size=12), misses(rng, tree.n, 4)
    parents = tree.parents()
    nodes: list[Negotiator[Float]] = [
        node_of(scheme, tree.neighbours(i), parents[i], Chooser(Coverage(), weights, own, start=0))
        for i, own in enumerate(candidates)
    ]
    posted, order = list[tuple[int, int, int, int, Message[Float]]](), count()
    now = 0

    def post(sender: int, sends: list[Outgoing[Float]]) -> None:
        for send in sends:
            heapq.heappush(posted, (now + 1, next(order), sender, send.to, send.message))

    for i, node in enumerate(nodes):
        post(i, node.start())
    while posted:
        now, _, sender, to, message = heapq.heappop(posted)
        post(to, nodes[to].receive(sender, message))
    rounds = nodes[0].rounds if isinstance(nodes[0], MultistartNode) else [nodes[0]]
    for each in rounds:
        assert isinstance(each, TokenNode)
        assert each.finished is not None
    sweeps = max(len(each.turns) for each in rounds if isinstance(each, TokenNode))
    return now if sweeps <= SWEEPS else np.inf


@pytest.mark.parametrize("scheme", ["token", "multistart"])
@pytest.mark.parametrize("n", [2, 3, 7, 12])
def test_a_round_of_so_many_sweeps_takes_no_longer_than_its_lead(scheme: str, n: int) -> None:
    times = RoundTimes(link_delay=1.0, preparing=0.0)
    depth = int(np.ceil(np.log2(n + 1))) - 1  # that Freeze takes
    taken = [hops(scheme, Tree.balanced(n), seed) for seed in range(12)]
    within = [each for each in taken if each < np.inf]
    assert len(within) >= 4
    assert depth + max(within) <= times.lead(n, scheme)


def test_two_rounds_of_the_token_take_longer_than_one_is_given() -> None:
    times = RoundTimes(link_delay=1.0, preparing=0.0)
    taken = [hops("multistart", Tree.balanced(7), seed) for seed in range(12)]
    assert max(each for each in taken if each < np.inf) > times.lead(7, "token")

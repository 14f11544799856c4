"""Forks and asynchrony: never lower, an equilibrium, as deep as the tree; what is lost without a guard."""

from __future__ import annotations

import heapq
import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.support.random_teams import Float, Node, deliver, misses
from vedette import Coverage, InputError, Tree, exhaustive, negotiate
from vedette.missions.pairs import scheme_of
from vedette.negotiation import AsyncNode, Chooser, Claims, ForkNode, node_of
from vedette.negotiation.messages import Fork, Gather, Joined, Offer, RoundOutcome, Settled, Tidings

SEEDS = st.integers(0, 100_000)
BOTH = pytest.mark.parametrize("scheme", ["fork", "async"])


def nodes_of(
    scheme: str, weights: Float, candidates: list[list[Float]], tree: Tree, **more: bool
) -> list[Node]:
    parents = tree.parents()
    return [
        node_of(scheme, tree.neighbours(i), parents[i], Chooser(Coverage(), weights, own), **more)  # type: ignore[arg-type]
        for i, own in enumerate(candidates)
    ]


def value_of(weights: Float, impacts: list[Float]) -> float:
    return float(np.sum(weights * (1.0 - np.prod(impacts, axis=0))))


@settings(deadline=None, max_examples=60)
@given(seed=SEEDS, n=st.integers(1, 12), scheme=st.sampled_from(["fork", "async"]))
def test_in_any_order_of_messages_a_round_ends_where_nobody_gains_alone(
    seed: int, n: int, scheme: str
) -> None:
    rng = np.random.default_rng(seed)
    tree, weights, candidates = Tree.random(n, seed=rng), rng.uniform(size=12), misses(rng, n, 4)
    parents = tree.parents()
    team = [Chooser(Coverage(), weights, own) for own in candidates]
    nodes: list[Node] = [node_of(scheme, tree.neighbours(i), parents[i], own) for i, own in enumerate(team)]
    deliver(nodes, rng)
    outcome = nodes[0].finished
    assert outcome is not None
    assert all(node.finished == outcome and not node.waiting_for for node in nodes)
    assert outcome.converged
    chosen = [own.impact for own in team]
    assert outcome.value == pytest.approx(value_of(weights, chosen), abs=1e-9)
    for i, own in enumerate(candidates):
        gains = [value_of(weights, [*chosen[:i], each, *chosen[i + 1 :]]) - outcome.value for each in own]
        assert max(gains) <= 1e-8
    if scheme == "fork" and outcome.bound == outcome.value:
        return  # ended at the ceiling, before everybody heard of the last changes
    held = [team[0].value(node.team_held()) for node in nodes]
    assert held == pytest.approx([outcome.value] * n, abs=1e-9)  # everybody knows the rest of the team


@BOTH
@pytest.mark.parametrize("seed", range(8))
def test_the_value_never_falls(scheme: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    n = int(rng.integers(3, 25))
    weights, candidates = rng.uniform(size=60), [[own**0.1 for own in each] for each in misses(rng, n, 5, 60)]
    start = rng.integers(5, size=n).tolist() if seed % 2 else None
    result = negotiate(Coverage(), weights, candidates, Tree.random(n, seed=rng), scheme, start=start)
    values = [step.value for step in result.history]
    assert values[-1] > values[0]
    assert all(later >= earlier - 1e-9 for earlier, later in itertools.pairwise(values))
    chosen = [own[k] for own, k in zip(candidates, result.choice, strict=True)]
    assert result.value == pytest.approx(value_of(weights, chosen), abs=1e-9)


def test_without_rounds_too_a_child_is_cut_once_and_nobody_after_the_end() -> None:
    node = AsyncNode([1, 2, 3], 1, Chooser(Coverage(), np.ones(2), [np.zeros(2)]))
    node.start()
    node.cut(2)
    assert node.cut(2) == []
    assert node.waiting_for == {3}
    node.receive(1, Settled(RoundOutcome(2.0, 2.0, 1, converged=True), keep=True, quiet=True))
    assert node.cut(3) == []
    assert node.finished is not None


def test_in_whatever_order_news_come_only_what_was_taken_counts_and_the_value_never_falls() -> None:
    """Facts are told while changes are still to be taken: one in a hundred teams shows where they mix."""
    for seed in range(400):
        rng = np.random.default_rng(seed)
        n = int(rng.integers(3, 8))
        tree, weights, candidates = Tree.random(n, seed=rng), rng.uniform(size=12), misses(rng, n, 4)
        team = [Chooser(Coverage(), weights, own) for own in candidates]
        parents = tree.parents()
        nodes = [AsyncNode(tree.neighbours(i), parents[i], own) for i, own in enumerate(team)]
        deliver(nodes, rng)
        outcome, values = nodes[0].finished, nodes[0].values
        assert outcome is not None
        assert outcome.value == pytest.approx(value_of(weights, [own.impact for own in team]), abs=1e-9)
        assert all(later >= earlier - 1e-9 for earlier, later in itertools.pairwise(values)), seed


@settings(deadline=None, max_examples=40)
@given(seed=SEEDS, n=st.integers(1, 4), scheme=st.sampled_from(["fork", "async"]))
def test_at_least_half_of_the_optimum_and_the_bound_is_above_it(seed: int, n: int, scheme: str) -> None:
    rng = np.random.default_rng(seed)
    weights, candidates = rng.uniform(size=12), misses(rng, n, 3)
    result = negotiate(Coverage(), weights, candidates, Tree.random(n, seed=rng), scheme)
    best = exhaustive(Coverage(), weights, candidates).value
    assert result.bound is not None
    assert 0.5 * best - 1e-9 <= result.value <= best + 1e-9 <= result.bound + 2e-9


def two_that_want_the_same() -> tuple[Float, list[list[Float]], Tree]:
    """Two at the ends of a chain, each on a poor tile of its own, and one rich tile between them."""
    weights = np.array([1.0, 1.0, 3.0])
    own = [
        [np.array([0.0, 1.0, 1.0]), np.array([1.0, 1.0, 0.0])],
        [np.array([1.0, 0.0, 1.0]), np.array([1.0, 1.0, 0.0])],
    ]
    return weights, [[np.ones(3)], *own], Tree.star(3)


@BOTH
def test_of_two_that_move_to_the_same_place_at_once_one_is_taken_and_one_goes_back(scheme: str) -> None:
    weights, candidates, tree = two_that_want_the_same()
    result = negotiate(Coverage(), weights, candidates, tree, scheme, start=[0, 0, 0])
    assert result.history[0].value == 2.0
    assert min(step.value for step in result.history) == 2.0
    assert (result.choice, result.value, result.converged) == ((0, 1, 0), 4.0, True)


def test_without_a_guard_both_move_and_answer_each_other_for_ever() -> None:
    weights, candidates, tree = two_that_want_the_same()
    weights = np.array([2.0, 2.0, 3.0])
    guarded = negotiate(Coverage(), weights, candidates, tree, "async", start=[0, 0, 0])
    loose = negotiate(Coverage(), weights, candidates, tree, "async", start=[0, 0, 0], guard=False)
    assert (guarded.value, guarded.converged) == (5.0, True)
    assert min(step.value for step in loose.history) == 3.0 < loose.history[0].value  # both on the rich tile
    assert not loose.converged


def separate(rng: np.random.Generator, tree: Tree, cells: int = 4) -> tuple[Float, list[list[Float]]]:
    """Platforms each with cells of its own, and a choice among them."""
    weights, candidates = rng.uniform(size=(tree.n, cells)).ravel(), []
    for i in range(tree.n):
        own = []
        for _ in range(5):
            miss = np.ones(tree.n * cells)
            miss[i * cells : (i + 1) * cells] = rng.uniform(size=cells)
            own.append(miss)
        candidates.append(own)
    return weights, candidates


@pytest.mark.parametrize("seed", range(4))
def test_where_impacts_do_not_overlap_a_fork_is_the_tokens_choice_in_one_sweep_as_deep_as_the_tree(
    seed: int,
) -> None:
    rng = np.random.default_rng(seed)
    tree = Tree.random(20, seed=rng)
    weights, candidates = separate(rng, tree)
    token = negotiate(Coverage(), weights, candidates, tree)
    fork = negotiate(Coverage(), weights, candidates, tree, "fork")
    assert (fork.choice, fork.sweeps, fork.value) == (token.choice, 1, pytest.approx(token.value))
    assert fork.messages == 4 * (tree.n - 1)  # gathering, a sweep there and back, the end
    parents = tree.parents()

    def depth(i: int | None) -> int:
        return -1 if i is None else 1 + depth(parents[i])

    nodes = nodes_of("fork", weights, candidates, tree)
    assert hops_of(nodes) == 4 * max(depth(i) for i in range(tree.n))


def hops_of(nodes: list[Node]) -> int:
    """How many hops of equal length pass until the last message arrives."""
    count = itertools.count()
    under_way = [(1, next(count), i, send) for i, node in enumerate(nodes) for send in node.start()]
    heapq.heapify(under_way)
    last = 0
    while under_way:
        last, _, sender, send = heapq.heappop(under_way)
        for reply in nodes[send.to].receive(sender, send.message):
            heapq.heappush(under_way, (last + 1, next(count), send.to, reply))
    return last


@BOTH
def test_a_fork_takes_far_fewer_hops_than_the_token_on_a_bushy_tree(scheme: str) -> None:
    rng = np.random.default_rng(5)
    tree = Tree.balanced(63)
    weights, candidates = rng.uniform(size=200), misses(rng, 63, 4, 200)
    assert hops_of(nodes_of(scheme, weights, candidates, tree)) < 0.5 * hops_of(
        nodes_of("token", weights, candidates, tree)
    )


def test_at_most_one_offer_and_one_piece_of_news_without_an_answer_are_under_way_on_a_link() -> None:
    rng = np.random.default_rng(6)
    tree = Tree.random(15, seed=rng)
    weights, candidates = rng.uniform(size=12), misses(rng, 15, 4)
    nodes = nodes_of("async", weights, candidates, tree)
    log = deliver(nodes, rng)
    offered: dict[int, int] = {}
    for sender, to, message in log:
        if isinstance(message, Offer) and message.mu is not None:
            assert offered.get(sender, 0) == message.serial - 1
        if isinstance(message, Tidings):
            offered[to] = message.answered
            assert message.answered <= message.serial


def test_what_is_out_of_turn_is_refused() -> None:
    weights = np.ones(2)
    (fork,) = nodes_of("fork", weights, [[np.zeros(2)]], Tree.chain(1))
    with pytest.raises(InputError, match="3, who is not a neighbour"):
        fork.receive(3, Fork(None, True))
    leaf = nodes_of("fork", weights, [[np.zeros(2)], [np.zeros(2)]], Tree.chain(2))[1]
    with pytest.raises(InputError, match="Joined from 0 is out of turn"):
        leaf.receive(0, Joined(np.zeros(2), 0.0, 0.0, 1, 0.0, 0, False))
    asleep = nodes_of("async", weights, [[np.zeros(2)], [np.zeros(2)]], Tree.chain(2))[1]
    with pytest.raises(InputError, match="Tidings from 0 is out of turn"):
        asleep.receive(0, Tidings(np.zeros(2), 2, 0, True))
    with pytest.raises(InputError, match="Offer from 0 is out of turn"):
        asleep.receive(0, Offer(None, 0, 0, True, False, 0.0, 0.0, 1, 0.0, 0, False))
    assert asleep.receive(0, Settled(RoundOutcome(1.0, None, 1, True), True, True)) == []


def no_more_than_one_can(impact: Float, platforms: int) -> None:
    """A platform sees one cell for sure at most."""
    if np.count_nonzero(impact == 0.0) > platforms:
        raise ValueError("claims too much")


def test_what_claims_too_much_is_refused_by_both_and_nothing_of_it_is_held() -> None:
    weights, honest, liar = np.ones(3), np.array([1.0, 0.0, 1.0]), np.zeros(3)
    claims = Claims({1: 1}, no_more_than_one_can)
    fork = ForkNode([1], None, Chooser(Coverage(), weights, [np.array([0.0, 1.0, 1.0])]), claims=claims)
    fork.start()
    with pytest.raises(InputError, match="speaks for 2 platforms, at most 1 behind it"):
        fork.receive(1, Gather(honest, 2, 1.0, 1.0))
    (down,) = fork.receive(1, Gather(honest, 1, 3.0, 1.0))
    assert isinstance(down.message, Fork)
    with pytest.raises(ValueError, match="claims too much"):
        fork.receive(1, Joined(liar, 3.0, 0.0, 1, 3.0, 1, False))
    assert fork.waiting_for == {1}
    np.testing.assert_array_equal(fork.team_held(), [0.0, 0.0, 1.0])  # the honest impact, and the own one
    team = AsyncNode([1], None, Chooser(Coverage(), weights, [np.array([0.0, 1.0, 1.0])]), claims=claims)
    team.start()
    with pytest.raises(ValueError, match="claims too much"):
        team.receive(1, Offer(liar, 1, 0, False, True, 3.0, 0.0, 1, 3.0, 0, False))
    assert team.waiting_for == {1}
    assert team.receive(1, Offer(honest, 1, 0, False, True, 1.0, 0.0, 1, 1.0, 0, False))
    np.testing.assert_array_equal(team.team_held(), [0.0, 0.0, 1.0])


def test_planners_that_do_not_negotiate_are_not_taken_back_by_a_scheme_that_prices_changes() -> None:
    assert [scheme_of("nearest", scheme) for scheme in ("fork", "async", "jacobi")] == [
        "token",
        "token",
        "jacobi",
    ]
    assert scheme_of("tours", "fork") == "fork"
    with pytest.raises(InputError, match="greedy negotiates by token"):
        scheme_of("greedy", "fork")

"""The token: exact leave-one-out, never lower, an equilibrium, counted messages, a true bound."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.support.random_teams import Float, Longest, Witness, deliver, informations, misses, token_nodes
from vedette import Coverage, InputError, LogDet, Tree, bound, exhaustive, negotiate
from vedette.negotiation import Chooser, Message, TokenNode
from vedette.negotiation.messages import Down, Gather, Stop, Tally, Token

TREES = [Tree.chain(6), Tree.star(6), Tree.balanced(6), Tree.random(6, seed=1)]


def gains_alone(weights: Float, candidates: list[list[Float]], choice: tuple[int, ...]) -> list[float]:
    """The most that each platform could gain by changing alone, by trying everything."""
    chosen = [own[k] for own, k in zip(candidates, choice, strict=True)]

    def value(i: int, impact: Float) -> float:
        return float(np.sum(weights * (1.0 - np.prod([*chosen[:i], impact, *chosen[i + 1 :]], axis=0))))

    return [max(value(i, other) for other in own) - value(i, chosen[i]) for i, own in enumerate(candidates)]


@settings(deadline=None, max_examples=60)
@given(seed=st.integers(0, 10_000), n=st.integers(1, 12))
def test_leave_one_out_by_messages_equals_brute_force_on_random_trees(seed: int, n: int) -> None:
    rng = np.random.default_rng(seed)
    tree, weights = Tree.random(n, seed=rng), rng.uniform(size=12)
    team = [Witness(Coverage(), weights, own) for own in misses(rng, n, 4)]
    for own in team:
        own.team = team  # checks every reply; about a fifth of the probabilities are exactly zero
    nodes = token_nodes(team, tree)
    deliver(nodes, rng)
    assert all(own.replies > 0 for own in team)
    assert len({node.finished for node in nodes}) == 1
    assert nodes[0].finished is not None


@pytest.mark.parametrize("tree", TREES)
@pytest.mark.parametrize("seed", range(5))
def test_value_never_falls_and_ends_at_an_equilibrium(tree: Tree, seed: int) -> None:
    rng = np.random.default_rng(seed)
    weights, candidates = rng.uniform(size=12), misses(rng, tree.n, 5)
    result = negotiate(Coverage(), weights, candidates, tree, start=rng.integers(5, size=tree.n).tolist())
    values = [step.value for step in result.history]
    assert all(later >= earlier for earlier, later in itertools.pairwise(values))
    assert result.converged
    assert max(gains_alone(weights, candidates, result.choice)) <= 1e-9
    team = np.prod([own[k] for own, k in zip(candidates, result.choice, strict=True)], axis=0)
    assert result.value == pytest.approx(Coverage().value(weights, team), abs=1e-12)


@settings(deadline=None, max_examples=40)
@given(seed=st.integers(0, 10_000), n=st.integers(1, 4))
def test_value_is_at_least_half_of_the_optimum_and_the_bound_at_least_the_optimum(seed: int, n: int) -> None:
    rng = np.random.default_rng(seed)
    tree, weights = Tree.random(n, seed=rng), rng.uniform(size=12)
    problems = [
        (Coverage(), weights, misses(rng, n, 4)),
        (LogDet(), np.eye(3), informations(rng, n, 4)),
    ]
    for objective, belief, candidates in problems:
        result = negotiate(objective, belief, candidates, tree)
        best = exhaustive(objective, belief, candidates).value
        assert result.bound is not None
        assert 0.5 * best <= result.value <= best + 1e-12
        assert best <= result.bound + 1e-12
        assert result.bound == pytest.approx(bound(objective, belief, candidates, result.choice), abs=1e-8)


@pytest.mark.parametrize("tree", TREES)
def test_a_sweep_is_two_messages_a_link_and_gathering_and_stopping_one_each(tree: Tree) -> None:
    rng = np.random.default_rng(8)
    weights, candidates = rng.uniform(size=30), misses(rng, tree.n, 6, cells=30)
    log = deliver(token_nodes([Chooser(Coverage(), weights, own) for own in candidates], tree), rng)
    links = {(sender, to): 0 for a, b in tree.edges for sender, to in ((a, b), (b, a))}
    hops = [(sender, to, m) for sender, to, m in log if isinstance(m, Token)]
    first_sweep = hops[: 2 * (tree.n - 1)]
    for sender, to, _ in first_sweep:
        links[sender, to] += 1
    assert set(links.values()) == {1}
    assert [(sender, to) for sender, to, _ in first_sweep] == list(
        zip(tree.tour(), tree.tour()[1:], strict=False)
    )
    assert sum(isinstance(m, Gather) for _, _, m in log) == tree.n - 1
    assert sum(isinstance(m, Stop) for _, _, m in log) == tree.n - 1


@pytest.mark.parametrize("max_sweeps", [1, 2])
def test_the_cap_ends_the_round_at_the_last_turn_of_a_sweep(max_sweeps: int) -> None:
    rng = np.random.default_rng(0)
    weights, candidates = rng.uniform(size=30), misses(rng, 10, 8, cells=30)
    result = negotiate(Coverage(), weights, candidates, Tree.chain(10), max_sweeps=max_sweeps)
    assert result.sweeps <= max_sweeps
    assert [step.sweep for step in result.history[1:]].count(1) == 10
    if max_sweeps == 1:
        assert not result.converged
        assert result.bound is not None  # the ceiling


def test_the_first_sweep_from_nobody_is_the_sequential_greedy_choice() -> None:
    rng = np.random.default_rng(3)
    weights, candidates = rng.uniform(size=12), misses(rng, 5, 6)
    team, greedy = np.ones(12), []
    for own in candidates:  # a chain is visited in order
        greedy.append(int(np.argmax([np.sum(weights * (1 - team * m)) for m in own])))
        team = team * own[greedy[-1]]
    result = negotiate(Coverage(), weights, candidates, Tree.chain(5), max_sweeps=1)
    assert result.choice == tuple(greedy)


def test_a_fully_separable_problem_stops_after_one_sweep_with_value_equal_to_bound() -> None:
    rng = np.random.default_rng(4)
    candidates = [[np.ones(24) for _ in range(4)] for _ in range(8)]
    for i, own in enumerate(candidates):
        for impact in own:
            impact[3 * i : 3 * i + 3] = rng.uniform(size=3)
    result = negotiate(Coverage(), rng.uniform(size=24), candidates, Tree.random(8, seed=2))
    assert result.value == pytest.approx(result.bound, abs=1e-12)
    assert (result.sweeps, result.converged) == (1, True)
    assert len(result.history) == 1 + 8
    assert result.messages <= 4 * 7


def test_a_platform_with_nothing_to_add_still_chooses_the_lowest_index() -> None:
    everything, none = np.zeros(2), np.ones(2)
    for candidates in (
        [[everything], [none, none], [everything, none]],
        [[everything], [none, none], [none]],
    ):
        result = negotiate(Coverage(), np.ones(2), candidates, Tree.chain(3))
        assert (result.choice, result.value) == ((0, 0, 0), 2.0)


def test_an_impact_is_sent_again_only_if_something_in_it_has_changed() -> None:
    rng = np.random.default_rng(0)
    tree, weights = Tree.random(7, seed=0), np.ones(30)
    candidates = misses(rng, 7, 6, cells=30)
    team = [Chooser(Coverage(), weights, own) for own in candidates]
    before: dict[tuple[int, int], Float] = {}
    repeats = 0
    for sender, to, message in deliver(token_nodes(team, tree), rng):
        if isinstance(message, Gather | Token):
            if message.mu is None:
                assert (sender, to) in before
                repeats += 1
            else:
                before[sender, to] = message.mu
    assert repeats > 0
    settled = [own.strategy or 0 for own in team]
    again = negotiate(Coverage(), weights, candidates, tree, start=settled)
    assert again.choice == tuple(settled)
    # each impact goes once each way over each link, and nothing changes
    plain = 30 * 8 * 2 * 6
    assert plain < again.bytes < plain + 64 * again.messages


@pytest.mark.parametrize("tree", TREES)
def test_who_alone_can_gain_is_asked_wherever_the_token_finds_it(tree: Tree) -> None:
    for able in range(tree.n):
        candidates = [[np.ones(2)] for _ in range(tree.n)]
        candidates[able].append(np.zeros(2))
        result = negotiate(Coverage(), np.ones(2), candidates, tree, start=[0] * tree.n)
        assert (result.choice[able], result.value) == (1, 2.0)


def test_one_platform_needs_no_message() -> None:
    result = negotiate(Coverage(), np.ones(2), [[np.ones(2), np.zeros(2)]], Tree.chain(1))
    assert (result.choice, result.value, result.bound, result.messages) == ((1,), 2.0, 2.0, 0)


def test_without_the_declaration_there_is_no_bound_but_still_an_equilibrium() -> None:
    result = negotiate(Longest(), None, [[5.0, 3.0], [4.0, 9.0], [2.0, 1.0]], Tree.star(3))
    assert (result.value, result.bound, result.converged) == (-4.0, None, True)
    assert result.choice[:2] == (1, 0)


def test_messages_out_of_turn_are_refused_and_late_ones_ignored() -> None:
    def node() -> TokenNode[Float]:
        return TokenNode([1, 2], None, Chooser(Coverage(), np.ones(2), [np.zeros(2)]))

    tally = Tally(turns=0, quiet=0, value=0.0, slack=0.0, size=3, ceiling=1.0)
    mu = np.ones(2)
    cases: list[tuple[int, Message[Float], str]] = [
        (7, Gather(mu, 1, 0.0, 0.0), "7, who is not a neighbour"),
        (1, Gather(None, 1, 0.0, 0.0), "never sent"),
        (1, Token(mu, tally), "Token from 1 is out of turn"),
        (1, Down(mu), "Down from 1 is out of turn"),
    ]
    for sender, message, words in cases:
        with pytest.raises(InputError, match=words):
            node().receive(sender, message)
    root = node()
    root.receive(1, Gather(mu, 1, 0.0, 0.0))
    with pytest.raises(InputError, match="Gather from 1 is out of turn"):
        root.receive(1, Gather(mu, 1, 0.0, 0.0))
    over = deliver(
        nodes := token_nodes([Chooser(Coverage(), np.ones(2), [mu]) for _ in range(2)], Tree.chain(2)),
        np.random.default_rng(0),
    )
    assert nodes[0].receive(1, over[0][2]) == []

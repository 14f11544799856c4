"""The paper's simultaneous scheme: its sweep, its cycle, and the way out."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from tests.support.random_teams import Float, Longest, deliver, informations, misses
from vedette import CountedCoverage, Coverage, InputError, LogDet, Tree, bound, counted, exhaustive, negotiate
from vedette.negotiation import Chooser, JacobiNode, Message
from vedette.negotiation.messages import Down, RoundOutcome, Stop, Up

A, B = np.array([0.0, 1.0]), np.array([1.0, 0.0])  # two frontiers, each surely seen by who goes there
WORTH = np.array([3.0, 2.0])


def best_replies(weights: Float, candidates: list[list[Float]], choice: list[int]) -> list[int]:
    """The paper's eq. (29) by brute force; kept unless another gains a share of 1e-9."""
    chosen = [own[k] for own, k in zip(candidates, choice, strict=True)]
    replies = []
    for i, own in enumerate(candidates):
        rest = np.prod([np.ones_like(weights), *chosen[:i], *chosen[i + 1 :]], axis=0)
        values = [float(np.sum(weights * (1.0 - rest * m))) for m in own]
        keep = max(values) - values[choice[i]] <= 1e-9 * max(values)
        replies.append(choice[i] if keep else int(np.argmax(values)))
    return replies


def test_two_robots_and_two_frontiers_cycle_and_roll_back_to_the_best_iterate() -> None:
    result = negotiate(Coverage(), WORTH, [[A, B], [A, B]], Tree.chain(2), "jacobi", max_sweeps=30)
    assert [step.value for step in result.history] == [0.0, 3.0, 2.0, 3.0]
    assert (result.choice, result.value) == ((0, 0), 3.0)
    assert (result.cycle, result.converged, result.sweeps) == (2, False, 3)
    token = negotiate(Coverage(), WORTH, [[A, B], [A, B]], Tree.chain(2))
    assert (token.value, token.cycle, token.converged) == (5.0, 0, True)


def test_a_start_that_is_better_than_the_cycle_is_kept() -> None:
    third = np.array([0.5, 0.5])
    start = negotiate(
        Coverage(), np.ones(2), [[A, B, third]] * 3, Tree.star(3), "jacobi", start=[0, 1, 1], max_sweeps=9
    )
    assert start.value >= start.history[0].value == 2.0


@settings(deadline=None, max_examples=60)
@given(seed=st.integers(0, 10_000), n=st.integers(1, 9))
def test_iterates_are_the_papers_best_replies_whatever_the_order_of_delivery(seed: int, n: int) -> None:
    rng = np.random.default_rng(seed)
    tree, weights, candidates = Tree.random(n, seed=rng), rng.uniform(size=12), misses(rng, n, 4)
    choice = rng.integers(4, size=n).tolist()
    team = [Chooser(Coverage(), weights, own, start=k) for own, k in zip(candidates, choice, strict=True)]
    parents = tree.parents()
    nodes = [JacobiNode(tree.neighbours(i), parents[i], own) for i, own in enumerate(team)]
    deliver(nodes, rng)
    choices = [choice]
    for _ in nodes[0].values[1:]:
        choices.append(best_replies(weights, candidates, choices[-1]))
    teams = [np.prod([own[k] for own, k in zip(candidates, c, strict=True)], axis=0) for c in choices]
    np.testing.assert_allclose(nodes[0].values, [np.sum(weights * (1.0 - t)) for t in teams], atol=1e-12)
    assert len({node.finished for node in nodes}) == 1
    outcome = nodes[0].finished
    assert outcome is not None
    if outcome.cycle:
        assert choices[-1] == choices[-1 - outcome.cycle]
        assert choices[-1] not in choices[-outcome.cycle : -1]
    best = int(np.argmax(nodes[0].values))
    assert outcome.value == pytest.approx(nodes[0].values[best], abs=1e-9)
    final = np.prod([own.impact for own in team], axis=0)
    assert outcome.value == pytest.approx(float(np.sum(weights * (1.0 - final))), abs=1e-9)
    if outcome.converged and outcome.cycle == 0:
        chosen = [own.index or 0 for own in team]
        assert best_replies(weights, candidates, chosen) == chosen


@settings(deadline=None, max_examples=40)
@given(seed=st.integers(0, 10_000), n=st.integers(1, 8))
def test_the_papers_sweep_with_the_inverse_and_the_division_free_one_give_identical_iterates(
    seed: int, n: int
) -> None:
    rng = np.random.default_rng(seed)
    weights = rng.uniform(size=12)
    candidates: list[list[NDArray[np.int64]]] = [[counted(m) for m in own] for own in misses(rng, n, 4)]
    run = (CountedCoverage(), weights, candidates, Tree.chain(n), "jacobi")
    faithful, free = negotiate(*run, inverse=True), negotiate(*run)
    assert faithful.history == free.history
    assert (faithful.choice, faithful.value, faithful.cycle) == (free.choice, free.value, free.cycle)
    assert faithful.messages == free.messages


def test_the_papers_gaussian_example_runs_with_the_inverse() -> None:
    rng = np.random.default_rng(5)
    candidates = informations(rng, 3, 5)
    result = negotiate(LogDet(), np.eye(3), candidates, Tree.chain(3), "jacobi", inverse=True)
    best = exhaustive(LogDet(), np.eye(3), candidates)
    assert result.bound is not None
    assert 0.5 * best.value <= result.value <= best.value + 1e-12 <= result.bound + 2e-12


def test_the_round_never_rolls_back_to_nobody() -> None:
    result = negotiate(Longest(), None, [[5.0, 3.0], [4.0, 9.0], [2.0, 1.0]], Tree.star(3), "jacobi")
    assert (result.choice, result.value, result.bound) == ((1, 0, 1), -4.0, None)


@pytest.mark.parametrize("tree", [Tree.chain(5), Tree.star(5), Tree.random(5, seed=3)])
def test_an_iterate_is_two_messages_a_link(tree: Tree) -> None:
    rng = np.random.default_rng(6)
    weights, candidates = rng.uniform(size=12), misses(rng, 5, 5)
    parents = tree.parents()
    nodes = [
        JacobiNode(tree.neighbours(i), parents[i], Chooser(Coverage(), weights, own))
        for i, own in enumerate(candidates)
    ]
    log = deliver(nodes, rng)
    sweeps = len(nodes[0].values) - 1
    assert sum(isinstance(m, Up) for _, _, m in log) == (sweeps + 1) * (tree.n - 1)
    assert sum(isinstance(m, Down) for _, _, m in log) == sweeps * (tree.n - 1)
    assert sum(isinstance(m, Stop) for _, _, m in log) == tree.n - 1


@settings(deadline=None, max_examples=40)
@given(seed=st.integers(0, 10_000), n=st.integers(1, 4), sweeps=st.integers(1, 6))
def test_the_bound_is_never_below_the_optimum(seed: int, n: int, sweeps: int) -> None:
    rng = np.random.default_rng(seed)
    weights, candidates = rng.uniform(size=12), misses(rng, n, 4)
    result = negotiate(Coverage(), weights, candidates, Tree.random(n, seed=rng), "jacobi", max_sweeps=sweeps)
    assert result.bound is not None
    assert exhaustive(Coverage(), weights, candidates).value <= result.bound + 1e-12
    if result.converged or result.cycle:
        same = bound(Coverage(), weights, candidates, result.choice)
        assert result.bound == pytest.approx(same, abs=1e-8)
    assert result.sweeps <= sweeps


def test_a_fully_separable_problem_takes_a_single_iteration() -> None:
    rng = np.random.default_rng(7)
    candidates = [[np.ones(24) for _ in range(4)] for _ in range(8)]
    for i, own in enumerate(candidates):
        for impact in own:
            impact[3 * i : 3 * i + 3] = rng.uniform(size=3)
    result = negotiate(Coverage(), rng.uniform(size=24), candidates, Tree.random(8, seed=2), "jacobi")
    assert (result.sweeps, result.converged) == (1, True)
    assert result.value == pytest.approx(result.bound, abs=1e-12)


def test_messages_out_of_turn_are_refused() -> None:
    def node() -> JacobiNode[Float]:
        return JacobiNode([1, 2], 1, Chooser(Coverage(), WORTH, [A, B]))

    stop = Stop(RoundOutcome(0.0, None, 1, True), iterate=1)  # there is only iterate 0
    cases: list[tuple[int, Message[Float], str]] = [
        (7, Down(A), "7, who is not a neighbour"),
        (1, Up(A, 0.0, 0.0, ()), "Up from 1 is out of turn"),
        (2, Down(A), "Down from 2 is out of turn"),
        (1, Down(None), "never sent"),
        (1, stop, "Stop at iterate 1, never reached"),
    ]
    for sender, message, words in cases:
        fresh = node()
        fresh.start()
        if sender == 1 and not isinstance(message, Up):
            fresh.receive(2, Up(A, 0.0, 0.0, ()))
        with pytest.raises(InputError, match=words):
            fresh.receive(sender, message)
    faithful = JacobiNode([1], 1, Chooser(Coverage(), WORTH, [A, B]), remove=lambda total, own: total)
    faithful.start()
    with pytest.raises(InputError, match="without the team's total"):
        faithful.receive(1, Down(None))

"""The token in two orders from one beginning: the better of both, by the sequential reference."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from vedette import Coverage, Tree, exhaustive, negotiate
from vedette.negotiation import Negotiation

Float = NDArray[np.float64]
SEEDS = st.integers(0, 2**32 - 1)


def team(seed: int, n: int) -> tuple[Float, list[list[Float]], Tree]:
    rng = np.random.default_rng(seed)

    def impact() -> Float:  # no two alike, so that nothing hangs on ties
        return np.where(rng.random(10) < 0.5, rng.uniform(0.0, 0.9, 10), 1.0 - 1e-3 * rng.random(10))

    misses = [[impact() for _ in range(4)] for _ in range(n)]
    return rng.exponential(1.0, 10), misses, Tree.random(n, seed=seed)


def in_turn(weights: Float, misses: list[list[Float]], order: Sequence[int]) -> tuple[list[int], float]:
    """Everybody replies in this order, from nobody, until nobody gains."""
    choice = [-1] * len(misses)

    def value(of: Sequence[int]) -> float:
        left = weights.copy()
        for i, k in enumerate(of):
            left *= misses[i][k] if k >= 0 else 1.0
        return float(weights.sum() - left.sum())

    quiet = 0
    while quiet < len(misses):
        for i in order:
            values = [value([*choice[:i], k, *choice[i + 1 :]]) for k in range(4)]
            best = int(np.argmax(values))
            if choice[i] < 0 or values[best] > values[choice[i]] * (1 + 1e-9):
                choice[i], quiet = best, 1
            else:
                quiet += 1
    return choice, value(choice)


def order_of(outcome: Negotiation, n: int) -> list[int]:
    return [step.platform for step in outcome.history[1 : n + 1] if step.platform is not None]


@settings(deadline=None, max_examples=40)
@given(seed=SEEDS, n=st.integers(1, 7))
def test_it_ends_at_the_better_of_what_both_orders_come_to(seed: int, n: int) -> None:
    weights, misses, tree = team(seed, n)
    token = negotiate(Coverage(), weights, misses, tree)
    both = negotiate(Coverage(), weights, misses, tree, "multistart")
    order = order_of(token, n)
    assert sorted(order) == list(range(n))
    forth, back = in_turn(weights, misses, order), in_turn(weights, misses, order[::-1])
    done = token.bound is not None and token.value >= token.bound * (1 - 1e-9)
    better = forth if done or forth[1] >= back[1] else back
    assert both.value == pytest.approx(better[1])
    assert list(both.choice) == better[0]
    assert both.value >= token.value
    assert both.converged


@settings(deadline=None, max_examples=25)
@given(seed=SEEDS, n=st.integers(1, 4))
def test_the_optimum_is_no_more_than_twice_its_value_and_below_its_bound(seed: int, n: int) -> None:
    weights, misses, tree = team(seed, n)
    both = negotiate(Coverage(), weights, misses, tree, "multistart")
    best = exhaustive(Coverage(), weights, misses).value
    assert both.bound is not None
    assert both.value - 1e-9 <= best <= both.bound + 1e-9
    assert best <= 2 * both.value + 1e-9


def test_where_the_first_order_is_better_everybody_takes_its_strategy_up_again() -> None:
    kept = 0
    for seed in range(60):
        weights, misses, tree = team(seed, 5)
        token = negotiate(Coverage(), weights, misses, tree)
        order = order_of(token, 5)
        if in_turn(weights, misses, order)[1] > in_turn(weights, misses, order[::-1])[1] + 1e-9:
            both = negotiate(Coverage(), weights, misses, tree, "multistart")
            assert both.choice == token.choice
            kept += both.sweeps > token.sweeps
    assert kept > 3


def test_a_second_round_costs_no_more_messages_than_two_and_none_follows_where_the_bound_is_reached() -> None:
    weights, misses, _ = team(3, 6)
    for tree in (Tree.chain(6), Tree.star(6)):
        token = negotiate(Coverage(), weights, misses, tree)
        both = negotiate(Coverage(), weights, misses, tree, "multistart")
        per_sweep = 2 * 5
        assert both.messages <= token.messages + (both.sweeps - token.sweeps + 2) * per_sweep
    apart = [[np.array([0.0, 1.0])], [np.array([1.0, 0.0])]]
    once = negotiate(Coverage(), np.ones(2), apart, Tree.chain(2), "multistart")
    assert once.messages == negotiate(Coverage(), np.ones(2), apart, Tree.chain(2)).messages

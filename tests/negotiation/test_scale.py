"""The unit of the objective is nobody's business: a factor on it changes no choice, message or claim."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.support.random_teams import Float, Longest, informations, misses
from vedette import CountedCoverage, Coverage, LogDet, Negotiation, Objective, Tree, counted, negotiate
from vedette.negotiation import SCHEMES
from vedette.problem import exhaustive


class Times(Objective[Any, Any]):
    """Another objective in another unit."""

    def __init__(self, objective: Objective[Any, Any], factor: float) -> None:
        self._objective, self._factor = objective, factor
        self.monotone, self.submodular = objective.monotone, objective.submodular

    def nothing(self, belief: Any) -> Any:
        return self._objective.nothing(belief)

    def combine(self, a: Any, b: Any) -> Any:
        return self._objective.combine(a, b)

    def value(self, belief: Any, impact: Any) -> float:
        return self._factor * self._objective.value(belief, impact)

    def values(self, belief: Any, others: Any, own: Sequence[Any]) -> Float:
        return self._factor * self._objective.values(belief, others, own)


def coverage(rng: np.random.Generator, n: int) -> tuple[Objective[Any, Any], Any, list[list[Any]]]:
    return Coverage(), rng.uniform(size=12), misses(rng, n, 4)


def counted_coverage(rng: np.random.Generator, n: int) -> tuple[Objective[Any, Any], Any, list[list[Any]]]:
    candidates = [[counted(m) for m in own] for own in misses(rng, n, 4)]
    return CountedCoverage(), rng.uniform(size=12), candidates


def information(rng: np.random.Generator, n: int) -> tuple[Objective[Any, Any], Any, list[list[Any]]]:
    return LogDet(), np.eye(3), informations(rng, n, 4)


def longest(rng: np.random.Generator, n: int) -> tuple[Objective[Any, Any], Any, list[list[Any]]]:
    return Longest(), None, rng.uniform(size=(n, 4)).tolist()


def in_units(result: Negotiation, factor: float) -> Negotiation:
    """The same negotiation with its values in another unit."""
    return replace(
        result,
        value=factor * result.value,
        bound=None if result.bound is None else factor * result.bound,
        history=tuple(replace(step, value=factor * step.value) for step in result.history),
    )


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("problem", [coverage, counted_coverage, information, longest])
@settings(deadline=None, max_examples=20)
@given(seed=st.integers(0, 10_000), n=st.integers(1, 6), k=st.integers(-150, 150), begun=st.booleans())
def test_a_factor_on_the_objective_changes_nothing_but_the_unit(
    problem: Callable[[np.random.Generator, int], tuple[Objective[Any, Any], Any, list[list[Any]]]],
    scheme: str,
    seed: int,
    n: int,
    k: int,
    begun: bool,
) -> None:
    rng, factor = np.random.default_rng(seed), 2.0**k  # a power of two: no rounding differs
    objective, belief, candidates = problem(rng, n)
    tree, start = Tree.random(n, seed=rng), rng.integers(4, size=n).tolist() if begun else None
    plain = negotiate(objective, belief, candidates, tree, scheme, start=start)
    times = negotiate(Times(objective, factor), belief, candidates, tree, scheme, start=start)
    assert times == in_units(plain, factor)
    if n <= 3:
        choice = exhaustive(objective, belief, candidates).choice
        assert exhaustive(Times(objective, factor), belief, candidates).choice == choice


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("worth", [1e-12, 1e-10, 1.0, 1e12])
def test_what_is_worth_little_is_not_worth_nothing(scheme: str, worth: float) -> None:
    neither, left, right = np.ones(2), np.array([0.0, 1.0]), np.array([1.0, 0.0])
    candidates, weights = [[neither, left], [neither, right]], np.full(2, worth)
    result = negotiate(Coverage(), weights, candidates, Tree.chain(2), scheme, start=[0, 0])
    assert (result.choice, result.value, result.bound) == ((1, 1), 2 * worth, 2 * worth)
    assert result.converged


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("worth", [1e-12, 1.0, 1e12])
def test_the_threshold_is_a_share_of_the_present_value(scheme: str, worth: float) -> None:
    weights, choices = np.full(1, worth), []
    candidates = [[np.array([0.5]), np.array([0.42])]]  # seen by half, or by 16 % more than that
    for epsilon in (0.15, 0.17):
        result = negotiate(Coverage(), weights, candidates, Tree.chain(1), scheme, start=[0], epsilon=epsilon)
        assert result.converged
        choices.append(result.choice)
    assert choices == [(1,), (0,)]

"""Few values are asked for, and the round is to the bit the one in which all are."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib import import_module
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.support.random_teams import Float, informations, misses
from vedette import (
    CountedCoverage,
    Coverage,
    LogDet,
    Negotiation,
    Objective,
    Tree,
    counted,
    negotiate,
)
from vedette.negotiation import SCHEMES, Chooser
from vedette.problem.bound import attains, slack_of
from vedette.problem.checked import values_of

Problem = tuple[Objective[Any, Any], Any, list[list[Any]]]


class Eager(Chooser[Any, Any]):
    """Asks for every value every time."""

    def reply(self, others: Any) -> bool:
        """Take the best of all."""
        values = values_of(self._objective, self._belief, others, self._candidates) - self._base
        best = int(np.argmax(values))
        if self.index is not None and attains(values[self.index], values[best], self._epsilon):
            return False
        self.index = best
        return True

    def slack(self, base: Any) -> float:
        """Try all."""
        return slack_of(self._objective, self._belief, base, self._candidates)


class Tiles(Objective[Float, frozenset[int]]):
    """Worth of the tiles that anybody sees."""

    monotone = submodular = True

    def nothing(self, belief: Float) -> frozenset[int]:
        return frozenset()

    def combine(self, a: frozenset[int], b: frozenset[int]) -> frozenset[int]:
        return a | b

    def value(self, belief: Float, impact: frozenset[int]) -> float:
        return float(sum(belief[list(impact)]))


def coverage(rng: np.random.Generator, n: int, k: int) -> Problem:
    return Coverage(), rng.uniform(size=12), misses(rng, n, k)


def coarse_coverage(rng: np.random.Generator, n: int, k: int) -> Problem:
    """Ties everywhere: weights and misses of few values, and every candidate twice."""
    own = [rng.choice([0.0, 0.5, 1.0], (k, 6)) for _ in range(n)]
    return Coverage(), rng.integers(0, 3, 6).astype(float), [[*list(each), *list(each)] for each in own]


def counted_coverage(rng: np.random.Generator, n: int, k: int) -> Problem:
    return CountedCoverage(), rng.uniform(size=12), [[counted(m) for m in own] for own in misses(rng, n, k)]


def information(rng: np.random.Generator, n: int, k: int) -> Problem:
    return LogDet(), np.eye(3), informations(rng, n, k)


def tiles(rng: np.random.Generator, n: int, k: int) -> Problem:
    seen = [[frozenset(rng.integers(0, 9, 3).tolist()) for _ in range(k)] for _ in range(n)]
    return Tiles(), rng.integers(0, 4, 9).astype(float), seen


PROBLEMS = [coverage, coarse_coverage, counted_coverage, information, tiles]


def eagerly(monkeypatch: pytest.MonkeyPatch, run: Callable[[], Negotiation]) -> Negotiation:
    with monkeypatch.context() as patch:
        patch.setattr(import_module("vedette.negotiation.negotiate"), "Chooser", Eager)
        return run()


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("problem", PROBLEMS)
@settings(deadline=None, max_examples=40)
@given(seed=st.integers(0, 2**32 - 1), n=st.integers(1, 7), k=st.integers(1, 14), begun=st.booleans())
def test_a_round_is_to_the_bit_the_one_in_which_every_value_is_asked_for(
    problem: Callable[[np.random.Generator, int, int], Problem],
    scheme: str,
    seed: int,
    n: int,
    k: int,
    begun: bool,
) -> None:
    rng = np.random.default_rng(seed)
    objective, belief, candidates = problem(rng, n, k)
    start = [int(rng.integers(len(own))) for own in candidates] if begun else None

    def run() -> Negotiation:
        tree = Tree.random(n, seed=seed % 1000)
        return negotiate(objective, belief, candidates, tree, scheme, start=start)

    with pytest.MonkeyPatch.context() as monkeypatch:
        assert run() == eagerly(monkeypatch, run)


class Counting(Coverage):
    """Counts the values asked for."""

    asked = 0

    def values(self, belief: Float, others: Float, own: Sequence[Float]) -> Float:
        self.asked += len(own)
        return super().values(belief, others, own)


def discs(n: int, k: int) -> tuple[Float, list[list[Float]]]:
    """Looks of n platforms, each at k places about its own, in a field of 40 x 40 cells."""
    rng = np.random.default_rng(0)
    rows, cols = np.mgrid[:40, :40]
    candidates = []
    for home in rng.uniform(5, 35, (n, 2)):
        places = home + rng.uniform(-9, 9, (k, 2))
        near = [(rows - row) ** 2 + (cols - col) ** 2 < 16 for row, col in places]
        candidates.append([np.where(seen, 0.3, 1.0).ravel() for seen in near])
    return rng.uniform(size=1600), candidates


@pytest.mark.parametrize(("scheme", "share"), [("token", 0.42), ("jacobi", 0.28)])
def test_less_than_a_share_of_the_values_is_asked_for(
    scheme: str, share: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    weights, candidates = discs(12, 40)
    some, every = Counting(), Counting()
    result = negotiate(some, weights, candidates, Tree.chain(12), scheme)
    eager = eagerly(monkeypatch, lambda: negotiate(every, weights, candidates, Tree.chain(12), scheme))
    assert result == eager
    assert some.asked < share * every.asked


def test_an_objective_that_promises_nothing_is_asked_for_all() -> None:
    weights, candidates = discs(4, 20)
    objective = Counting()
    objective.submodular = False
    result = negotiate(objective, weights, candidates, Tree.chain(4))
    assert objective.asked >= len(result.history[1:]) * 20

"""A weighted sum of objectives: what it promises, by brute force over small teams."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.support.random_teams import Longest, informations, misses
from vedette import Coverage, InputError, LogDet, Tree, exhaustive, negotiate
from vedette.problem.mixed import PartsCodec, WeightedSum
from vedette.testing import LawBroken, check_objective

Team = list[list[tuple[Any, Any]]]


def mixed_team(seed: int, n: int, k: int) -> tuple[tuple[Any, Any], Team]:
    """Belief and candidates of platforms that see cells, or measure a state, or do both."""
    rng = np.random.default_rng(seed)
    seen, measured = misses(rng, n, k, cells=5), informations(rng, n, k, d=2)
    nothing = np.ones(5), np.zeros((2, 2))
    team: Team = []
    for i in range(n):
        kind = rng.integers(3)  # 0: sees alone, 1: measures alone, 2: both
        team.append(
            [
                (seen[i][j] if kind != 1 else nothing[0], measured[i][j] if kind != 0 else nothing[1])
                for j in range(k)
            ]
        )
    return (rng.uniform(size=5), np.eye(2)), team


MIXED = WeightedSum((Coverage(), LogDet()), (2.0, 0.5))


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10**6))
def test_a_sum_keeps_all_laws_that_its_parts_keep(seed: int) -> None:
    belief, team = mixed_team(seed, 3, 2)
    check_objective(MIXED, belief, [own for platform in team for own in platform])
    assert (MIXED.monotone, MIXED.submodular) == (True, True)


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10**6))
def test_returns_diminish_by_brute_force_over_all_subsets_of_a_team(seed: int) -> None:
    belief, team = mixed_team(seed, 5, 1)
    own = [platform[0] for platform in team]

    def value(members: tuple[int, ...]) -> float:  # by the parts' own formulas, not by the sum's code
        miss = np.prod([own[i][0] for i in members], axis=0) if members else np.ones(5)
        information = belief[1] + sum((own[i][1] for i in members), np.zeros((2, 2)))
        gained = 0.5 * (np.linalg.slogdet(information)[1] - np.linalg.slogdet(belief[1])[1])
        return float(2.0 * belief[0] @ (1.0 - miss) + 0.5 * gained)

    for size in range(5):
        for some in itertools.combinations(range(5), size):
            assert sum_of(belief, [own[i] for i in some]) == pytest.approx(value(some), abs=1e-9)
            for more in itertools.combinations([i for i in range(5) if i not in some], 1):
                for x in set(range(5)) - {*some, *more}:
                    gain = value((*some, x)) - value(some)
                    assert gain >= -1e-9
                    assert gain >= value((*some, *more, x)) - value((*some, *more)) - 1e-9


def sum_of(belief: Any, impacts: list[Any]) -> float:
    total = MIXED.nothing(belief)
    for impact in impacts:
        total = MIXED.combine(total, impact)
    return MIXED.value(belief, total)


@settings(max_examples=15, deadline=None)
@given(seed=st.integers(0, 10**6), n=st.integers(2, 4))
def test_one_negotiation_of_a_mixed_team_reaches_half_of_the_optimum_and_its_bound_holds(
    seed: int, n: int
) -> None:
    belief, team = mixed_team(seed, n, 3)
    agreed, best = negotiate(MIXED, belief, team, Tree.chain(n)), exhaustive(MIXED, belief, team)
    assert agreed.value >= 0.5 * best.value - 1e-9
    assert agreed.bound is not None
    assert agreed.bound >= best.value - 1e-9


def test_weights_decide_who_wins() -> None:
    belief = np.ones(1), np.eye(1)
    looks, measures = (np.zeros(1), np.zeros((1, 1))), (np.ones(1), np.eye(1))  # worth 1, and ln(2) / 2
    for weights, best in (((1.0, 1.0), 0), ((1.0, 3.0), 1), ((0.0, 1.0), 1)):
        mixed = WeightedSum((Coverage(), LogDet()), weights)
        assert exhaustive(mixed, belief, [[looks, measures]]).choice == (best,)


def test_a_part_that_promises_nothing_takes_the_promise_from_the_sum_unless_it_does_not_count() -> None:
    assert not WeightedSum((Coverage(), Longest()), (1.0, 1.0)).monotone
    idle = WeightedSum((Coverage(), Longest()), (1.0, 0.0))
    assert (idle.monotone, idle.submodular) == (True, True)
    check_objective(idle, (np.ones(2), None), [(np.array([0.5, 1.0]), 3.0), (np.array([0.0, 0.5]), 1.0)])


class Liar(Longest):
    """Claims what it does not keep."""

    monotone = True


def test_a_part_that_lies_is_caught_in_the_sum() -> None:
    with pytest.raises(LawBroken, match="not monotone"):
        check_objective(
            WeightedSum((Coverage(), Liar()), (1.0, 1.0)), (np.ones(1), None), [(np.ones(1), 2.0)]
        )


@pytest.mark.parametrize(
    ("objectives", "weights", "said"),
    [
        ((), (), "0 objectives and 0 weights; give a weight each"),
        ((Coverage(),), (1.0, 2.0), "1 objectives and 2 weights"),
        ((Coverage(),), (-1.0,), "weights must be numbers >= 0; got -1.0"),
        ((Coverage(),), (float("nan"),), "weights must be numbers >= 0; got nan"),
        ((Coverage(),), (float("inf"),), "weights must be numbers >= 0; got inf"),
        ((Coverage(),), ("1",), "weights must be numbers >= 0; got '1'"),
    ],
)
def test_weights_that_cannot_be_are_refused(objectives: Any, weights: Any, said: str) -> None:
    with pytest.raises(InputError) as told:
        WeightedSum(objectives, weights)
    assert said in str(told.value)


@pytest.mark.parametrize(
    ("belief", "impact", "said"),
    [
        (np.ones(2), (np.ones(2), np.zeros((2, 2))), "tuple of 2, one for each objective"),
        ((np.ones(2), np.eye(2)), np.ones(2), "tuple of 2, one for each objective"),
        ((np.ones(2), np.eye(2)), (np.ones(3), np.zeros((2, 2))), "(3,)"),
        ((np.array([1.0, np.nan]), np.eye(2)), (np.ones(2), np.zeros((2, 2))), "nan"),
    ],
)
def test_beliefs_and_impacts_that_do_not_fit_are_told_in_a_line(belief: Any, impact: Any, said: str) -> None:
    with pytest.raises(InputError) as told:
        negotiate(MIXED, belief, [[impact], [impact]], Tree.chain(2))
    assert said in str(told.value)
    assert "\n" not in str(told.value)


class Letters:
    """A codec of words."""

    def encode(self, impact: str) -> bytes:
        return impact.encode()

    def decode(self, data: bytes) -> str:
        return data.decode("ascii")


CODEC = PartsCodec((Letters(), Letters()))


@given(st.text(alphabet="ab", max_size=9), st.text(alphabet="ab", max_size=9))
def test_parts_travel_as_they_are(first: str, second: str) -> None:
    assert CODEC.decode(CODEC.encode((first, second))) == (first, second)


@given(st.binary(max_size=20))
def test_bytes_that_are_no_parts_are_refused(data: bytes) -> None:
    try:
        impact = CODEC.decode(data)
    except ValueError:
        return
    assert CODEC.encode(impact) == data

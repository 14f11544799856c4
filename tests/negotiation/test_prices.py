"""Strategies with prices: schemes ascend in what they announce, and promises hold. By brute force.

docs/theory.md, section 14
"""

from __future__ import annotations

import itertools
from functools import reduce

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.support.priced import PRICED, PricedCoverage, Team
from tests.support.random_teams import Float
from vedette import Tree, bound, exhaustive, negotiate
from vedette.problem import Controls, Objective, diagonally_dominant
from vedette.problem.thinned import Thinned
from vedette.testing import check_objective

SEEDS = st.integers(0, 100_000)
ASCENDING = ["token", "multistart", "fork", "async"]


@settings(deadline=None, max_examples=20)
@given(seed=SEEDS)
def test_prices_keep_the_laws_of_what_they_are_taken_off(seed: int) -> None:
    team = Team.random(np.random.default_rng(seed), 2, 4)
    check_objective(PRICED, team.weights, [impact for own in team.candidates for impact in own])
    thinned = Thinned(PRICED, 3)
    check_objective(thinned, team.weights, [thinned.copies(impact) for impact in team.candidates[0]])


def test_an_objective_whose_prices_do_not_add_up_is_found_out() -> None:
    class Once(PricedCoverage):
        def price(self, impact: Float) -> float:
            return float(min(impact[-1], 0.5))

    impacts = [np.array([0.5, 0.4]), np.array([0.2, 0.3])]
    with pytest.raises(AssertionError, match="sum of their prices"):
        check_objective(Once(), np.ones(1), impacts)
    with pytest.raises(AssertionError, match="below 0"):
        check_objective(PRICED, np.ones(1), [np.array([0.5, -0.4])])


@settings(deadline=None, max_examples=60)
@given(
    seed=SEEDS, n=st.integers(1, 7), scheme=st.sampled_from(ASCENDING), dear=st.sampled_from([0.3, 2.0, 9.0])
)
def test_what_is_announced_never_falls_is_true_and_ends_where_nobody_gains_alone(
    seed: int, n: int, scheme: str, dear: float
) -> None:
    rng = np.random.default_rng(seed)
    team = Team.random(rng, n, 4, dear=dear)
    start = rng.integers(4, size=n).tolist()
    tree = Tree.random(n, seed=rng)
    result = negotiate(PRICED, team.weights, team.candidates, tree, scheme, start=start)
    assert result.history[0].value == pytest.approx(team.worth(start))
    values = [step.value for step in result.history]
    if scheme == "async":
        del values[0]  # who is first replies before all have joined
    if scheme != "multistart":  # which begins twice
        assert all(later >= earlier - 1e-9 for earlier, later in itertools.pairwise(values))
    assert result.value == pytest.approx(team.worth(result.choice), abs=1e-9)
    assert result.value >= values[0] - 1e-9
    assert result.converged
    best = max(map(team.worth, team.alternatives(result.choice)))
    assert best <= result.value + 1e-8 * max(1.0, abs(result.value))


@settings(deadline=None, max_examples=30)
@given(seed=SEEDS, n=st.integers(1, 5))
def test_all_at_once_ends_at_the_best_of_what_was_tried(seed: int, n: int) -> None:
    rng = np.random.default_rng(seed)
    team = Team.random(rng, n, 4)
    start = rng.integers(4, size=n).tolist()
    result = negotiate(PRICED, team.weights, team.candidates, Tree.random(n, seed=rng), "jacobi", start=start)
    assert result.value == pytest.approx(team.worth(result.choice), abs=1e-9)
    assert result.value >= max(step.value for step in result.history) - 1e-9


@settings(deadline=None, max_examples=30)
@given(seed=SEEDS, n=st.integers(2, 7), scheme=st.sampled_from(ASCENDING))
def test_where_messages_leave_out_what_matters_to_nobody_the_announced_value_still_is_that_of_all(
    seed: int, n: int, scheme: str
) -> None:
    rng = np.random.default_rng(seed)
    team = Team.random(rng, n, 4)
    first = rng.integers(0, 9, size=n)
    for own, low in zip(team.candidates, first, strict=True):
        for k, impact in enumerate(own):
            near = (np.arange(13) >= low) & (np.arange(13) <= low + 3) | (np.arange(13) == 12)
            own[k] = np.where(near, impact, 1.0)
    reach = [((float(low), 0.0, float(low + 3), 0.0),) for low in first]
    start = rng.integers(4, size=n).tolist()
    tree = Tree.random(n, seed=rng)
    clipped = negotiate(PRICED, team.weights, team.candidates, tree, scheme, start=start, reach=reach)
    assert clipped.value == pytest.approx(team.worth(clipped.choice), abs=1e-9)
    whole = negotiate(PRICED, team.weights, team.candidates, tree, scheme, start=start)
    assert clipped.converged
    assert whole.value == pytest.approx(team.worth(whole.choice), abs=1e-9)
    if scheme == "token":
        assert clipped.choice == whole.choice


def test_only_a_first_choice_can_lower_the_value_if_none_is_free() -> None:
    dear = [[np.array([0.5, 2.0])]]
    assert negotiate(PRICED, np.ones(1), dear, Tree.chain(1)).value == -1.5


# -- at an equilibrium ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(25))
def test_at_every_equilibrium_twice_the_gain_less_the_price_is_no_less_than_the_optimum(seed: int) -> None:
    team = Team.random(np.random.default_rng(seed), 3, 4, cells=6)
    best = team.optimum()
    found = list(team.equilibria())
    assert found
    for choice in found:
        gain, price = team.gross(choice), team.price(choice)
        assert 2.0 * gain - price >= best - 1e-9
        if best > 0.0:
            share = price / gain
            assert gain - price >= (1.0 - share) / (2.0 - share) * best - 1e-9


def test_no_share_of_the_optimum_is_promised_where_a_choice_just_pays() -> None:
    slight = 0.01
    see, free, stay = np.array([0.0, 1.0 - slight]), np.array([0.0, 0.0]), np.array([1.0, 0.0])
    team = Team(np.ones(1), [[see, stay], [stay, free]])
    assert team.is_equilibrium((0, 0))
    assert team.worth((0, 0)) == pytest.approx(slight)
    assert team.optimum() == team.worth((1, 1)) == 1.0
    assert 2.0 * team.gross((0, 0)) - team.price((0, 0)) == pytest.approx(1.0 + slight)
    assert team.worth((0, 0)) < 0.5 * team.gross((1, 1)) - team.price((1, 1))
    assert not team.is_equilibrium((0, 0), counts=2.0)


@pytest.mark.parametrize("seed", range(25))
def test_where_replies_count_prices_twice_half_of_any_gain_less_its_whole_price_is_promised(
    seed: int,
) -> None:
    team = Team.random(np.random.default_rng(seed), 3, 4, cells=6, dear=1.0)
    most = max(0.5 * team.gross(other) - team.price(other) for other in team.choices())
    found = list(team.equilibria(counts=2.0))
    assert found
    assert all(team.worth(choice) >= most - 1e-9 for choice in found)


@pytest.mark.parametrize("copies", [1, 2, 4])
@pytest.mark.parametrize("seed", range(8))
def test_at_an_equilibrium_of_the_potential_its_share_of_the_optimum_is_kept_less_of_the_price(
    copies: int, seed: int
) -> None:
    thinned = Thinned(PRICED, copies)
    share = thinned.guarantee
    for counts in (1.0, 1.0 / share):  # how often prices do
        team = Team.random(np.random.default_rng(seed), 3, 3, cells=6, dear=1.0)
        for impact in itertools.chain(*team.candidates):
            impact[-1] *= counts
        tuples = [[thinned.copies(impact) for impact in own] for own in team.candidates]
        potential = {
            choice: thinned.value(
                team.weights,
                reduce(thinned.combine, [own[k] for own, k in zip(tuples, choice, strict=True)]),
            )
            for choice in team.choices()
        }
        best = team.optimum()
        ends = [
            choice
            for choice, here in potential.items()
            if all(potential[other] <= here + 1e-12 for other in team.alternatives(choice))
        ]
        assert ends
        for choice in ends:
            assert team.gross(choice) - share * team.price(choice) >= share * best - 1e-9


# -- the bound -----------------------------------------------------------------------------------------------


@settings(deadline=None, max_examples=60)
@given(
    seed=SEEDS,
    n=st.integers(1, 4),
    scheme=st.sampled_from([*ASCENDING, "jacobi"]),
    dear=st.sampled_from([0.3, 2.0, 9.0]),
)
def test_the_optimum_is_below_the_bound_of_every_scheme(seed: int, n: int, scheme: str, dear: float) -> None:
    rng = np.random.default_rng(seed)
    team = Team.random(rng, n, 4, dear=dear)
    start = rng.integers(4, size=n).tolist() if seed % 2 else None
    result = negotiate(PRICED, team.weights, team.candidates, Tree.random(n, seed=rng), scheme, start=start)
    best = team.optimum()
    assert exhaustive(PRICED, team.weights, team.candidates).value == pytest.approx(best)
    assert result.bound is not None
    assert result.value - 1e-9 <= best <= result.bound + 1e-9


@settings(deadline=None, max_examples=30)
@given(seed=SEEDS, n=st.integers(1, 3))
def test_the_bound_at_any_choice_is_no_less_than_the_optimum(seed: int, n: int) -> None:
    team = Team.random(np.random.default_rng(seed), n, 3)
    best = team.optimum()
    for choice in team.choices():
        most = bound(PRICED, team.weights, team.candidates, choice)
        assert most is not None
        assert most >= best - 1e-9


def test_without_the_price_added_again_some_optimum_would_be_above_its_bound() -> None:
    below = 0
    for seed in range(40):
        team = Team.random(np.random.default_rng(seed), 3, 4)
        best = team.optimum()
        for choice in team.equilibria():
            here = [own[k] for own, k in zip(team.candidates, choice, strict=True)]
            base = reduce(PRICED.combine, here)
            value = PRICED.value(team.weights, base)
            slacks = [
                max(0.0, PRICED.values(team.weights, base, own).max() - value) for own in team.candidates
            ]
            assert value + team.price(choice) + sum(slacks) >= best - 1e-9
            below += value + sum(slacks) < best - 1e-9
    assert below > 0


def test_where_nobody_gets_into_anybodys_way_the_bound_is_attained() -> None:
    cells = np.eye(3)
    candidates = [[np.append(1.0 - cells[i], 0.25), np.append(np.ones(3), 0.0)] for i in range(3)]
    result = negotiate(PRICED, np.ones(3), candidates, Tree.chain(3))
    assert result.value == result.bound == 2.25
    assert result.sweeps == 1


# -- continuous controls -------------------------------------------------------------------------------------


class Coupled(Objective[Float, tuple[Float, float]]):
    """``b x - x C x / 2`` less prices: x has a number of each platform."""

    def nothing(self, belief: Float) -> tuple[Float, float]:
        """All at rest."""
        return np.zeros(len(belief)), 0.0

    def combine(self, a: tuple[Float, float], b: tuple[Float, float]) -> tuple[Float, float]:
        """Sums."""
        return a[0] + b[0], a[1] + b[1]

    def value(self, belief: Float, impact: tuple[Float, float]) -> float:
        """A quadratic form, less the price."""
        x, price = impact
        return float(x.sum() - 0.5 * x @ belief @ x - price)

    def price(self, impact: tuple[Float, float]) -> float:
        """The second."""
        return impact[1]


def test_a_price_that_curves_counts_in_the_diagonal_of_the_papers_condition() -> None:
    n, coupling = 4, 0.5
    hessian = np.full((n, n), coupling) + (1.0 - coupling) * np.eye(n)

    def controls(curve: float) -> list[Controls[tuple[Float, float]]]:
        return [
            Controls(
                lambda u, i=i: (np.eye(n)[i] * u[0], 0.5 * curve * float(u[0]) ** 2),  # type: ignore[misc]
                low=np.zeros(1),
                high=np.ones(1),
                start=np.full(1, 0.5),
                threshold=1e-6,
            )
            for i in range(n)
        ]

    free = diagonally_dominant(Coupled(), hessian, controls(0.0))
    dear = diagonally_dominant(Coupled(), hessian, controls(1.0))
    assert free.share == pytest.approx(coupling * (n - 1), rel=1e-3)
    assert dear.share == pytest.approx(coupling * (n - 1) / 2.0, rel=1e-3)
    assert (free.holds, dear.holds) == (False, True)

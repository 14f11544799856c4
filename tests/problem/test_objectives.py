"""Objectives, the exhaustive reference and the bound against closed forms and brute force."""

from __future__ import annotations

import itertools
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.support.random_teams import Float, informations, misses
from vedette import CountedCoverage, Coverage, InputError, LogDet, Objective, bound, counted, exhaustive
from vedette.problem import seen
from vedette.problem.checked import values_of


class Cost(Objective[None, float]):
    """Costs add and count against the team: not monotone."""

    def nothing(self, belief: None) -> float:
        return 0.0

    def combine(self, a: float, b: float) -> float:
        return a + b

    def value(self, belief: None, impact: float) -> float:
        return -impact


def test_coverage_is_the_expected_weight_of_cells_that_somebody_sees() -> None:
    rng = np.random.default_rng(0)
    (own,) = zip(*misses(rng, 3, 1, cells=4), strict=True)
    weights = rng.uniform(size=4)
    expected = 0.0  # by enumerating who sees the cell
    for cell, outcome in itertools.product(range(4), itertools.product((0, 1), repeat=3)):
        p = np.prod([m[cell] if missed else 1 - m[cell] for m, missed in zip(own, outcome, strict=True)])
        expected += float(p) * weights[cell] * (0 in outcome)
    team = own[0] * own[1] * own[2]
    assert Coverage().value(weights, team) == pytest.approx(expected, abs=1e-12)


def test_coverage_over_time_layers_is_the_weight_of_the_first_sight() -> None:
    arrivals, layers, weight = [2, 0, 3], 4, np.array([8.0, 4.0, 2.0, 1.0])  # worth of a first sight at t
    share = weight - np.append(weight[1:], 0.0)  # of each layer: telescopes to weight[first]
    team = np.ones((layers, 1))
    for t in arrivals:
        team = Coverage().combine(team, (np.arange(layers) < t).astype(float)[:, None])
    assert Coverage().value(share[:, None], team) == weight[min(arrivals)]


def test_what_is_seen_of_a_counted_impact_is_what_is_not_missed() -> None:
    miss = np.array([[0.0, 1.0, 0.25], [0.5, 1e-9, 0.75]])
    np.testing.assert_allclose(seen(counted(miss)), 1.0 - miss, atol=1e-9)
    assert seen(counted(miss))[0].tolist()[:2] == [1.0, 0.0]


def test_counted_coverage_equals_coverage_and_removes_exactly_even_zeros() -> None:
    rng = np.random.default_rng(1)
    weights, objective = rng.uniform(size=12), CountedCoverage()
    a, b, c = (own[0] for own in misses(rng, 3, 1))
    team = objective.combine(objective.combine(counted(a), counted(b)), counted(c))
    assert objective.value(weights, team) == pytest.approx(Coverage().value(weights, a * b * c), abs=1e-8)
    rest = objective.remove(team, counted(b))
    np.testing.assert_array_equal(rest, objective.combine(counted(a), counted(c)))


def test_log_det_is_the_entropy_that_a_kalman_update_removes() -> None:
    rng = np.random.default_rng(2)
    root = rng.normal(size=(3, 3))
    prior = root @ root.T + np.eye(3)  # covariance
    h, r = rng.normal(size=(2, 3)), np.diag([0.5, 2.0])
    gain = prior @ h.T @ np.linalg.inv(h @ prior @ h.T + r)
    posterior = (np.eye(3) - gain @ h) @ prior
    removed = 0.5 * np.log(np.linalg.det(prior) / np.linalg.det(posterior))
    information: Float = (h.T @ np.linalg.inv(r) @ h).astype(np.float64)
    value = LogDet().value(np.linalg.inv(prior).astype(np.float64), information)
    assert value == pytest.approx(removed, abs=1e-10)


def test_log_det_of_an_improper_prior_is_refused() -> None:
    with pytest.raises(InputError, match="positive definite"):
        LogDet().value(np.zeros((2, 2)), np.zeros((2, 2)))


@pytest.mark.parametrize("shape", [(1, 1), (1, 5), (3, 4), (5, 2)])
def test_exhaustive_finds_the_first_best_of_all_joint_choices(shape: tuple[int, int]) -> None:
    rng = np.random.default_rng(3)
    weights, candidates = rng.uniform(size=12), misses(rng, *shape)
    values = {
        choice: Coverage().value(
            weights, np.prod([own[k] for own, k in zip(candidates, choice, strict=True)], 0)
        )
        for choice in itertools.product(range(shape[1]), repeat=shape[0])
    }
    best = exhaustive(Coverage(), weights, candidates)
    assert best.value == pytest.approx(max(values.values()), abs=1e-12)
    assert best.choice == max(values, key=values.__getitem__)


def test_exhaustive_takes_lists_of_different_lengths_and_many_platforms() -> None:
    weights = np.ones(3)
    sees = [np.where(np.arange(3) == cell, 0.0, 1.0) for cell in range(3)]
    lone = [[np.ones(3)]] * 1500  # as deep as no recursion would go
    best = exhaustive(Coverage(), weights, [*lone, sees[:2], sees])
    assert (best.value, best.choice[-2:]) == (2.0, (0, 1))


@settings(deadline=None, max_examples=40)
@given(seed=st.integers(0, 10_000), n=st.integers(1, 4), k=st.integers(1, 4))
def test_the_bound_is_never_below_the_optimum(seed: int, n: int, k: int) -> None:
    rng = np.random.default_rng(seed)
    choice = rng.integers(k, size=n).tolist()
    weights, candidates = rng.uniform(size=12), misses(rng, n, k)
    above = bound(Coverage(), weights, candidates, choice)
    assert above is not None
    assert above >= exhaustive(Coverage(), weights, candidates).value - 1e-12
    gaussian = informations(rng, n, k)
    above = bound(LogDet(), np.eye(3), gaussian, choice)
    assert above is not None
    assert above >= exhaustive(LogDet(), np.eye(3), gaussian).value - 1e-12


def test_the_bound_is_the_optimum_where_platforms_do_not_interact() -> None:
    rng = np.random.default_rng(4)
    candidates = [[np.ones(12) for _ in range(3)] for _ in range(4)]
    for i, own in enumerate(candidates):
        for impact in own:
            impact[3 * i : 3 * i + 3] = rng.uniform(size=3)
    weights = rng.uniform(size=12)
    best = exhaustive(Coverage(), weights, candidates)
    assert bound(Coverage(), weights, candidates, best.choice) == pytest.approx(best.value, abs=1e-12)


def test_there_is_no_bound_without_the_declaration() -> None:
    assert bound(Cost(), None, [[1.0, 2.0]], [0]) is None


class Broken(Cost):
    """Returns one number that is not finite."""

    def value(self, belief: None, impact: float) -> float:
        return float("nan") if impact == 3.0 else impact


class WrongShape(Cost):
    """Returns a matrix of values."""

    def values(self, belief: None, others: float, own: object) -> Float:
        return np.zeros((2, 2))


def test_bad_input_is_one_line_that_names_it() -> None:
    cases: list[tuple[Callable[[], object], str]] = [
        (lambda: exhaustive(Cost(), None, []), "team needs at least one"),
        (lambda: exhaustive(Cost(), None, [[1.0], []]), r"candidates\[1\] is empty"),
        (lambda: exhaustive(Cost(), None, [[0.0] * 10] * 7), "10000000 combinations"),
        (lambda: exhaustive(Broken(), None, [[0.0], [1.0, 3.0]]), r"Broken.values returned nan for own\[1\]"),
        (lambda: values_of(WrongShape(), None, 0.0, [1.0, 2.0]), r"returned shape \(2, 2\) for 2 impacts"),
        (lambda: bound(Cost(), None, [[1.0]], [0, 0]), "choice has 2 for 1 platform;"),
        (lambda: bound(Cost(), None, [[1.0]], [1]), r"choice\[0\] = 1"),
        (lambda: counted(np.array([0.5, 1.5])), r"in \[0, 1\]; got 1.5"),
        (lambda: counted(np.array([np.nan])), "got nan"),
    ]
    for call, words in cases:
        with pytest.raises(InputError, match=words) as caught:
            call()
        assert "\n" not in str(caught.value)

"""The potential of non-oblivious local search is a mean over who is there, and its equilibria are better."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from functools import reduce

import numpy as np
import pytest
from numpy.typing import NDArray

from vedette import Coverage, LogDet, Tree, exhaustive, negotiate
from vedette.errors import InputError
from vedette.problem.thinned import Thinned
from vedette.testing import check_objective

Float = NDArray[np.float64]
COVERAGE = Coverage()


def team(seed: int, platforms: int = 3, choices: int = 3, cells: int = 6) -> tuple[Float, list[list[Float]]]:
    """Soft and certain misses of random cells."""
    rng = np.random.default_rng(seed)

    def impact() -> Float:
        return np.where(rng.random(cells) < 0.4, rng.choice([0.0, 0.3, 0.7], cells), 1.0)

    return rng.exponential(1.0, cells), [[impact() for _ in range(choices)] for _ in range(platforms)]


def worth(weights: Float, impacts: Sequence[Float]) -> float:
    return float(weights @ (1.0 - reduce(np.multiply, impacts, np.ones_like(weights))))


@pytest.mark.parametrize("copies", [1, 2, 4])
def test_the_potential_is_the_weighted_mean_over_everybody_being_there_or_not(copies: int) -> None:
    weights, candidates = team(1, platforms=4)
    chosen = [own[0] for own in candidates]
    expected = 0.0
    for j in range(1, copies + 1):
        p = j / copies
        mean = 0.0
        for there in itertools.product((False, True), repeat=4):
            some = [impact for impact, comes in zip(chosen, there, strict=True) if comes]
            mean += p ** len(some) * (1.0 - p) ** (4 - len(some)) * worth(weights, some)
        expected += (1.0 + 1.0 / copies) ** j / p * mean
    thinned = Thinned(COVERAGE, copies)
    together = reduce(thinned.combine, map(thinned.copies, chosen))
    assert thinned.value(weights, together) == pytest.approx(expected)
    np.testing.assert_array_equal(together[-1], reduce(np.multiply, chosen))


@pytest.mark.parametrize("copies", [1, 2, 3, 8])
def test_every_equilibrium_of_the_potential_is_worth_its_share_of_the_optimum(copies: int) -> None:
    thinned = Thinned(COVERAGE, copies)
    assert thinned.guarantee == pytest.approx(1.0 - (copies / (copies + 1)) ** copies)
    for seed in range(12):
        weights, candidates = team(seed)
        best = exhaustive(COVERAGE, weights, candidates).value
        tuples = [[thinned.copies(impact) for impact in own] for own in candidates]

        def potential(choice: Sequence[int], tuples: list[list[tuple[Float, ...]]] = tuples) -> float:
            together = reduce(thinned.combine, [own[k] for own, k in zip(tuples, choice, strict=True)])
            return thinned.value(weights, together)  # noqa: B023

        for choice in itertools.product(range(3), repeat=3):
            here = potential(choice)
            others = [(*choice[:i], k, *choice[i + 1 :]) for i in range(3) for k in range(3)]
            if all(potential(other) <= here + 1e-12 for other in others):
                chosen = [own[k] for own, k in zip(candidates, choice, strict=True)]
                assert worth(weights, chosen) >= thinned.guarantee * best - 1e-9


def test_where_plain_replies_stop_at_half_the_potential_goes_on() -> None:
    weights = np.ones(2)
    here, there, nowhere = np.array([0.0, 1.0]), np.array([1.0, 0.0]), np.ones(2)
    candidates = [[here, there], [nowhere, here]]
    plain = negotiate(COVERAGE, weights, candidates, Tree.chain(2), start=[0, 0])
    assert plain.converged
    assert plain.value == 1.0
    thinned = Thinned(COVERAGE, 3)
    tuples = [[thinned.copies(impact) for impact in own] for own in candidates]
    found = negotiate(thinned, weights, tuples, Tree.chain(2), start=[0, 0])
    assert negotiate(COVERAGE, weights, candidates, Tree.chain(2), start=found.choice).value == 2.0


def test_more_copies_promise_more_towards_one_less_a_share_of_e() -> None:
    shares = [Thinned(COVERAGE, copies).guarantee for copies in (1, 2, 3, 10, 1000)]
    assert shares == sorted(shares)
    assert shares[0] == 0.5
    assert shares[-1] == pytest.approx(1.0 - 1.0 / math.e, abs=1e-3)


def test_the_potential_keeps_the_laws_that_it_declares() -> None:
    weights, candidates = team(2)
    thinned = Thinned(COVERAGE, 3)
    check_objective(thinned, weights, [thinned.copies(own[0]) for own in candidates])


def test_what_cannot_be_thinned_is_refused() -> None:
    with pytest.raises(InputError, match=r"Thinned needs LogDet\.thin\(impact, chance\)"):
        Thinned(LogDet(), 2)
    with pytest.raises(InputError, match="copies must be a whole number >= 1; got 0"):
        Thinned(COVERAGE, 0)
    thinned = Thinned(COVERAGE, 2)
    assert thinned.wrong_impact(np.ones(2), [(np.ones(2),)]) is not None

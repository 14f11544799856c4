"""Platforms that may end up elsewhere: exact means for coverage, draws for information."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from numpy.typing import NDArray

from vedette import Coverage, InputError, LogDet, Tree, exhaustive, negotiate
from vedette.problem.sampled import Sampled, SampledCodec, mean_miss
from vedette.testing import check_objective

Float = NDArray[np.float64]


class Plain:
    def encode(self, impact: Float) -> bytes:
        return impact.tobytes()

    def decode(self, data: bytes) -> Float:
        return np.frombuffer(data).reshape(2, 2)


def bearings(rng: np.random.Generator, count: int) -> list[Float]:
    h = rng.normal(size=(count, 2))
    return list(np.einsum("ki,kj->kij", h, h))


def test_for_coverage_the_mean_of_the_misses_is_the_mean_of_the_value_over_all_outcomes_of_all() -> None:
    rng = np.random.default_rng(1)
    weights, chances = rng.uniform(size=8), rng.dirichlet(np.ones(3), size=2)
    outcomes = rng.uniform(size=(2, 3, 8))  # of two platforms, three places each
    means = [mean_miss(list(zip(chances[i].tolist(), outcomes[i], strict=True))) for i in range(2)]
    expected = sum(
        chances[0, a] * chances[1, b] * Coverage().value(weights, outcomes[0, a] * outcomes[1, b])
        for a, b in itertools.product(range(3), repeat=2)
    )
    assert Coverage().value(weights, means[0] * means[1]) == pytest.approx(expected, abs=1e-12)


def test_for_information_the_mean_impact_overstates_and_draws_come_near_the_mean_over_all_outcomes() -> None:
    rng = np.random.default_rng(2)
    prior, places = np.eye(2), [bearings(rng, 4), bearings(rng, 4)]  # equally likely each
    exact = np.mean([LogDet().value(prior, a + b) for a, b in itertools.product(*places)])
    mean = LogDet().value(prior, np.mean(places[0], axis=0) + np.mean(places[1], axis=0))
    assert mean > 1.05 * exact
    errors = []
    for samples in (16, 4096):
        drawn = Sampled(LogDet(), samples)
        own = [tuple(place[k] for k in rng.integers(4, size=samples)) for place in places]
        errors.append(abs(drawn.value(prior, drawn.combine(*own)) / exact - 1.0))
    assert errors[1] < 0.01


def test_draws_keep_the_laws_and_what_the_objective_beneath_declares() -> None:
    rng = np.random.default_rng(3)
    drawn = Sampled(LogDet(), 3)
    impacts = [tuple(bearings(rng, 3)) for _ in range(4)]
    check_objective(drawn, np.eye(2), [*impacts, drawn.nothing(np.eye(2))])
    assert (drawn.monotone, drawn.submodular) == (True, True)


def test_draws_travel_and_are_so_many_times_as_long() -> None:
    rng = np.random.default_rng(4)
    candidates = [[bearings(rng, 1)[0] for _ in range(3)] for _ in range(4)]
    one = negotiate(LogDet(), np.eye(2), candidates, Tree.chain(4), codec=Plain())
    many = [[(impact,) * 8 for impact in own] for own in candidates]  # the same draw eight times
    codec = SampledCodec(Plain(), 8)
    eight = negotiate(Sampled(LogDet(), 8), np.eye(2), many, Tree.chain(4), codec=codec)
    assert (eight.choice, eight.value, eight.messages) == (one.choice, pytest.approx(one.value), one.messages)
    single = len(Plain().encode(candidates[0][0]))
    assert 8 * single <= len(codec.encode(many[0][0])) <= 8 * (single + 6)


def test_uncertain_motion_changes_who_looks_where() -> None:
    prior = np.diag([1.0, 1.0])
    east, north = np.diag([9.0, 0.0]), np.diag([0.0, 9.0])
    sure = [[east, north], [east * 0.8, north * 0.8]]
    assert exhaustive(LogDet(), prior, sure).choice == (0, 1)
    slips = [[(east, north), (north, north)], [(east * 0.8, east * 0.8), (north * 0.8, north * 0.8)]]
    drawn = Sampled(LogDet(), 2)  # who goes east ends up north one time in two
    assert exhaustive(drawn, prior, slips).choice == (1, 0)


def test_what_is_no_draw_is_refused() -> None:
    drawn = Sampled(LogDet(), 2)
    with pytest.raises(InputError, match="must be a tuple of 2 samples"):
        negotiate(drawn, np.eye(2), [[(np.eye(2),)]], Tree.chain(1))
    with pytest.raises(InputError, match="sample 1: information must have shape"):
        negotiate(drawn, np.eye(2), [[(np.eye(2), np.eye(3))]], Tree.chain(1))
    with pytest.raises(InputError, match="samples must be a whole number >= 1; got 0"):
        Sampled(LogDet(), 0)
    with pytest.raises(InputError, match="must sum to 1"):
        mean_miss([(0.5, np.ones(2)), (0.6, np.ones(2))])
    with pytest.raises(ValueError, match="1 samples; want 2"):
        SampledCodec(Plain(), 2).decode(SampledCodec(Plain(), 1).encode((np.eye(2),)))

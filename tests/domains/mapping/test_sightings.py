"""Sighting models: the beam product of the paper's Fig. 3, and the curve that scans teach."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from vedette.domains.mapping.sightings import (
    BERTHS,
    BIN,
    BINS,
    PRIOR_DEPTH,
    beam_model,
    empty_counts,
    measured_model,
    non_increasing,
    pooled,
)

seeds = st.integers(0, 2**32 - 1)
DEPTHS = (np.arange(BINS) + 0.5) * BIN


def counts_of(curve: NDArray[np.float64], trials: int, rng: np.random.Generator) -> NDArray[np.int64]:
    tried = np.full(BINS, trials)
    by_berth = [np.array([tried, rng.binomial(tried, curve**power)]) for power in range(2, 2 + BERTHS)]
    return np.concatenate(([tried, rng.binomial(tried, curve)], *by_berth)).astype(np.int64)


def test_the_beam_model_halves_with_every_unknown_cell_as_in_the_papers_figure_3() -> None:
    model = beam_model(80)
    np.testing.assert_allclose(model.table, [0.5 ** np.arange(81)], rtol=1e-6)
    assert model.table[0, 10] < 1e-3  # 1 m of 10 cm cells
    assert not model.by_distance


@settings(deadline=None, max_examples=50)
@given(seeds, st.booleans())
def test_a_measured_curve_is_a_probability_and_never_rises(seed: int, by_distance: bool) -> None:
    rng = np.random.default_rng(seed)
    counts = empty_counts()
    counts[0::2] = rng.integers(0, rng.choice([2, 100, 10**6]), counts[0::2].shape)
    counts[1::2] = rng.integers(0, counts[0::2] + 1)
    model = measured_model(counts, float(rng.choice([0.03, 0.1, 0.4])), 200, by_distance=by_distance)
    assert model.table.shape == (1 if by_distance else BERTHS, 201)
    assert np.all(np.diff(model.table) <= 1e-6)
    assert model.table.min() >= 0.0
    assert model.table.max() <= 1.0


def test_without_data_the_measured_curve_is_the_prior() -> None:
    model = measured_model(empty_counts(), BIN, BINS - 1, by_distance=True)
    np.testing.assert_allclose(model.table, [np.exp(-DEPTHS / PRIOR_DEPTH)], rtol=1e-6)


@pytest.mark.parametrize("by_distance", [True, False])
def test_the_measured_curve_recovers_the_one_that_made_the_counts(by_distance: bool) -> None:
    curve = 0.95 * np.exp(-DEPTHS / 6.0)
    counts = counts_of(curve, 20_000, np.random.default_rng(1))
    model = measured_model(counts, BIN, BINS - 1, by_distance=by_distance)
    curves = [curve] if by_distance else [curve**power for power in range(2, 2 + BERTHS)]
    np.testing.assert_allclose(model.table, curves, atol=0.01)


def test_pooled_counts_of_a_team_teach_as_much_as_one_robot_that_saw_it_all() -> None:
    rng = np.random.default_rng(2)
    shares = [counts_of(np.exp(-DEPTHS / 2.0), 300, rng) for _ in range(5)]
    pooled = measured_model(np.sum(shares, axis=0), 0.1, 80, by_distance=True)
    alone = measured_model(shares[0], 0.1, 80, by_distance=True)
    truth = np.interp((np.arange(81) + 0.5) * 0.1, DEPTHS, np.exp(-DEPTHS / 2.0))
    assert np.abs(pooled.table - truth).mean() < np.abs(alone.table - truth).mean()


@settings(deadline=None, max_examples=50)
@given(seeds)
def test_non_increasing_is_the_least_squares_fit_by_the_min_max_formula(seed: int) -> None:
    rng = np.random.default_rng(seed)
    values, weights = rng.random(12), rng.uniform(0.1, 5, 12)

    def mean(a: int, b: int) -> float:
        return float(np.average(values[a : b + 1], weights=weights[a : b + 1]))

    expected = [min(max(mean(a, b) for b in range(i, 12)) for a in range(i + 1)) for i in range(12)]
    np.testing.assert_allclose(non_increasing(values, weights), expected, rtol=1e-9)


@settings(deadline=None, max_examples=50)
@given(seeds, st.booleans())
def test_rays_that_share_unknown_cells_miss_together_more_often_than_the_product_says(
    seed: int, disjoint: bool
) -> None:
    rng = np.random.default_rng(seed)
    owner = rng.integers(0, 3, 8)
    rays = [owner == i if disjoint else rng.random(8) < 0.4 for i in range(3)]  # unknown cells before s
    occupied = ((np.arange(256)[:, None] >> np.arange(8)) & 1).astype(bool)  # all maps of eight cells
    chance = np.prod(np.where(occupied, 0.3, 0.7), axis=1)
    missed = np.array([(occupied & ray).any(axis=1) for ray in rays])
    product = np.prod(missed @ chance)
    together = float(missed.all(axis=0) @ chance)
    assert product <= together + 1e-12
    assert together <= (missed @ chance).min() + 1e-12
    if disjoint:
        assert together == pytest.approx(product)


@settings(deadline=None, max_examples=50)
@given(seeds, st.integers(2, 6), st.integers(0, 2**53), st.integers(-(2**53), 2**53))
def test_whatever_one_robot_has_counted_the_curve_is_at_least_half_of_what_all_others_make_it(
    seed: int, robots: int, tried: int, seen: int
) -> None:
    rng = np.random.default_rng(seed)
    honest = np.array([counts_of(rng.uniform(0.2, 1.0, BINS), 1000, rng) for _ in range(robots)])
    told = np.append(honest, [np.tile([[tried], [seen]], (1 + BERTHS, BINS))], axis=0)
    ours, all_of = pooled(told), honest.sum(axis=0)
    assert (ours[0::2] <= 2 * all_of[0::2]).all()
    assert (2 * ours[1::2] * all_of[0::2] >= 0.99 * all_of[1::2] * ours[0::2]).all()
    assert (ours[1::2] <= ours[0::2]).all()


def test_counts_of_robots_that_have_tried_alike_and_of_one_alone_are_added_up() -> None:
    rng = np.random.default_rng(4)
    honest = np.array([counts_of(rng.uniform(size=BINS), 1000, rng) for _ in range(3)])
    assert np.array_equal(pooled(honest), honest.sum(axis=0))
    assert np.array_equal(pooled(honest[:1]), honest[0])

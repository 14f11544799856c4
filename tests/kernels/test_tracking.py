"""Tracking kernels against their twins, and at the ends of what they take."""

from __future__ import annotations

from typing import get_args

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vedette.kernels.reference import tracking as reference
from vedette.kernels.tracking import ChainMotion, Measure, Sparse, chain_gradient, chain_values

MEASURES: tuple[Measure, ...] = get_args(Measure)
seeds = st.integers(0, 2**32 - 1)
measures = st.sampled_from(MEASURES)


def random_motion(rng: np.random.Generator, targets: int) -> ChainMotion:
    """Any covariances and motions; the disturbance has rank 2."""
    root, push = rng.normal(size=(targets, 4, 4)), rng.normal(size=(targets, 4, 2))
    transitions = np.eye(4) + 0.3 * rng.normal(size=(targets, 4, 4))
    return ChainMotion(
        root @ root.swapaxes(1, 2) + 0.01 * np.eye(4), transitions, push @ push.swapaxes(1, 2) * rng.random()
    )


def random_sparse(rng: np.random.Generator, targets: int, steps: int) -> Sparse:
    """Information of rank 0, 1 or 2, about some targets."""
    some = np.flatnonzero(rng.random(targets) < 0.6).astype(np.int64)
    h = rng.normal(size=(len(some), steps, 2, 2)) * 10 ** rng.uniform(-2, 1)
    h[rng.random(h.shape[:2]) < 0.3] = 0.0
    h[..., 1] *= rng.random((*h.shape[:2], 1)) < 0.5
    info = h @ h.swapaxes(-1, -2)
    return some, np.ascontiguousarray(np.stack([info[..., 0, 0], info[..., 0, 1], info[..., 1, 1]], -1))


@settings(deadline=None, max_examples=60)
@given(seeds, measures)
def test_values_equal_filtering_every_target_anew_for_every_candidate(seed: int, measure: Measure) -> None:
    rng = np.random.default_rng(seed)
    targets, steps = int(rng.integers(1, 6)), int(rng.integers(1, 5))
    motion, others = random_motion(rng, targets), random_sparse(rng, targets, steps)
    candidates = [random_sparse(rng, targets, steps) for _ in range(4)]
    starts = np.cumsum([0, *(len(c[0]) for c in candidates)])
    own = (np.concatenate([c[0] for c in candidates]), np.concatenate([c[1] for c in candidates]))
    expected = reference.chain_values(motion, measure, others, starts, own)
    found = chain_values(motion, measure, others, starts, own)
    np.testing.assert_allclose(found, expected, rtol=1e-8, atol=1e-8)


@settings(deadline=None, max_examples=30)
@given(seeds, measures)
def test_the_gradient_equals_differentiating_forward_through_the_filter(seed: int, measure: Measure) -> None:
    rng = np.random.default_rng(seed)
    motion, team = random_motion(rng, 3), random_sparse(rng, 3, 3)
    expected = reference.chain_gradient(motion, measure, team)
    scale = max(1.0, np.abs(expected).max(initial=0.0))
    np.testing.assert_allclose(chain_gradient(motion, measure, team), expected, atol=1e-8 * scale)


@pytest.mark.parametrize("measure", MEASURES)
def test_the_gradient_agrees_with_central_differences_of_the_value(measure: Measure) -> None:
    rng = np.random.default_rng(5)
    motion = random_motion(rng, 2)
    targets, blocks = np.arange(2), rng.uniform(0.1, 1.0, (2, 3, 3)) * np.array([1.0, 0.05, 1.0])
    nobody = (np.empty(0, np.int64), np.empty((0, 3, 3)))
    slopes = chain_gradient(motion, measure, (targets, blocks))
    for at in np.ndindex(blocks.shape):
        step = np.zeros_like(blocks)
        step[at] = 1e-5
        both = (np.tile(targets, 2), np.concatenate([blocks - step, blocks + step]))
        low, high = chain_values(motion, measure, nobody, np.array([0, 2, 4]), both)
        assert slopes[at] == pytest.approx((high - low) / 2e-5, rel=1e-5, abs=1e-7)


@pytest.mark.parametrize("strength", [1e-12, 1e-6, 1.0, 1e6, 1e12])
def test_information_of_any_strength_keeps_its_digits(strength: float) -> None:
    covariance = np.diag([4.0, 9.0, 1.0, 1.0])
    motion = ChainMotion(covariance[None], np.eye(4)[None], np.zeros((1, 4, 4)))
    nobody = (np.empty(0, np.int64), np.empty((0, 1, 3)))
    own = (np.zeros(1, np.int64), strength * np.array([[[1.0, 0.0, 1.0]]]))
    [value] = chain_values(motion, "trajectory", nobody, np.array([0, 1]), own)
    exact = 0.5 * (np.log1p(4.0 * strength) + np.log1p(9.0 * strength))
    assert value == pytest.approx(exact, rel=1e-14, abs=0.0)


def test_blocks_that_do_not_fit_the_tracks_are_refused() -> None:
    rng = np.random.default_rng(0)
    motion, nobody = random_motion(rng, 2), (np.empty(0, np.int64), np.empty((0, 3, 3)))
    wrong = (np.array([2]), np.ones((1, 3, 3)))
    with pytest.raises(ValueError, match="own blocks do not fit"):
        chain_values(motion, "trajectory", nobody, np.array([0, 1]), wrong)
    with pytest.raises(ValueError, match="starts do not fit"):
        chain_values(motion, "trajectory", nobody, np.array([0, 1]), nobody)
    with pytest.raises(ValueError, match="the others' blocks do not fit"):
        chain_values(motion, "trajectory", wrong, np.array([0]), nobody)
    with pytest.raises(ValueError, match="the team's blocks do not fit"):
        chain_gradient(motion, "trajectory", wrong)

"""The tracking objectives: their laws, what they equal, and what they are not; how impacts travel."""

from __future__ import annotations

import functools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from tests.support.tracking_scenes import random_impact, random_platform, random_tracks
from vedette.domains.tracking.belief import tracks
from vedette.domains.tracking.codec import TrackImpactCodec
from vedette.domains.tracking.impact import Impact, clip, impact_of
from vedette.domains.tracking.models import TargetModel, static
from vedette.domains.tracking.objective import (
    OBJECTIVES,
    FinalEntropy,
    FinalVariance,
    TrackingObjective,
    objective,
)
from vedette.errors import InputError
from vedette.kernels.reference.tracking import information
from vedette.problem import LogDet
from vedette.testing import LawBroken, check_objective

seeds = st.integers(0, 2**32 - 1)
OBJECTIVE = TrackingObjective()


def line_of_sight(degrees: float, weight: float) -> NDArray[np.float64]:
    """Information across one line, as xx, xy, yy."""
    x, y = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return weight * np.array([x * x, x * y, y * y])


def same(a: Impact, b: Impact) -> bool:
    return np.array_equal(a.targets, b.targets) and np.array_equal(a.blocks, b.blocks)


@settings(deadline=None, max_examples=20)
@given(seeds, st.sampled_from(sorted(OBJECTIVES)))
def test_every_objective_keeps_the_laws_that_it_declares(seed: int, name: str) -> None:
    rng = np.random.default_rng(seed)
    belief = random_tracks(rng)
    examples = [OBJECTIVE.nothing(belief), *(random_impact(rng, belief) for _ in range(4))]
    check_objective(objective(name), belief, examples, tolerance=1e-8)


@settings(deadline=None, max_examples=30)
@given(seeds)
def test_the_chain_equals_the_log_det_of_the_whole_trajectory(seed: int) -> None:
    rng = np.random.default_rng(seed)
    horizon = int(rng.integers(1, 5))
    root, noise = rng.normal(size=(2, 4, 4))
    model = TargetModel(np.eye(4) + 0.3 * rng.normal(size=(4, 4)), noise @ noise.T + 0.1 * np.eye(4))
    belief = tracks([model], [np.zeros(4)], [root @ root.T + 0.1 * np.eye(4)], dt=1.0, horizon=horizon)
    impact = random_impact(rng, belief)
    # x_1 ~ N(., P_1), x_k = F x_{k-1} + w: information of the stacked trajectory, block tridiagonal
    prior = np.zeros((4 * horizon, 4 * horizon))
    prior[:4, :4] = np.linalg.inv(belief.predicted_covariances[0, 0])
    q_inv = np.linalg.inv(model.Q)
    for k in range(1, horizon):
        link = np.zeros((4, 4 * horizon))
        link[:, 4 * k - 4 : 4 * k], link[:, 4 * k : 4 * k + 4] = -model.F, np.eye(4)
        prior += link.T @ q_inv @ link
    posterior = prior.copy()
    for k, block in enumerate(information(impact.blocks[0]) if len(impact.targets) else []):
        posterior[4 * k : 4 * k + 4, 4 * k : 4 * k + 4] += block
    expected = 0.5 * (np.linalg.slogdet(posterior)[1] - np.linalg.slogdet(prior)[1])
    assert OBJECTIVE.value(belief, impact) == pytest.approx(expected, rel=1e-9, abs=1e-9)


@settings(deadline=None, max_examples=20)
@given(seeds)
def test_with_a_horizon_of_one_step_it_is_the_papers_objective_summed_over_targets(seed: int) -> None:
    rng = np.random.default_rng(seed)
    belief = random_tracks(rng, horizon=1)
    impact = random_impact(rng, belief)
    total = 0.0
    for target, block in zip(impact.targets, impact.blocks[:, 0], strict=True):
        prior = np.linalg.inv(belief.predicted_covariances[0, target])
        total += LogDet().value(prior, information(block))
    assert OBJECTIVE.value(belief, impact) == pytest.approx(total, rel=1e-8, abs=1e-9)


def test_returns_on_the_last_states_entropy_need_not_diminish() -> None:
    belief = tracks([static(1.0, 0.1)], [[0, 0]], [np.diag([0.9, 9.6])], dt=1.0, horizon=2)
    early = [np.stack([line_of_sight(*look), np.zeros(3)])[None] for look in ((0, 400), (-15, 800))]
    one, other = (impact_of(blocks) for blocks in early)
    claims = FinalEntropy()
    claims.submodular = True
    with pytest.raises(LawBroken, match="returns do not diminish"):
        check_objective(claims, belief, [one, other])
    check_objective(FinalEntropy(), belief, [one, other])
    check_objective(TrackingObjective(), belief, [one, other])


def test_returns_on_the_last_states_variance_need_not_diminish_in_one_step() -> None:
    oblique = np.array([[1.0, 0.9], [0.9, 1.0]])  # long along x = y
    belief = tracks([static(1.0)], [[0, 0]], [oblique], dt=1.0, horizon=1)
    short_axis, along_x = (
        impact_of(line_of_sight(-45, 10)[None, None]),
        impact_of(line_of_sight(0, 1e6)[None, None]),
    )
    claims = FinalVariance()
    claims.submodular = True
    with pytest.raises(LawBroken, match="returns do not diminish"):
        check_objective(claims, belief, [short_axis, along_x])
    check_objective(FinalVariance(), belief, [short_axis, along_x], tolerance=1e-7)


def test_an_unknown_objective_is_refused_with_the_nearest_name() -> None:
    with pytest.raises(InputError, match="did you mean 'trajectory'"):
        objective("trajectories")


@settings(deadline=None, max_examples=25)
@given(seeds)
def test_clipping_to_what_a_platform_can_reach_leaves_its_gains_as_they_are(seed: int) -> None:
    rng = np.random.default_rng(seed)
    belief = random_tracks(rng, targets=6)
    platform = random_platform(rng, belief)
    assert platform.candidates is not None
    others = functools.reduce(OBJECTIVE.combine, (random_impact(rng, belief) for _ in range(3)))
    clipped = clip(others, belief.predicted_means, platform.reach(belief))
    gains = [
        OBJECTIVE.values(belief, theirs, platform.candidates) - OBJECTIVE.value(belief, theirs)
        for theirs in (others, clipped)
    ]
    np.testing.assert_allclose(gains[0], gains[1], atol=1e-9)
    assert len(clip(others, belief.predicted_means, ()).targets) == 0
    assert len(clip(others, belief.predicted_means, ((9e3, 9e3, 9e3, 9e3),)).targets) == 0
    assert same(clip(others, belief.predicted_means, ((-1e4, -1e4, 1e4, 1e4), (0.0, 0.0, 0.0, 0.0))), others)


@settings(deadline=None, max_examples=30)
@given(seeds)
def test_messages_come_back_as_they_were_within_the_bound(seed: int) -> None:
    rng = np.random.default_rng(seed)
    belief = random_tracks(rng, targets=5)
    codec = TrackImpactCodec(len(belief), belief.horizon)
    team = functools.reduce(OBJECTIVE.combine, (random_impact(rng, belief) for _ in range(3)))
    for impact in (OBJECTIVE.nothing(belief), random_impact(rng, belief), team):
        data = codec.encode(impact)
        assert same(codec.decode(data), impact)
        assert len(data) == len(impact.targets) * (4 + 24 * belief.horizon) <= codec.bound


@pytest.mark.parametrize(
    ("targets", "block", "reason"),
    [
        ([1, 0], [1, 0, 1], "out of order"),
        ([0, 0], [1, 0, 1], "twice"),
        ([0, 5], [1, 0, 1], "unknown"),
        ([0, 1], [np.nan, 0, 1], "not finite"),
        ([0, 1], [1, np.inf, 1], "not finite"),
        ([0, 1], [1e15, 0, 1], "too large"),
        ([0, 1], [1, 1.01, 1], "not positive semi-definite"),
        ([0, 1], [-1, 0, 1], "not positive semi-definite"),
        ([0, 1], [0, 0, 0], "empty"),
    ],
)
def test_messages_that_are_no_impact_are_refused(targets: list[int], block: list[float], reason: str) -> None:
    codec = TrackImpactCodec(targets=3, horizon=2)
    bad = Impact(np.array(targets), np.tile(np.array(block, np.float64), (2, 2, 1)))
    with pytest.raises(ValueError, match=reason):
        codec.decode(codec.encode(bad))


def test_messages_of_the_wrong_size_are_refused() -> None:
    codec = TrackImpactCodec(targets=1, horizon=2)
    data = codec.encode(impact_of(np.ones((1, 2, 3))))
    for wrong in (data[:-1], data + b"\0", data + data):
        with pytest.raises(ValueError, match="cut short or too large"):
            codec.decode(wrong)

"""Tracks: motion, the filter against the textbook's, consistency, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from tests.support.tracking_scenes import random_tracks
from vedette.domains.tracking.belief import Tracks, tracks
from vedette.domains.tracking.filter import nees, predict, update
from vedette.domains.tracking.models import TargetModel, constant_velocity, static
from vedette.domains.tracking.sensing import evidence
from vedette.domains.tracking.sensors import Position, RangeBearing
from vedette.errors import InputError

seeds = st.integers(0, 2**32 - 1)
BAND = (162.7, 241.1)  # 2.5 % and 97.5 % points of chi-square with 200 degrees of freedom


def test_constant_velocity_is_the_motion_under_an_acceleration_held_for_a_step() -> None:
    rng = np.random.default_rng(0)
    dt, q = 0.5, 0.8
    model = constant_velocity(dt, q)
    assert np.linalg.matrix_rank(model.Q) == 2
    start = np.array([1.0, 2.0, 3.0, -1.0])
    ends = np.array([model.move(rng, start) for _ in range(20000)])
    push = rng.normal(0.0, np.sqrt(q / dt), (20000, 2))
    expected = np.hstack([start[:2] + start[2:] * dt + push * dt**2 / 2, start[2:] + push * dt])
    np.testing.assert_allclose(ends.mean(axis=0), expected.mean(axis=0), atol=0.03)
    np.testing.assert_allclose(np.cov(ends.T), np.cov(expected.T), atol=0.02)


def test_a_static_target_stays_and_its_dummy_velocity_never_matters() -> None:
    rng = np.random.default_rng(0)
    still, drifting = static(0.5), static(0.5, 0.2)
    np.testing.assert_array_equal(still.move(rng, [1.0, 2.0, 0.0, 0.0]), [1.0, 2.0, 0.0, 0.0])
    ends = np.array([drifting.move(rng, [1.0, 2.0, 0.0, 0.0]) for _ in range(20000)])
    np.testing.assert_allclose(np.cov(ends.T), np.diag([0.1, 0.1, 0.0, 0.0]), atol=0.005)
    belief = predict(tracks([drifting], [[1.0, 2.0]], [np.diag([2.0, 3.0])], dt=0.5, horizon=1), 4)
    np.testing.assert_allclose(belief.covariances[0], np.diag([2.4, 3.4, 1.0, 1.0]), rtol=1e-12)
    assert belief.entropies[0] == pytest.approx(np.log(2 * np.pi * np.e) + 0.5 * np.log(2.4 * 3.4))


@settings(deadline=None, max_examples=30)
@given(seeds)
def test_filter_steps_equal_the_textbooks_kalman_filter(seed: int) -> None:
    rng = np.random.default_rng(seed)
    belief, sensor, pose = random_tracks(rng), RangeBearing(range=1e3), np.array([70.0, 70.0, 0.3])
    mean, covariance = belief.means.copy(), belief.covariances.copy()
    for _ in range(3):
        for t, model in enumerate(belief.models):  # predict
            mean[t], covariance[t] = model.F @ mean[t], model.F @ covariance[t] @ model.F.T + model.Q
        belief = predict(belief)
        np.testing.assert_allclose(belief.means, mean, rtol=1e-8, atol=1e-8)
        seen: dict[int, NDArray[np.float64]] = {}
        for t in range(len(belief)):
            z = sensor.measure(rng, pose, mean[t] + 0.1)
            assert z is not None
            seen[t] = z
        belief = update(belief, *evidence(sensor, pose, seen, belief.means))
        for t, z in seen.items():  # update by the gain
            H = np.hstack([sensor.jacobian(pose, mean[t, :2]), np.zeros((2, 2))])
            S = H @ covariance[t] @ H.T + np.diag(sensor.deviations**2)
            K = covariance[t] @ H.T @ np.linalg.inv(S)
            mean[t] = mean[t] + K @ sensor.innovation(z, sensor.predicted(pose, mean[t, :2]))
            covariance[t] = covariance[t] - K @ S @ K.T
        np.testing.assert_allclose(belief.means, mean, rtol=1e-7, atol=1e-7)
        np.testing.assert_allclose(belief.covariances, covariance, rtol=1e-6, atol=1e-7)
    assert belief.k0 == 10


def test_the_common_track_is_the_prediction_without_measurements() -> None:
    belief = random_tracks(np.random.default_rng(3), targets=4, horizon=5)
    for k in range(5):
        later = predict(belief, k + 1)
        np.testing.assert_allclose(belief.predicted_means[k], later.means, rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(belief.predicted_covariances[k], later.covariances, rtol=1e-8, atol=1e-9)


@pytest.mark.parametrize("sensor", [Position(range=1e3), RangeBearing(range=1e3, bearing_noise=1.0)])
def test_the_filter_is_consistent_over_monte_carlo_runs(sensor: Position | RangeBearing) -> None:
    model = constant_velocity(1.0, 0.05)
    prior, mean = np.diag([9.0, 9.0, 0.25, 0.25]), np.array([40.0, 30.0, -1.0, 0.5])
    total = 0.0
    for run in range(50):
        rng = np.random.default_rng([2006, run])
        truth = rng.multivariate_normal(mean, prior)
        belief = tracks([model], [mean], [prior], dt=1.0, horizon=1)
        for k in range(20):
            truth, belief = model.move(rng, truth), predict(belief)
            pose = np.array([2.0 * k, 5.0, 0.0])
            z = sensor.measure(rng, pose, truth)
            assert z is not None
            belief = update(belief, *evidence(sensor, pose, {0: z}, belief.means))
        total += float(nees(belief, truth[None])[0])
    assert BAND[0] < total < BAND[1]


def test_nees_counts_only_the_components_that_a_target_has() -> None:
    belief = tracks([static(1.0)], [[0.0, 0.0]], [np.diag([4.0, 1.0])], dt=1.0, horizon=1)
    assert nees(belief, [[2.0, 3.0, 99.0, 99.0]])[0] == pytest.approx(10.0)


CV = constant_velocity(1.0, 0.1)
HALF_KNOWN = np.diag([1.0, 1.0, 0.0, 0.0])


@pytest.mark.parametrize(
    ("models", "means", "covariances", "line"),
    [
        ([], [], [], "there is no target"),
        ([CV], [[0] * 4], [], "1 models, 1 means, 0 covariances"),
        (
            [CV],
            [[0] * 2],
            [np.eye(4)],
            r"target 0 has a mean of shape \(2,\) and a covariance of shape \(4, 4\)",
        ),
        ([static(1.0)], [[0] * 2], [np.eye(4)], r"its model needs \(2,\) and \(2, 2\)"),
        ([CV], [[0, 0, np.nan, 0]], [np.eye(4)], "mean or covariance of target 0 is not finite"),
        ([CV, CV], [[0] * 4] * 2, [np.eye(4), HALF_KNOWN], "covariance of target 1 is not symmetric and pos"),
        (
            [CV],
            [[0] * 4],
            [np.eye(4) + np.eye(4, k=1) / 9],
            "covariance of target 0 is not symmetric and pos",
        ),
    ],
)
def test_what_is_no_set_of_tracks_is_refused(
    models: list[TargetModel], means: list[list[float]], covariances: list[NDArray[np.float64]], line: str
) -> None:
    with pytest.raises(InputError, match=line):
        tracks(models, means, covariances, dt=1.0, horizon=3)


@pytest.mark.parametrize(
    ("changed", "line"),
    [
        ({"Y": np.ones((2, 4, 4))}, r"Y has shape \(2, 4, 4\); 1 target would have \(1, 4, 4\)"),
        ({"y": np.ones(4)}, r"y has shape \(4,\); 1 target would have \(1, 4\)"),
        ({"y": np.full((1, 4), np.inf)}, "y of target 0 is not finite"),
        ({"Y": np.eye(4)[None] + np.eye(4, k=1)}, "target 0 is not symmetric"),
        ({"Y": np.diag([1.0, 1.0, 0.0, 0.0])[None]}, "target 0 is not positive definite"),
        ({"dt": 0.0}, "dt must be > 0 s; got 0.0"),
        ({"horizon": 0}, "horizon must be at least 1 step; got 0"),
    ],
)
def test_information_that_is_no_belief_is_refused(changed: dict[str, object], line: str) -> None:
    good: dict[str, object] = {
        "k0": 0,
        "dt": 1.0,
        "horizon": 2,
        "models": (CV,),
        "Y": np.eye(4)[None],
        "y": np.zeros((1, 4)),
    }
    with pytest.raises(InputError, match=line):
        Tracks(**{**good, **changed})  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("F", "Q", "d", "line"),
    [
        (np.eye(3), np.eye(4), 4, r"F must be 4x4, all finite; got shape \(3, 3\)"),
        (np.eye(4), np.full((4, 4), np.nan), 4, "Q must be 4x4, all finite"),
        (np.eye(4), -np.eye(4), 4, "Q must be symmetric without negative eigenvalues"),
        (np.eye(4), np.diag([1.0, 1.0, 1.0, -0.1]), 4, "Q must be symmetric without negative eigenvalues"),
        (np.zeros((4, 4)), np.eye(4), 4, "F must be invertible"),
        (np.eye(4), np.eye(4), 3, "d must be 2 or 4; got 3"),
    ],
)
def test_what_is_no_motion_is_refused(
    F: NDArray[np.float64], Q: NDArray[np.float64], d: int, line: str
) -> None:
    with pytest.raises(InputError, match=line):
        TargetModel(F, Q, d)


def test_steps_and_intensities_out_of_range_are_refused() -> None:
    with pytest.raises(InputError, match=r"dt must be > 0 s; got 0"):
        constant_velocity(0.0, 1.0)
    with pytest.raises(InputError, match=r"q must be >= 0 m\^2/s; got -1"):
        static(1.0, -1.0)

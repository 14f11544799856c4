"""Sensors of targets: their information, measurements and likelihoods, and how scenarios name them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from vedette.domains.tracking.belief import tracks
from vedette.domains.tracking.filter import update
from vedette.domains.tracking.geometry import wrapped
from vedette.domains.tracking.models import static
from vedette.domains.tracking.sensing import Sensor, evidence
from vedette.domains.tracking.sensors import (
    BearingOnly,
    Position,
    RangeBearing,
    RangeOnly,
    sensor_of,
)
from vedette.errors import InputError

ALL: tuple[Sensor, ...] = (RangeBearing(), BearingOnly(), RangeOnly(), Position())
seeds = st.integers(0, 2**32 - 1)


def pose_and_point(seed: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    rng = np.random.default_rng(seed)
    return np.append(rng.uniform(-10, 10, 2), rng.uniform(-4, 4)), rng.uniform(-10, 10, 2)


@pytest.mark.parametrize("sensor", ALL)
@settings(deadline=None, max_examples=30)
@given(seed=seeds)
def test_information_is_that_of_the_measurements_jacobian(sensor: Sensor, seed: int) -> None:
    pose, point = pose_and_point(seed)
    step = 1e-6
    rows = [
        sensor.innovation(sensor.predicted(pose, point + dx), sensor.predicted(pose, point - dx)) / (2 * step)
        for dx in step * np.eye(2)
    ]
    H = np.stack(rows, axis=1)  # by central differences
    if np.hypot(*(point - pose[:2])) > sensor.min_range:
        np.testing.assert_allclose(sensor.jacobian(pose, point), H, atol=1e-7)
    H = sensor.jacobian(pose, point)
    expected = H.T @ np.diag(sensor.deviations**-2) @ H
    xx, xy, yy = sensor.information(pose, point)
    np.testing.assert_allclose([[xx, xy], [xy, yy]], expected, rtol=1e-12, atol=1e-12)
    info, _ = sensor.likelihood(sensor.predicted(pose, point), pose, np.append(point, [0, 0]))
    np.testing.assert_allclose(info[:2, :2], expected, rtol=1e-12, atol=1e-12)
    assert not info[2:].any()


def test_many_poses_and_targets_at_once_are_each_on_its_own() -> None:
    rng = np.random.default_rng(0)
    poses, points = rng.uniform(-30, 30, (5, 4, 1, 3)), rng.uniform(-30, 30, (4, 6, 2))
    for sensor in (RangeBearing(view=90.0), BearingOnly(range=20.0)):
        together = sensor.information(poses, points)
        assert together.shape == (5, 4, 6, 3)
        for c, k, t in np.ndindex(5, 4, 6):
            alone = sensor.information(poses[c, k, 0], points[k, t])
            np.testing.assert_allclose(together[c, k, t], alone, rtol=1e-12)


def test_nothing_out_of_view_is_seen_nor_expected() -> None:
    rng = np.random.default_rng(0)
    sensor = RangeBearing(range=10.0, view=90.0)
    pose = np.array([0.0, 0.0, np.pi])  # looks towards -x: its view is across the jump of atan2
    for point, visible in [
        ((-9.0, 1.0), True),
        ((-9.0, -1.0), True),
        ((-11.0, 0.0), False),
        ((-1.0, 1.1), False),
        ((5.0, 0.0), False),
    ]:
        assert sensor.sees(pose, point) == visible
        assert sensor.information(pose, point).any() == visible
        assert (sensor.measure(rng, pose, point) is not None) == visible


def test_so_many_targets_are_detected_as_the_probability_says_and_the_noise_is_as_told() -> None:
    rng = np.random.default_rng(1)
    sensor = RangeBearing(range_noise=0.5, bearing_noise=3.0, detection=0.6)
    pose = np.array([1.0, 2.0, 0.3])
    draws = [sensor.measure(rng, pose, [5.0, 5.0, 0.0, 0.0]) for _ in range(4000)]
    seen = np.array([z for z in draws if z is not None])
    assert len(seen) / len(draws) == pytest.approx(0.6, abs=0.03)
    np.testing.assert_allclose(seen.mean(axis=0), sensor.predicted(pose, np.array([5.0, 5.0])), atol=0.05)
    np.testing.assert_allclose(seen.std(axis=0), sensor.deviations, rtol=0.06)
    np.testing.assert_array_equal(
        sensor.information(pose, [5.0, 5.0]),
        0.6 * replace(sensor, detection=1.0).information(pose, [5.0, 5.0]),
    )


def test_closer_than_the_least_range_nothing_more_is_expected() -> None:
    sensor = BearingOnly(min_range=2.0)
    at_least = sensor.information((0, 0, 0), (2.0, 0.0))
    np.testing.assert_allclose(sensor.information((0, 0, 0), (0.01, 0.0)), at_least)
    assert np.isfinite(sensor.information((0, 0, 0), (0.0, 0.0))).all()


@pytest.mark.parametrize("sensor", ALL)
@settings(deadline=None, max_examples=30)
@given(seed=seeds)
def test_no_likelihood_exceeds_the_most_that_the_sensor_states(sensor: Sensor, seed: int) -> None:
    rng = np.random.default_rng(seed)
    pose = np.append(rng.uniform(-100, 100, 2), rng.uniform(-4, 4))
    truth, mean = pose[:2] + rng.normal(size=2), np.append(rng.uniform(-100, 100, 2), [0.0, 0.0])
    z = sensor.measure(rng, pose, truth)
    assert z is not None
    information, vector = sensor.likelihood(z, pose, mean)
    most_information, most_vector = sensor.most_evidence(100.0)
    assert np.abs(information).max() <= most_information * (1 + 1e-12)
    assert np.abs(vector).max() <= most_vector


def test_angles_wrap_to_the_half_open_turn() -> None:
    np.testing.assert_allclose(
        wrapped([np.pi, -np.pi, 3 * np.pi, 0.5, 6.5]), [np.pi] * 3 + [0.5, 6.5 - 2 * np.pi]
    )


@pytest.mark.parametrize("sensor", [BearingOnly(bearing_noise=2.0), RangeBearing(bearing_noise=2.0)])
def test_a_bearing_that_jumps_by_a_turn_moves_the_estimate_by_the_noise_only(sensor: Sensor) -> None:
    belief = tracks([static(1.0)], [[-10.0, 0.01]], [np.eye(2)], dt=1.0, horizon=1)
    pose = np.zeros(3)
    z = sensor.predicted(pose, np.array([-10.0, -0.01]))  # a bearing just above -pi, expected just below pi
    after = update(belief, *evidence(sensor, pose, {0: z}, belief.means))
    np.testing.assert_allclose(after.means[0, :2], [-10.0, 0.0], atol=0.011)


def test_the_information_vector_needs_the_linearisations_offset() -> None:
    """Eq. (21) of the paper as printed, with z for z - a, ends far from the truth; corrected it does not."""
    rng = np.random.default_rng(2)
    sensor, truth = RangeBearing(range_noise=0.3, bearing_noise=1.0), np.array([30.0, 20.0, 0.0, 0.0])
    right, printed = (tracks([static(1.0)], [[29.0, 21.0]], [np.eye(2)], dt=1.0, horizon=1) for _ in range(2))
    for pose in rng.uniform(0, 40, (20, 3)):
        z = sensor.measure(rng, pose, truth)
        assert z is not None
        right = update(right, *evidence(sensor, pose, {0: z}, right.means))
        info, _ = evidence(sensor, pose, {0: z}, printed.means)
        H = sensor.jacobian(pose, printed.means[0, :2])
        i = np.zeros((1, 4))
        i[0, :2] = H.T @ (z / sensor.deviations**2)
        printed = update(printed, info, i)
    deviation = np.sqrt(np.trace(right.covariances[0, :2, :2]))
    assert np.hypot(*(right.means[0] - truth)[:2]) < 3 * deviation
    assert np.hypot(*(printed.means[0] - truth)[:2]) > 50 * deviation


def test_who_is_not_seen_contributes_nothing() -> None:
    belief = tracks([static(1.0)] * 2, [[5, 5], [9, 9]], [np.eye(2)] * 2, dt=1.0, horizon=1)
    info, vector = evidence(Position(), np.zeros(3), {1: np.array([9.0, 9.5])}, belief.means)
    assert not info[0].any()
    assert not vector[0].any()
    np.testing.assert_allclose(update(belief, info, vector).means[1, :2], [9.0, 9.25])


def test_scenarios_name_sensors() -> None:
    assert sensor_of({"type": "bearing", "range": 60, "bearing_noise": 5e-1}, "f") == BearingOnly(
        range=60, bearing_noise=0.5
    )
    assert sensor_of({"type": "position"}, "f") == Position()


@pytest.mark.parametrize(
    ("entry", "line"),
    [
        ("bearing", "p.yaml: platform 1: must be 'field: value' pairs with a type; got 'bearing'"),
        ({}, "p.yaml: platform 1: unknown type None; known: range-bearing, bearing, range, position"),
        ({"type": "bearings"}, "p.yaml: platform 1: unknown type 'bearings'; did you mean 'bearing'?"),
        (
            {"type": "range", "rnge": 3},
            "p.yaml: platform 1: unknown field 'rnge'; did you mean 'range'?",
        ),
        (
            {"type": "range", "bearing_noise": 3},
            "p.yaml: platform 1: unknown field 'bearing_noise'; did you mean 'range_noise'?",
        ),
        ({"type": "range", "view": 0}, "p.yaml: platform 1: view must be 1 to 360 deg; got 0.0"),
        (
            {"type": "range", "range": float("nan")},
            "p.yaml: platform 1: range: must be a finite number; got nan",
        ),
        (
            {"type": "range", "detection": 2},
            "p.yaml: platform 1: detection must be 0.01 to 1; got 2.0",
        ),
        (
            {"type": "position", "noise": "small"},
            "p.yaml: platform 1: noise: must be a number; got 'small'",
        ),
    ],
)
def test_what_is_no_sensor_is_refused_in_one_line(entry: object, line: str) -> None:
    with pytest.raises(InputError) as caught:
        sensor_of(entry, "p.yaml: platform 1")
    assert str(caught.value) == line

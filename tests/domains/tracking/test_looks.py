"""Looks at targets that are badly known: against Monte Carlo, and plans against filters."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from vedette.domains.tracking.belief import tracks
from vedette.domains.tracking.filter import nees, update
from vedette.domains.tracking.geometry import packed
from vedette.domains.tracking.models import static
from vedette.domains.tracking.sensing import Sensor, evidence
from vedette.domains.tracking.sensors import BearingOnly, Position, RangeBearing, RangeOnly
from vedette.kernels.looks import lines
from vedette.kernels.reference.looks import line

WIDE = 1e6  # a range, so that everything is seen [m]
ALL: tuple[Sensor, ...] = (
    RangeBearing(range=WIDE),
    BearingOnly(range=WIDE),
    RangeOnly(range=WIDE),
    Position(range=WIDE),
)
seeds = st.integers(0, 2**32 - 1)


@pytest.mark.parametrize("sensor", ALL)
@settings(deadline=None, max_examples=30)
@given(seed=seeds)
def test_what_a_plan_expects_of_a_look_is_what_the_filter_gets_from_it(sensor: Sensor, seed: int) -> None:
    rng = np.random.default_rng(seed)
    pose, mean = np.append(rng.uniform(-60, 60, 2), rng.uniform(-4, 4)), rng.uniform(-60, 60, 2)
    root = rng.normal(size=(4, 4)) * 10 ** rng.uniform(-1, 2)
    covariance = root @ root.T + 0.01 * np.eye(4)
    stride = float(rng.choice([0.0, 15.0]))
    expected = sensor.foresee(pose[None, None], mean[None, None], covariance[None, None, :2, :2], stride)[
        0, 0, 0
    ]
    z = sensor.measure(rng, pose, mean + rng.normal(size=2))
    assert z is not None
    got, _ = sensor.likelihood(z, pose, np.append(mean, [0.0, 0.0]), covariance, stride)
    np.testing.assert_array_equal(expected, packed(got[:2, :2]))


def monte_carlo(sensor: Sensor, r: float, spread: NDArray[np.float64], runs: int) -> NDArray[np.float64]:
    """Draw places about (r, 0) and the statistics of their measurements from the origin: (runs, 2 + s)."""
    rng, pose = np.random.default_rng(2006), np.array([0.0, 0.0, 0.7])
    places = rng.multivariate_normal([r, 0.0], spread, runs)
    measured = [sensor.measure(rng, pose, place) for place in places]
    told = [sensor.statistics(z, pose, 0.0) for z in measured if z is not None]
    return np.hstack([places, told])


@pytest.mark.parametrize("r", [0.0, 40.0, 400.0])
@pytest.mark.parametrize("sensor", [RangeBearing(range=WIDE, range_noise=6.0, bearing_noise=8.0)])
def test_the_converted_measurement_is_unbiased_and_its_noise_as_told(sensor: Sensor, r: float) -> None:
    """Regression of 40 000 drawn measurements on the drawn places, and what it leaves.

    Sixteen points stand for the Gaussian: with its mean on the sensor they get directions right to a tenth.
    """
    spread = np.array([[400.0, 100.0], [100.0, 225.0]])
    drawn = monte_carlo(sensor, r, spread, 40_000)
    places, told = drawn[:, :2] - (r, 0.0), drawn[:, 2:4]
    H, R, expected = line(sensor.sight(0.0), r, spread)
    slope = np.linalg.lstsq(places, told - told.mean(axis=0), rcond=None)[0].T
    scale = np.sqrt(np.trace(R[:2, :2]))
    np.testing.assert_allclose(told.mean(axis=0), expected[:2], atol=5 * (scale + 20) / 200)
    np.testing.assert_allclose(slope, H[:2], atol=5 * scale / 15 / 200)
    np.testing.assert_allclose(np.cov((told - places @ slope.T).T), R[:2, :2], atol=0.08 * scale**2)


@pytest.mark.parametrize("sensor", [BearingOnly(range=WIDE), RangeOnly(range=WIDE)])
@pytest.mark.parametrize("r", [60.0, 400.0])
def test_the_line_through_a_bearing_or_a_range_is_the_regression_on_the_place(
    sensor: Sensor, r: float
) -> None:
    """Points stand for the Gaussian, and functions have a kink at the sensor: a tenth is as near as it is."""
    spread = np.diag([40.0**2, 25.0**2])
    drawn = monte_carlo(sensor, r, spread, 20_000)
    places, told = drawn[:, :2] - (r, 0.0), drawn[:, 2:]
    H, _, expected = line(sensor.sight(0.0), r, spread)
    slope = np.linalg.lstsq(places, told - told.mean(axis=0), rcond=None)[0].T
    sd = np.sqrt(np.diag(spread))
    np.testing.assert_allclose(told.mean(axis=0), expected, atol=0.1 * told.std(axis=0).max())
    np.testing.assert_allclose(slope * sd, H * sd, atol=0.1 * np.abs(H * sd).max())


@pytest.mark.parametrize("sensor", ALL)
@pytest.mark.parametrize("r", [0.0, 15.0, 60.0, 300.0])
@pytest.mark.parametrize("sd", [60.0, 5.0, 0.5])
def test_one_look_from_anywhere_leaves_an_estimate_no_surer_than_it_is(
    sensor: Sensor, r: float, sd: float
) -> None:
    """The NEES of a position is 2 on average: of 300 looks, below 2.35 but for one time in a thousand."""
    belief = tracks([static(1.0)], [[r, 0.0]], [np.diag([sd**2, (0.7 * sd) ** 2])], dt=1.0, horizon=1)
    pose, total = np.array([0.0, 0.0, 0.7]), 0.0
    for run in range(300):
        rng = np.random.default_rng([2006, run])
        truth = np.append([r, 0.0] + np.array([sd, 0.7 * sd]) * rng.normal(size=2), [0.0, 0.0])
        z = sensor.measure(rng, pose, truth)
        assert z is not None
        after = update(belief, *evidence(sensor, pose, {0: z}, belief.means, belief.covariances))
        total += float(nees(after, truth[None])[0])
    assert total / 300 < 2.35
    if isinstance(sensor, RangeBearing | Position):
        assert total / 300 > 1.5


@pytest.mark.parametrize("sensor", [RangeBearing(range=WIDE), Position(range=WIDE)])
@pytest.mark.parametrize("place", [(0.0, 0.0), (15.0, 0.0), (-40.0, 30.0)])
def test_two_looks_find_a_target_anywhere_about_the_sensor(
    sensor: Sensor, place: tuple[float, float]
) -> None:
    belief = tracks([static(1.0)], [[0.0, 0.0]], [np.diag([60.0**2, 60.0**2])], dt=1.0, horizon=1)
    rng, pose = np.random.default_rng(4), np.zeros(3)
    for _ in range(2):
        z = sensor.measure(rng, pose, place)
        assert z is not None
        belief = update(belief, *evidence(sensor, pose, {0: z}, belief.means, belief.covariances))
    assert np.hypot(*(belief.means[0, :2] - place)) < 6.0


@settings(deadline=None, max_examples=50)
@given(seed=seeds)
def test_no_look_tells_more_than_one_at_a_place_that_is_known(seed: int) -> None:
    rng = np.random.default_rng(seed)
    sensor = ALL[rng.integers(len(ALL))]
    root = rng.normal(size=(2, 2)) * 10 ** rng.uniform(-2, 2)
    told = lines(sensor.sight(0.0), rng.normal(size=(1, 2)) * 50, packed(root @ root.T)[None]).information[0]
    xx, xy, yy = told.tolist()
    assert np.linalg.eigvalsh([[xx, xy], [xy, yy]])[1] <= sensor.most * (1 + 1e-12)

"""What is known of a field: against the central Kalman filter on dense matrices, and against draws."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from vedette import InputError
from vedette.domains.monitoring.belief import FieldBelief
from vedette.domains.monitoring.field import FieldModel
from vedette.domains.monitoring.spots import Spots
from vedette.maps import GridFrame

Floats = NDArray[np.float64]
FRAME = GridFrame(1.0, 5, 7)


def prior(lasting: float = math.inf, **model: object) -> FieldBelief:
    numbers = {"mean": 2.0, "deviation": 1.5, "length": 3.0, "lasting": lasting, **model}
    field = FieldModel(FRAME, **numbers)  # type: ignore[arg-type]
    return FieldBelief.prior(field, Spots(FRAME, (1, 3)), dt=1.0)


def looks(rng: np.random.Generator, belief: FieldBelief, most: int = 8) -> tuple[NDArray[np.int64], Floats]:
    """Some spots of both kinds, one perhaps twice, and variances."""
    count = int(rng.integers(1, most))
    return rng.integers(belief.spots.count, size=count), 10.0 ** rng.uniform(-2.0, 1.0, count)


class Dense:
    """The exact filter: ``x' = a x + w``, ``w ~ N(0, (1 - a^2) L0^-1)``, dense covariances."""

    def __init__(self, belief: FieldBelief) -> None:
        self.prior = np.linalg.inv(belief.model.precision.toarray())
        self.weights = belief.spots.weights.toarray()
        self.mean, self.covariance = np.full(FRAME.size, belief.model.mean), self.prior.copy()
        self._centre, self._keep = belief.model.mean, belief.model.kept(belief.dt)

    def predict(self) -> None:
        a = self._keep
        self.mean = self._centre + a * (self.mean - self._centre)
        self.covariance = a * a * self.covariance + (1.0 - a * a) * self.prior

    def observe(self, spots: NDArray[np.int64], values: Floats, variances: Floats) -> None:
        h = self.weights[spots]
        gain = self.covariance @ h.T @ np.linalg.inv(h @ self.covariance @ h.T + np.diag(variances))
        self.mean = self.mean + gain @ (values - h @ self.mean)
        self.covariance = self.covariance - gain @ h @ self.covariance


@settings(deadline=None, max_examples=40)
@given(st.integers(0, 10**6))
def test_of_a_field_that_lasts_the_belief_is_the_exact_filters(seed: int) -> None:
    rng = np.random.default_rng(seed)
    belief = prior()
    exact = Dense(belief)
    for _ in range(3):
        spots, variances = looks(rng, belief)
        values = rng.normal(2.0, 2.0, len(spots))
        belief = belief.observe(spots, values, variances).predict()
        exact.observe(spots, values, variances)
    np.testing.assert_allclose(belief.mean.ravel(), exact.mean, atol=1e-7)
    cells = np.arange(FRAME.size)
    np.testing.assert_allclose(belief.deviations(cells), np.sqrt(np.diag(exact.covariance)), atol=1e-7)
    gained = 0.5 * (np.linalg.slogdet(exact.prior)[1] - np.linalg.slogdet(exact.covariance)[1])
    assert belief.gained == pytest.approx(gained, rel=1e-7)


@settings(deadline=None, max_examples=40)
@given(st.integers(0, 10**6), st.floats(0.3, 300.0))
def test_of_a_field_that_changes_the_belief_is_never_surer_than_the_exact_filter(
    seed: int, lasting: float
) -> None:
    rng = np.random.default_rng(seed)
    belief = prior(lasting)
    exact = Dense(belief)
    for _ in range(6):
        spots, variances = looks(rng, belief)
        values = rng.normal(2.0, 2.0, len(spots))
        belief = belief.observe(spots, values, variances).predict()
        exact.observe(spots, values, variances)
        exact.predict()
        surplus = np.linalg.inv(belief.precision.toarray()) - exact.covariance
        assert np.linalg.eigvalsh(surplus).min() > -1e-8
    assert belief.gained >= 0.0


def test_what_was_seen_once_grows_old_exactly_as_the_filter_says() -> None:
    belief = prior(lasting=4.0).observe(np.array([17]), np.array([5.0]), np.array([0.3]))
    exact = Dense(belief)
    exact.observe(np.array([17]), np.array([5.0]), np.array([0.3]))
    for _ in range(9):
        belief = belief.predict()
        exact.predict()
        np.testing.assert_allclose(belief.mean.ravel(), exact.mean, atol=1e-8)
        np.testing.assert_allclose(
            belief.deviations(np.arange(35)), np.sqrt(np.diag(exact.covariance)), atol=1e-8
        )


@pytest.mark.parametrize("lasting", [3.0, 30.0])
def test_errors_are_as_large_as_the_belief_says_and_no_larger(lasting: float) -> None:
    """Normalised error squared over 200 draws: a consistent filter's mean is 1 a cell."""
    rng = np.random.default_rng(7)
    shares = []
    for _ in range(200):
        belief = prior(lasting)
        truth = belief.model.sample(rng)
        for step in range(12):
            spots, variances = looks(rng, belief, most=5)
            values = (
                belief.spots.weights[spots] @ truth.ravel() + rng.normal(size=len(spots)) * variances**0.5
            )
            belief = belief.observe(spots, values, variances)
            if step < 11:
                truth = belief.model.later(truth, step, step + 1.0, rng)
                belief = belief.predict()
        error = (truth - belief.mean).ravel()
        shares.append(float(error @ (belief.precision @ error)) / FRAME.size)
    spread = 3.3 * math.sqrt(2.0 / (200 * FRAME.size))
    assert 0.7 < np.mean(shares) < 1.0 + spread


def test_the_same_evidence_counted_twice_is_told_by_errors_that_are_too_large() -> None:
    rng = np.random.default_rng(8)
    shares: dict[int, list[float]] = {1: [], 4: []}
    for _ in range(60):
        belief = prior()
        truth = belief.model.sample(rng)
        spots, variances = rng.integers(FRAME.size, size=20), np.full(20, 0.5)
        values = truth.ravel()[spots] + rng.normal(size=20) * variances**0.5
        for times, of in shares.items():
            told = belief.observe(np.tile(spots, times), np.tile(values, times), np.tile(variances, times))
            error = (truth - told.mean).ravel()
            of.append(float(error @ (told.precision @ error)) / FRAME.size)
    assert np.mean(shares[1]) < 1.15 < 1.5 < np.mean(shares[4])


def test_evidence_drifts_with_the_field_and_what_the_border_cuts_is_left_out() -> None:
    belief = prior(drift=(1.0, 0.0))
    point, block = belief.spots.of(1, np.array([9])), belief.spots.of(3, np.array([8, 12]))
    spots = np.concatenate([point, block])
    later = belief.observe(spots, np.array([3.0, 4.0, 5.0]), np.ones(3)).predict(2)
    assert np.flatnonzero(later.information).tolist() == [11, 35 + 10]
    assert later.vector[[11, 45]].tolist() == [1.0, 2.0]


@pytest.mark.parametrize(
    ("spot", "value", "variance", "line"),
    [
        (0, math.nan, 1.0, "measurement 0: value is nan"),
        (0, 1.0, 0.0, "measurement 0: variance is 0"),
        (0, 1.0, -2.0, "measurement 0: variance is -2"),
        (0, 1.0, math.inf, "measurement 0: variance is inf"),
    ],
)
def test_a_measurement_that_cannot_be_is_refused(spot: int, value: float, variance: float, line: str) -> None:
    with pytest.raises(InputError, match=line):
        prior().observe(np.array([spot]), np.array([value]), np.array([variance]))


def test_a_belief_that_cannot_be_is_refused() -> None:
    belief = prior()
    wrong = np.zeros(belief.spots.count)
    wrong[3] = -1.0
    for information, line in (
        (wrong, "information of spot 3 is -1, below 0"),
        (wrong * math.nan, "information of spot 0 is not finite"),
        (wrong[1:], r"information has shape \(69,\), not \(70,\)"),
    ):
        with pytest.raises(InputError, match=line):
            FieldBelief(belief.model, belief.spots, information, np.zeros(70))
    with pytest.raises(InputError, match="vector of spot 0 is not finite"):
        FieldBelief(belief.model, belief.spots, np.zeros(70), wrong * math.nan)
    with pytest.raises(InputError, match="another grid"):
        FieldBelief.prior(belief.model, Spots(GridFrame(1.0, 7, 5)))
    with pytest.raises(InputError, match="dt must be > 0 s; got 0"):
        FieldBelief.prior(belief.model, belief.spots, dt=0.0)

"""The general formulation: what a finite model expects to know, against sums written out by hand."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from numpy.typing import NDArray

from vedette import InputError
from vedette.problem.interval import bernstein
from vedette.problem.model import FiniteModel, among, entropy

Float = NDArray[np.float64]


def columns(rng: np.random.Generator, rows: int, cols: int) -> Float:
    return np.asarray(rng.dirichlet(np.ones(rows), size=cols).T)


def drawn(rng: np.random.Generator, platforms: int = 3, actions: int = 2, states: int = 4) -> FiniteModel:
    sensors = [
        [columns(rng, int(rng.integers(2, 4)), states) for _ in range(actions)] for _ in range(platforms)
    ]
    return FiniteModel(rng.dirichlet(np.ones(states)), sensors, columns(rng, states, states))


def by_hand(model: FiniteModel, choice: tuple[int, ...]) -> float:
    """``sum_z P(z) sum_x P(x | z) ln P(x | z) - sum_x P(x) ln P(x)``, term by term."""
    assert model.motion is not None
    states = range(len(model.prior))
    before = [sum(model.motion[x, y] * model.prior[y] for y in states) for x in states]
    likelihoods = [own[u] for own, u in zip(model.sensors, choice, strict=True)]
    value = -sum(p * math.log(p) for p in before)
    for z in itertools.product(*(range(len(likelihood)) for likelihood in likelihoods)):
        joint = [
            before[x] * math.prod(like[k, x] for like, k in zip(likelihoods, z, strict=True)) for x in states
        ]
        value += sum(p * math.log(p / sum(joint)) for p in joint)
    return value


def test_the_value_is_the_entropy_that_observations_are_expected_to_remove() -> None:
    rng = np.random.default_rng(1)
    for _ in range(20):
        model = drawn(rng)
        choice = tuple(int(u) for u in rng.integers(2, size=3))
        assert model.value(choice) == pytest.approx(by_hand(model, choice), abs=1e-12)


def test_the_optimum_is_the_best_of_all_joint_actions() -> None:
    rng = np.random.default_rng(2)
    for _ in range(10):
        model = drawn(rng)
        values = {choice: by_hand(model, choice) for choice in itertools.product(range(2), repeat=3)}
        best = model.optimum()
        assert best.value == pytest.approx(max(values.values()), abs=1e-12)
        assert values[best.choice] == pytest.approx(best.value, abs=1e-12)


def test_the_posterior_is_bayes_rule_on_the_predicted_state() -> None:
    door = np.array([[0.9, 0.2], [0.1, 0.8]])  # P(seen open, seen shut | open, shut)
    model = FiniteModel(np.array([0.5, 0.5]), [[door]], np.array([[0.9, 0.0], [0.1, 1.0]]))
    np.testing.assert_allclose(model.predicted, [0.45, 0.55])
    np.testing.assert_allclose(model.posterior([0], [0]), np.array([0.405, 0.11]) / 0.515)
    assert entropy(np.array([0.25] * 4)) == pytest.approx(math.log(4))


def test_sampled_intervals_hold_the_exact_value_in_95_of_100() -> None:
    rng = np.random.default_rng(3)
    held, widths = 0, []
    for _ in range(100):
        model = drawn(rng)
        interval = model.sampled_value((0, 1, 0), rng, samples=4000)
        held += interval.low <= model.value((0, 1, 0)) <= interval.high
        widths.append(interval.width / entropy(model.predicted))
    assert held >= 95
    assert max(widths) < 0.2  # an interval that holds everything would say nothing


def test_the_interval_of_the_optimum_holds_it_in_95_of_100() -> None:
    rng = np.random.default_rng(4)
    held = 0
    for _ in range(100):
        model = drawn(rng, platforms=2)
        choice, interval = model.sampled_optimum(rng, samples=2000)
        held += interval.low <= model.optimum().value <= interval.high
        assert model.value(choice) >= interval.low - interval.width
    assert held >= 95


def test_the_mean_of_samples_of_a_rare_event_is_held_where_a_normal_interval_would_not() -> None:
    rng = np.random.default_rng(5)
    held = normal = 0
    for _ in range(200):
        samples = (rng.uniform(size=50) < 0.01).astype(float)
        interval = bernstein(samples, 1.0, 0.05)
        held += interval.low <= 0.01 <= interval.high
        normal += abs(samples.mean() - 0.01) <= 1.96 * samples.std(ddof=1) / math.sqrt(50)
    assert held >= 190 > normal


def test_a_platform_that_may_be_in_several_places_knows_in_which_it_is() -> None:
    rng = np.random.default_rng(6)
    prior, here, there = rng.dirichlet(np.ones(4)), columns(rng, 3, 4), columns(rng, 2, 4)
    alone = [FiniteModel(prior, [[likelihood]]).value((0,)) for likelihood in (here, there)]
    moved = FiniteModel(prior, [[among([(0.7, here), (0.3, there)])]])
    assert moved.value((0,)) == pytest.approx(0.7 * alone[0] + 0.3 * alone[1], abs=1e-12)


@pytest.mark.parametrize(
    ("prior", "sensors", "told"),
    [
        (np.array([0.5, 0.6]), [[np.ones((1, 2))]], "prior: probabilities must sum to 1"),
        (np.array([0.5, 0.5]), [[np.ones((2, 2))]], r"sensors\[0\]\[0\]: probabilities must sum to 1"),
        (np.array([0.5, 0.5]), [[np.ones((1, 3))]], r"sensors\[0\]\[0\]: probabilities must have shape"),
        (np.array([0.5, 0.5]), [[]], r"sensors\[0\] is empty"),
        (np.array([0.5, 0.5]), [], "sensors is empty"),
    ],
)
def test_what_is_no_model_is_refused_in_one_line(prior: Float, sensors: list[list[Float]], told: str) -> None:
    with pytest.raises(InputError, match=told):
        FiniteModel(prior, sensors)


def test_an_exact_sum_that_is_too_long_points_to_samples() -> None:
    sensor = np.full((10, 10), 0.1)
    model = FiniteModel(np.full(10, 0.1), [[sensor]] * 8)
    with pytest.raises(InputError, match="use sampled_value"):
        model.value([0] * 8)
    assert model.sampled_value([0] * 8, np.random.default_rng(0), 100).estimate == pytest.approx(
        0.0, abs=1e-9
    )

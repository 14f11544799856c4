"""The objective against dense determinants, its laws, and what a negotiation makes of it."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vedette import InputError, Tree, exhaustive, negotiate
from vedette.domains.monitoring.belief import FieldBelief
from vedette.domains.monitoring.field import FieldModel
from vedette.domains.monitoring.impact import NOTHING, FieldImpactCodec, Impact, impact_of, units_of
from vedette.domains.monitoring.objective import MonitoringBelief, MonitoringObjective
from vedette.domains.monitoring.spots import Spots
from vedette.domains.monitoring.worth import Patrol
from vedette.maps import GridFrame
from vedette.testing import check_objective

OBJECTIVE = MonitoringObjective()
FRAME = GridFrame(1.0, 6, 7)
SPOTS = 2 * FRAME.size
UNIT = 0.05


def frozen(seed: int, layers: int = 3, gamma: float = 0.6) -> MonitoringBelief:
    rng = np.random.default_rng(seed)
    model = FieldModel(FRAME, deviation=2.0, length=3.0, lasting=50.0)
    belief = FieldBelief.prior(model, Spots(FRAME, (1, 3)))
    spots = rng.integers(SPOTS, size=6)
    belief = belief.observe(spots, rng.normal(size=6), rng.uniform(0.1, 3.0, 6)).predict()
    return MonitoringBelief(belief, Patrol(30.0, layers, gamma), UNIT)


def random_impact(rng: np.random.Generator, layers: int = 3, most: int = 6) -> Impact:
    count = int(rng.integers(0, most))
    each = int(rng.choice([1, 20, 130]))
    return impact_of(rng.integers(SPOTS, size=count), rng.integers(layers, size=count), each, layers)


def dense_value(belief: MonitoringBelief, impact: Impact) -> float:
    """``sum_l (w_l - w_{l+1}) I_l``, by dense matrices and loops."""
    layers, prior = belief.patrol.layers, belief.field.precision.toarray()
    worth = [belief.patrol.gamma**layer for layer in range(layers)] + [0.0]
    total = 0.0
    for last in range(layers):
        units = np.zeros(SPOTS)
        for key, level in zip(impact.keys.tolist(), impact.misses.tolist(), strict=True):
            units[key // layers] += level * (key % layers <= last)
        weights = belief.field.spots.weights.toarray()
        after = prior + weights.T @ np.diag(UNIT * np.minimum(units, 255)) @ weights
        gain = 0.5 * (np.linalg.slogdet(after)[1] - np.linalg.slogdet(prior)[1])
        total += (worth[last] - worth[last + 1]) * gain
    return total


@settings(deadline=None, max_examples=30)
@given(st.integers(0, 10**6), st.integers(1, 4), st.sampled_from([0.3, 0.9, 1.0]))
def test_values_are_those_of_dense_determinants(seed: int, layers: int, gamma: float) -> None:
    rng = np.random.default_rng(seed)
    belief = frozen(seed, layers, gamma)
    others, own = random_impact(rng, layers, 9), [random_impact(rng, layers) for _ in range(4)]
    expected = [dense_value(belief, OBJECTIVE.combine(others, each)) for each in own]
    np.testing.assert_allclose(OBJECTIVE.values(belief, others, own), expected, rtol=1e-8, atol=1e-10)
    assert OBJECTIVE.value(belief, others) == pytest.approx(dense_value(belief, others), rel=1e-8, abs=1e-10)
    assert len(OBJECTIVE.values(belief, others, [])) == 0


@pytest.mark.parametrize("seed", range(6))
def test_the_objective_keeps_every_law_that_it_declares(seed: int) -> None:
    rng = np.random.default_rng(seed)
    impacts = [NOTHING, *(random_impact(rng) for _ in range(5))]
    check_objective(OBJECTIVE, frozen(seed), impacts)


@settings(deadline=None, max_examples=40)
@given(st.integers(0, 10**6))
def test_more_never_hurts_and_returns_diminish_where_units_saturate_too(seed: int) -> None:
    rng = np.random.default_rng(seed)
    belief = frozen(seed % 7)
    a, b, x = (random_impact(rng, most=12) for _ in range(3))
    value = [
        OBJECTIVE.value(belief, impact)
        for impact in (
            a,
            OBJECTIVE.combine(a, x),
            OBJECTIVE.combine(a, b),
            OBJECTIVE.combine(OBJECTIVE.combine(a, b), x),
        )
    ]
    assert value[1] >= value[0] - 1e-10
    assert value[1] - value[0] >= value[3] - value[2] - 1e-10


@pytest.mark.parametrize("seed", range(5))
def test_a_negotiation_ends_above_half_of_the_optimum_and_its_bound_above_all_of_it(seed: int) -> None:
    rng = np.random.default_rng(seed)
    belief = frozen(seed)
    candidates = [[random_impact(rng) for _ in range(4)] for _ in range(3)]
    codec = FieldImpactCodec(SPOTS, 3)
    result = negotiate(OBJECTIVE, belief, candidates, Tree.chain(3), codec=codec)
    best = exhaustive(OBJECTIVE, belief, candidates).value
    assert 0.5 * best <= result.value <= best + 1e-9
    assert result.bound is not None
    assert result.bound >= best - 1e-9


def test_what_is_known_sooner_is_worth_more() -> None:
    belief = frozen(0, gamma=0.5)
    by_layer = [OBJECTIVE.value(belief, impact_of(np.array([20]), np.array([k]), 40, 3)) for k in range(3)]
    assert by_layer[1] == pytest.approx(0.5 * by_layer[0])
    assert by_layer[2] == pytest.approx(0.25 * by_layer[0])
    undiscounted = frozen(0, gamma=1.0)
    same = [OBJECTIVE.value(undiscounted, impact_of(np.array([20]), np.array([k]), 40, 3)) for k in range(3)]
    assert same == pytest.approx([by_layer[0]] * 3)


def test_an_impact_counts_measurements_and_saturates() -> None:
    impact = impact_of(np.array([5, 5, 9, 5]), np.array([0, 0, 2, 1]), 100, 3)
    assert dict(zip(impact.keys.tolist(), impact.misses.tolist(), strict=True)) == {15: 200, 29: 100, 16: 100}
    assert OBJECTIVE.combine(impact, impact).misses.tolist() == [255, 200, 200]
    for a, b, c in itertools.permutations([impact, OBJECTIVE.combine(impact, impact), NOTHING]):
        assert OBJECTIVE.combine(OBJECTIVE.combine(a, b), c) == OBJECTIVE.combine(a, OBJECTIVE.combine(b, c))


def test_a_measurements_information_is_rounded_to_whole_units() -> None:
    assert units_of(0.5, 0.25) == 8
    assert units_of(1.0, 0.7) == 1
    assert units_of(1e-9, 0.25) == 255
    with pytest.raises(InputError, match="less than half a unit"):
        units_of(10.0, 0.25)
    for variance in (0.0, -1.0, np.inf, np.nan):
        with pytest.raises(InputError, match="variance must be > 0"):
            units_of(variance, 1.0)


@pytest.mark.parametrize(
    ("changes", "line"),
    [
        ({"horizon": 0.0}, "horizon must be > 0 s; got 0.0"),
        ({"horizon": np.inf}, "horizon must be > 0 s; got inf"),
        ({"layers": 0}, "layers must be 1 to 16; got 0"),
        ({"gamma": 0.0}, "gamma must be more than 0 and at most 1; got 0.0"),
        ({"gamma": 1.1}, "gamma must be more than 0 and at most 1; got 1.1"),
    ],
)
def test_a_patrol_that_cannot_be_is_refused(changes: dict[str, float], line: str) -> None:
    with pytest.raises(InputError, match=line):
        Patrol(**changes)  # type: ignore[arg-type]


def test_times_fall_into_layers_of_equal_length_and_late_ones_into_the_last() -> None:
    layers = Patrol(30.0, 3).layer(np.array([0.0, 9.99, 10.0, 29.0, 30.0, 99.0]))
    assert layers.tolist() == [0, 0, 1, 2, 2, 2]

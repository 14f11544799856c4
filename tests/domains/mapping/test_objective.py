"""The mapping objective: its laws, and the equations that it claims to be."""

from __future__ import annotations

import functools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.support.mapping_scenes import frozen
from vedette.domains.mapping import layers
from vedette.domains.mapping.belief import MapBelief
from vedette.domains.mapping.impact import NOTHING, Impact
from vedette.domains.mapping.layers import TimeLayers
from vedette.domains.mapping.objective import MappingObjective
from vedette.kernels.coverage import LAYERS
from vedette.kernels.misses import CERTAIN
from vedette.kernels.reference import coverage as reference
from vedette.kernels.reference.coverage import dense
from vedette.testing import check_objective

seeds = st.integers(0, 2**32 - 1)
worths = st.sampled_from([layers.rate(start=5.0), layers.rate(start=60.0), layers.rate(), layers.plain()])
OBJECTIVE = MappingObjective()


@functools.cache
def belief_with(worth: TimeLayers) -> MapBelief:
    return frozen(worth=worth)


def random_impact(rng: np.random.Generator, cells: int, most: int = CERTAIN) -> Impact:
    keys = np.unique(rng.integers(0, cells * LAYERS, rng.choice([0, 3, 400])))
    return Impact(keys.astype(np.uint32), rng.integers(1, most + 1, len(keys)).astype(np.uint8))


@settings(deadline=None, max_examples=15)
@given(seeds, worths)
def test_the_mapping_objective_keeps_the_laws_that_it_declares(seed: int, worth: TimeLayers) -> None:
    rng, belief = np.random.default_rng(seed), belief_with(worth)
    impacts = [random_impact(rng, 200) for _ in range(4)]
    certain = Impact(impacts[0].keys, np.full(len(impacts[0].keys), CERTAIN, np.uint8))
    check_objective(OBJECTIVE, belief, [NOTHING, certain, *impacts], tolerance=1e-6)  # saturation: (V20)


@settings(deadline=None, max_examples=50)
@given(seeds)
def test_combining_in_any_order_and_grouping_gives_the_same_bits(seed: int) -> None:
    rng = np.random.default_rng(seed)
    impacts = [random_impact(rng, 20) for _ in range(6)]
    expected = functools.reduce(OBJECTIVE.combine, impacts)
    for _ in range(5):
        left = [impacts[i] for i in rng.permutation(6)]
        while len(left) > 1:
            a, b = left.pop(rng.integers(len(left))), left.pop(rng.integers(len(left)))
            left.append(OBJECTIVE.combine(a, b))
        assert left[0] == expected


@settings(deadline=None, max_examples=50)
@given(seeds, worths)
def test_value_is_the_dense_sum_over_cells_and_layers(seed: int, worth: TimeLayers) -> None:
    belief = belief_with(worth)
    impact = random_impact(np.random.default_rng(seed), belief.planning.size)
    dense = reference.value(belief.weights, worth.weights, impact.sparse)
    assert OBJECTIVE.value(belief, impact) == pytest.approx(dense, rel=1e-9, abs=1e-12)


@settings(deadline=None, max_examples=50)
@given(seeds)
def test_under_rate_certain_sightings_are_worth_entropy_over_the_time_of_the_first(seed: int) -> None:
    rng, belief = np.random.default_rng(seed), belief_with(layers.rate())
    arrival = rng.integers(0, LAYERS, (3, 40))  # of three robots, at forty cells
    sighted = rng.random((3, 40)) < 0.6
    cells = rng.choice(belief.planning.size, 40, replace=False)
    team = NOTHING
    for layer, sees in zip(arrival, sighted, strict=True):
        keys = np.sort(cells[sees] * LAYERS + layer[sees]).astype(np.uint32)
        team = OBJECTIVE.combine(team, Impact(keys, np.full(len(keys), CERTAIN, np.uint8)))
    edges = belief.layers.edges
    expected = 0.0
    for c, cell in enumerate(cells):
        times = [edges[arrival[robot, c]] for robot in range(3) if sighted[robot, c]]
        expected += dense(belief.weights)[cell] / min(times) if times else 0.0
    assert OBJECTIVE.value(belief, team) == pytest.approx(expected, rel=1e-9)


@settings(deadline=None, max_examples=50)
@given(seeds)
def test_plain_is_the_papers_expected_entropy_in_gain_form_whatever_the_arrivals(seed: int) -> None:
    rng, belief = np.random.default_rng(seed), belief_with(layers.plain())
    robots = [random_impact(rng, 300, most=12) for _ in range(3)]
    entropy_left = dense(belief.weights).astype(np.float64)
    for impact in robots:
        np.multiply.at(entropy_left, impact.keys // LAYERS, np.exp(impact.misses / -16.0))
    gain = dense(belief.weights).sum(dtype=np.float64) - entropy_left.sum()
    value = OBJECTIVE.value(belief, functools.reduce(OBJECTIVE.combine, robots))
    assert value == pytest.approx(gain, rel=1e-9, abs=1e-9)


@settings(deadline=None, max_examples=50)
@given(seeds, worths, st.integers(0, LAYERS - 1))
def test_when_all_arrive_in_one_layer_value_is_the_plain_one_times_the_worth_of_that_time(
    seed: int, worth: TimeLayers, layer: int
) -> None:
    belief, plain = belief_with(worth), belief_with(layers.plain())
    rng = np.random.default_rng(seed)
    cells = np.unique(rng.integers(0, belief.planning.size, 100))
    keys = (cells * LAYERS + layer).astype(np.uint32)
    impact = Impact(keys, rng.integers(1, 256, len(keys)).astype(np.uint8))
    expected = worth.weights[layer:].sum() * OBJECTIVE.value(plain, impact)
    assert OBJECTIVE.value(belief, impact) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("tau", [3.0, 100.0, 1e6])
def test_the_worth_of_an_arrival_is_its_discount_at_the_edge_that_it_is_rounded_up_to(tau: float) -> None:
    edges = layers.rate().edges
    for worth, law in [(layers.rate(start=tau), 1.0 / (tau + edges)), (layers.rate(), 1.0 / edges)]:
        for arrival in [0.0, 2.0, 2.0001, 17.3, 500.0]:
            layer = worth.layer(arrival)
            assert worth.edges[layer] >= arrival
            assert layer == 0 or worth.edges[layer - 1] < arrival
            assert worth.weights[layer:].sum() == pytest.approx(law[layer])
        assert worth.layer(1e9) == LAYERS - 1
        assert (worth.weights >= 0).all()


@settings(deadline=None, max_examples=50)
@given(seeds, worths)
def test_to_see_the_same_earlier_is_never_worth_less(seed: int, worth: TimeLayers) -> None:
    rng, belief = np.random.default_rng(seed), belief_with(worth)
    others = random_impact(rng, 300)
    cells = np.unique(rng.integers(0, 300, 100))
    late = rng.integers(0, LAYERS, len(cells))
    early = rng.integers(0, late + 1)
    misses = rng.integers(1, 256, len(cells)).astype(np.uint8)
    own = [Impact((cells * LAYERS + layer).astype(np.uint32), misses) for layer in (late, early)]
    values = OBJECTIVE.values(belief, others, own)
    assert values[1] >= values[0] * (1 - 1e-12)


def test_reading_saturation_as_certain_costs_no_more_than_stated() -> None:
    belief = belief_with(layers.plain())
    cell = int(np.flatnonzero(dense(belief.weights))[0])
    key = np.array([cell * LAYERS], np.uint32)
    values = [OBJECTIVE.value(belief, Impact(key, np.array([q], np.uint8))) for q in range(1, 256)]
    gains = np.diff(values) / float(dense(belief.weights)[cell])
    assert np.all(np.diff(gains[:-1]) <= 1e-15)  # returns diminish up to the last step
    assert gains[-1] - gains[-2] <= np.exp(-255 / 16)

"""What each domain's objective says against the general problem: exact, or off by a stated share."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np
import pytest
from numpy.typing import NDArray

from tests.support.mapping_scenes import frozen
from vedette import Coverage, LogDet
from vedette.domains.mapping import layers
from vedette.domains.mapping.impact import Impact as MapImpact
from vedette.domains.mapping.impact import quantise as quantise_share
from vedette.domains.mapping.objective import MappingObjective
from vedette.domains.monitoring.belief import FieldBelief
from vedette.domains.monitoring.field import FieldModel
from vedette.domains.monitoring.impact import impact_of as monitoring_impact
from vedette.domains.monitoring.objective import MonitoringBelief, MonitoringObjective
from vedette.domains.monitoring.spots import Spots
from vedette.domains.monitoring.worth import Patrol
from vedette.domains.search import worth
from vedette.domains.search.belief import TargetPdf, freeze
from vedette.domains.search.impact import Impact as SearchImpact
from vedette.domains.search.impact import quantise
from vedette.domains.search.objective import SearchObjective
from vedette.domains.tracking.belief import tracks
from vedette.domains.tracking.models import static
from vedette.domains.tracking.objective import TrackingObjective
from vedette.domains.tracking.platform import TrackingPlatform
from vedette.domains.tracking.sensing import Sensor
from vedette.domains.tracking.sensors import BearingOnly, Position, RangeOnly
from vedette.kernels.coverage import LAYERS
from vedette.maps import GridFrame
from vedette.problem.model import FiniteModel

Float = NDArray[np.float64]


# -- mapping: cells that are occupied or empty, all independent ---------------------------------------


def maps(cells: int) -> NDArray[np.int64]:
    """All ``2^cells`` maps, a row each."""
    return np.array(list(itertools.product((0, 1), repeat=cells)))


def chances(states: NDArray[np.int64], occupied: Float) -> Float:
    return np.asarray(np.prod(np.where(states == 1, occupied, 1.0 - occupied), axis=1))


def entropies(occupied: Float) -> Float:
    return np.asarray(-occupied * np.log(occupied) - (1.0 - occupied) * np.log1p(-occupied))


def glances(states: NDArray[np.int64], miss: Float) -> Float:
    """A sensor that shows each cell's state with probability ``1 - miss``, whatever the others' are."""
    rows = []
    for seen in itertools.product((0, 1, None), repeat=len(miss)):
        row = np.ones(len(states))
        for s, state in enumerate(seen):
            row *= miss[s] if state is None else (1.0 - miss[s]) * (states[:, s] == state)
        rows.append(row)
    return np.array(rows)


def ray(states: NDArray[np.int64], order: Sequence[int]) -> Float:
    """A perfect sensor along a ray: it sees the cells in this order, to the first occupied one (eq. (32))."""
    found: dict[tuple[int, ...], Float] = {}
    for k, state in enumerate(states):
        seen = [2] * states.shape[1]
        for s in order:
            seen[s] = int(state[s])
            if state[s]:
                break
        found.setdefault(tuple(seen), np.zeros(len(states)))[k] = 1.0
    return np.array(list(found.values()))


def test_coverage_is_exact_for_cells_that_are_seen_independently() -> None:
    rng, states = np.random.default_rng(1), maps(3)
    for _ in range(10):
        occupied, miss = rng.uniform(0.1, 0.9, 3), rng.uniform(size=(2, 3))
        miss[0, 0] = 0.0
        model = FiniteModel(chances(states, occupied), [[glances(states, own)] for own in miss])
        value = Coverage().value(entropies(occupied), miss[0] * miss[1])
        assert value == pytest.approx(model.value((0, 0)), abs=1e-12)


def test_coverage_is_exact_for_rays_from_opposite_ends_and_overstates_two_along_one_ray() -> None:
    cells, occupied = 6, np.full(6, 0.2)
    states = maps(cells)
    there, back = ray(states, range(cells)), ray(states, range(cells)[::-1])
    model = FiniteModel(chances(states, occupied), [[there], [there, back]])
    miss = 1.0 - 0.8 ** np.arange(cells)  # eq. (36): all the cells before are empty
    weights = entropies(occupied)
    assert Coverage().value(weights, miss * miss[::-1]) == pytest.approx(model.value((0, 1)), abs=1e-12)
    apart = Coverage().value(weights, miss * miss) / model.value((0, 0)) - 1.0
    assert apart == pytest.approx(0.299, abs=1e-3)  # docs/theory.md, section 9


def test_the_mapping_objective_rounds_shares_and_is_within_three_percent_of_coverage() -> None:
    rng = np.random.default_rng(2)
    belief = frozen(worth=layers.plain())
    window = belief.weights.window.ravel().astype(np.float64)
    local = np.flatnonzero(window > 0.0)[:200]
    cells, apart = belief.planning_cells(local.astype(np.uint32)), []
    for _ in range(20):
        shares = rng.uniform(size=(2, len(cells))).astype(np.float32)
        seen = [quantise_share(own) for own in shares]
        impacts = [MapImpact((cells[own > 0] * LAYERS).astype(np.uint32), own[own > 0]) for own in seen]
        objective = MappingObjective()
        value = objective.value(belief, objective.combine(*impacts))
        miss = np.prod(1.0 - shares.astype(np.float64), axis=0)
        apart.append(value / Coverage().value(window[local], miss) - 1.0)
    assert np.abs(apart).max() < 0.03


# -- Gaussian states -------------------------------------------------------------------------------------


def bins(z: Float, of_state: Float, deviation: float) -> Float:
    """``P(z | x)`` on a lattice of measurements, (Z, S)."""
    density = np.exp(-0.5 * ((z[:, None] - of_state) / deviation) ** 2)
    return np.asarray(density / density.sum(axis=0))


def lattice(of_state: Float, deviation: float) -> Float:
    return np.arange(of_state.min() - 4.0 * deviation, of_state.max() + 4.0 * deviation, deviation / 2.0)


def test_log_det_is_exact_for_linear_gaussian_measurements() -> None:
    x = np.linspace(-5.0, 5.0, 81)
    prior = np.exp(-0.5 * x**2)
    noises = (1.0, 0.7)
    model = FiniteModel(prior / prior.sum(), [[bins(lattice(x, s), x, s)] for s in noises])
    value = LogDet().value(np.eye(1), np.array([[sum(s**-2 for s in noises)]]))
    assert value == pytest.approx(model.value((0, 0)), rel=1e-4)  # what the lattice leaves


def tracked(sensor: Sensor, deviation: float, speed: float = 5.0) -> tuple[float, float]:
    """A target 20 m off, known to ``deviation``, seen along x and along y: the model's value, and ours."""
    axis = np.linspace(-4.5, 4.5, 41) * deviation
    points = np.stack(np.meshgrid(20.0 + axis, axis), -1).reshape(-1, 2)
    prior = np.exp(-0.5 * (((points - (20.0, 0.0)) / deviation) ** 2).sum(axis=1))
    belief = tracks(
        [static(1.0, 0.0)], [np.array([20.0, 0.0])], [np.eye(2) * deviation**2], dt=1.0, horizon=1
    )
    objective, likelihoods, impacts = TrackingObjective(), [], []
    for x, y, heading in ((0.0, 0.0, 0.0), (20.0, -20.0, math.pi / 2.0)):
        platform = TrackingPlatform(speed, 0.0, sensor)
        platform.place(x - speed * math.cos(heading), y - speed * math.sin(heading), heading)
        platform.prepare(belief)
        assert platform.candidates is not None
        impacts.append(platform.candidates[0])
        measured = measurements(sensor, points - (x, y), heading)
        likelihoods.append([bins(lattice(measured, noise := sensor.deviations[0]), measured, noise)])
    model = FiniteModel(prior / prior.sum(), likelihoods)
    return model.value((0, 0)), objective.value(belief, objective.combine(*impacts))


def measurements(sensor: Sensor, offsets: Float, heading: float) -> Float:
    if isinstance(sensor, RangeOnly):
        return np.asarray(np.hypot(*offsets.T))
    angles = np.arctan2(offsets[:, 1], offsets[:, 0]) - heading
    return np.asarray((angles + np.pi) % (2.0 * np.pi) - np.pi)


@pytest.mark.parametrize(
    "sensor", [BearingOnly(range=200.0, bearing_noise=5.0), RangeOnly(range=200.0, range_noise=1.0)]
)
@pytest.mark.parametrize(
    ("deviation", "least", "most"), [(0.25, -0.001, 0.0), (1.0, -0.02, -0.01), (2.0, -0.15, -0.12)]
)
def test_the_tracking_objective_understates_looks_at_badly_known_targets(
    sensor: Sensor, deviation: float, least: float, most: float
) -> None:
    model, ours = tracked(sensor, deviation)
    assert least <= ours / model - 1.0 <= most  # docs/theory.md, section 9


@pytest.mark.parametrize(("deviation", "least", "most"), [(0.5, -0.021, -0.015), (2.0, -0.73, -0.71)])
def test_from_a_pivot_the_tracking_objective_understates_more(
    deviation: float, least: float, most: float
) -> None:
    for sensor in (BearingOnly(range=200.0, bearing_noise=5.0), RangeOnly(range=200.0, range_noise=1.0)):
        model, ours = tracked(sensor, deviation, speed=0.0)
        assert least <= ours / model - 1.0 <= most


def test_the_tracking_objective_is_exact_for_places() -> None:
    x = np.linspace(-4.5, 4.5, 81)
    prior = np.exp(-0.5 * x**2)
    model = FiniteModel(prior / prior.sum(), [[bins(lattice(x, 0.5), x, 0.5)]] * 2)  # one of two axes
    belief = tracks([static(1.0, 0.0)], [np.zeros(2)], [np.eye(2)], dt=1.0, horizon=1)
    platform = TrackingPlatform(0.0, 0.0, Position(range=10.0, noise=0.5))
    platform.place(1.0, 0.0, 0.0)
    platform.prepare(belief)
    assert platform.candidates is not None
    both = TrackingObjective().combine(platform.candidates[0], platform.candidates[0])
    assert TrackingObjective().value(belief, both) == pytest.approx(2.0 * model.value((0, 0)), rel=1e-4)


def test_the_monitoring_objective_is_exact_for_a_field_that_stands_still_up_to_the_unit_of_information() -> (
    None
):
    frame = GridFrame(1.0, 2, 2)
    field = FieldBelief.prior(FieldModel(frame, deviation=1.0, length=2.0, lasting=100.0), Spots(frame, (1,)))
    covariance = np.linalg.inv(field.precision.toarray())[:2, :2]  # of the two cells that are measured
    precision = np.linalg.inv(covariance)
    axis = np.linspace(-4.5, 4.5, 41)
    points = np.stack(np.meshgrid(axis, axis), -1).reshape(-1, 2)
    prior = np.exp(-0.5 * np.einsum("ni,ij,nj->n", points, precision, points))
    noises = (0.5, 0.8)  # of one robot in each cell
    likelihoods = [[bins(lattice(x, noise), x, noise)] for x, noise in zip(points.T, noises, strict=True)]
    model = FiniteModel(prior / prior.sum(), likelihoods)
    unit = 0.02
    looks = [
        monitoring_impact(np.array([cell]), np.array([0]), round(noise**-2 / unit), 1)
        for cell, noise in enumerate(noises)
    ]
    belief = MonitoringBelief(field, Patrol(30.0, 1, 1.0), unit)
    value = MonitoringObjective().value(belief, MonitoringObjective().combine(*looks))
    assert value == pytest.approx(model.value((0, 0)), rel=5e-3)
    assert covariance[0, 1] > 0.3  # each says something of the other's cell


# -- search: where a target is ----------------------------------------------------------------------------


def test_the_search_objective_is_the_chance_of_a_report_and_chooses_nearly_what_entropy_would() -> None:
    rng, frame = np.random.default_rng(0), GridFrame(1.0, 3, 4, 0.0, 0.0)
    objective, shares = SearchObjective(), []
    for _ in range(40):
        weights = rng.exponential(size=frame.shape)
        belief = freeze(TargetPdf(frame, weights, dt=1.0), worth.plain(1, tail=0.0))
        looks = [[some_look(rng) for _ in range(3)] for _ in range(2)]
        prior = (weights / weights.sum()).ravel()
        model = FiniteModel(prior, [[np.vstack((np.diag(p), 1.0 - p)) for p in own] for own in looks])
        ours = {}
        for choice in itertools.product(range(3), repeat=2):
            a, b = (own[k] for own, k in zip(looks, choice, strict=True))
            ours[choice] = objective.value(belief, objective.combine(impact_of(a), impact_of(b)))
            assert ours[choice] == pytest.approx(float(prior @ (1.0 - (1.0 - a) * (1.0 - b))), abs=0.003)
        shares.append(model.value(max(ours, key=ours.__getitem__)) / model.optimum().value)
    assert np.mean(shares) > 0.99  # docs/theory.md, section 9
    assert min(shares) > 0.89


def some_look(rng: np.random.Generator) -> Float:
    """Detection probabilities of a look at four of twelve cells."""
    probability = np.zeros(12)
    probability[rng.choice(12, 4, replace=False)] = rng.choice([0.5, 0.8, 1.0], 4)
    return probability


def impact_of(probability: Float) -> SearchImpact:
    levels = quantise(probability)
    return SearchImpact(np.flatnonzero(levels).astype(np.uint32), levels[levels > 0])

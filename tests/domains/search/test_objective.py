"""The search objective: its laws, dense and Monte-Carlo oracles, and what negotiation makes of it."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from tests.support.search_scenes import MOVING, OBJECTIVE, frozen, pdf, random_impact, team
from vedette import Tree, negotiate
from vedette.domains.search import worth
from vedette.domains.search.belief import SearchBelief, TargetPdf, freeze
from vedette.domains.search.impact import NOTHING, Impact
from vedette.domains.search.motion import STILL, TargetMotion
from vedette.domains.search.worth import Worth
from vedette.errors import InputError
from vedette.maps import GridFrame
from vedette.problem import exhaustive
from vedette.testing import check_objective

MOTIONS = [STILL, MOVING]


@pytest.mark.parametrize("motion", MOTIONS)
@pytest.mark.parametrize("worths", [worth.plain(4), worth.discounted(4, 0.8, 0.5), worth.mean_time(4, 0.0)])
def test_the_search_objective_keeps_the_laws_that_it_declares(motion: TargetMotion, worths: Worth) -> None:
    belief = frozen(motion, worths)
    rng = np.random.default_rng(3)
    impacts = [NOTHING, random_impact(belief, rng, certain=True), random_impact(belief, rng, certain=True)]
    impacts += [random_impact(belief, rng) for _ in range(3)]
    platform = team(belief, size=1)[0]
    assert platform.options is not None
    impacts += [platform.impact(belief, flight) for flight in platform.options.flights[::40]]
    check_objective(OBJECTIVE, belief, impacts)


def transitions(target: TargetPdf) -> NDArray[np.float64]:
    """The whole transition matrix, a column at a time."""
    columns = []
    for cell in range(target.frame.size):
        unit = np.zeros(target.frame.size)
        unit[cell] = 1.0
        moved = TargetPdf(target.frame, unit.reshape(target.frame.shape), target.motion, target.dt).predict()
        columns.append(moved.mass.ravel())
    return np.array(columns).T


def dense_misses(belief: SearchBelief, impact: Impact) -> NDArray[np.float64]:
    misses = np.ones(belief.frame.size * belief.layers)
    misses[impact.keys] = np.exp(impact.misses / -16.0)
    return misses.reshape(-1, belief.layers)


def small(motion: TargetMotion, horizon: int = 4) -> tuple[TargetPdf, SearchBelief]:
    frame = GridFrame(10.0, 7, 6)
    target = TargetPdf(frame, np.random.default_rng(1).random(frame.shape) ** 4, motion, 2.0)
    return target, freeze(target, worth.discounted(horizon, 0.9, 0.0))


@pytest.mark.parametrize("motion", MOTIONS)
def test_values_equal_the_dense_filter_over_the_whole_transition_matrix(motion: TargetMotion) -> None:
    target, belief = small(motion)
    matrix = transitions(target)
    rng = np.random.default_rng(2)

    def some() -> Impact:
        keys = np.flatnonzero(rng.random(belief.frame.size * belief.layers) < 0.3).astype(np.uint32)
        return Impact(keys, rng.integers(1, 100, len(keys)).astype(np.uint8))

    others, own = some(), [some() for _ in range(6)]
    for mine, impact in zip(OBJECTIVE.values(belief, others, own), own, strict=True):
        misses = dense_misses(belief, others) * dense_misses(belief, impact)
        left, expected = belief.mass.ravel(), 0.0
        for layer in range(belief.layers):
            present = matrix @ left
            left = present * misses[:, layer]
            expected += belief.worth.weights[layer] * (present.sum() - left.sum())
        assert mine == pytest.approx(expected, abs=1e-12)


def test_scoring_a_path_by_one_forward_backward_pass_overstates_it_and_values_does_not() -> None:
    """Each step's dot product counts mass that the path itself took in other steps."""
    _, belief = small(STILL, horizon=5)
    plain = SearchBelief(belief.frame, belief.mass, belief.stencil, 2.0, 0, worth.plain(5, tail=0.0))
    cells = np.argsort(belief.mass.ravel())[-8:].astype(np.uint32)
    keys = np.sort((cells[:, None] * 5 + np.arange(5, dtype=np.uint32)).ravel())
    lingering = Impact(keys, np.full(len(keys), 16, np.uint8))  # 63 % in each of five steps
    true = OBJECTIVE.values(plain, NOTHING, [lingering])[0]
    seen = belief.mass.ravel()[cells].sum()
    shortcut = 5 * seen * (1 - np.exp(-1.0))
    assert true == pytest.approx(seen * (1 - np.exp(-5.0)), abs=1e-12)
    assert shortcut > 3.0 * true


def test_mean_time_worth_is_the_expected_time_cut_at_the_horizon() -> None:
    _, belief = small(MOVING)
    belief = SearchBelief(belief.frame, belief.mass, belief.stencil, 2.0, 0, worth.mean_time(4, 0.0))
    impact = Impact(np.arange(0, belief.frame.size * 4, 3, dtype=np.uint32), np.full(56, 20, np.uint8))
    detected = OBJECTIVE.detected(belief, impact)
    step = detected @ np.arange(4) + (1 - detected.sum()) * 4  # of detection, counted from 0
    assert 4 * (1 - OBJECTIVE.value(belief, impact)) == pytest.approx(step, abs=1e-12)


@pytest.mark.parametrize("motion", MOTIONS)
def test_predicted_probability_of_detection_agrees_with_monte_carlo_over_the_true_target(
    motion: TargetMotion,
) -> None:
    belief, target = frozen(motion, worth.plain(4, 0.0)), pdf(motion)
    platforms = team(belief)
    for i, platform in enumerate(platforms):
        platform.present = platform.reply(belief, NOTHING, platform.start)
        platform.present = platform.options.flights[i * 25] if i else platform.present
    impact = NOTHING
    for platform in platforms:
        impact = OBJECTIVE.combine(impact, platform.impact(belief, platform.present))
    predicted = OBJECTIVE.detected(belief, impact).sum()
    assert predicted > 0.05
    rng, runs = np.random.default_rng(5), 1500
    cells = rng.choice(belief.frame.size, runs, p=belief.mass.ravel())
    places = belief.frame.centres(cells) + rng.uniform(-10.0, 10.0, (runs, 2))
    found = np.zeros(runs, bool)
    for step in range(belief.horizon):
        places = motion.move(rng, places, belief.frame, belief.dt)
        for platform in platforms:
            looks = platform.look_poses(platform.pose, platform.present.turn_rates[step], belief.dt)
            platform.pose = looks[-1]
            for k in np.flatnonzero(~found):
                found[k] = any(platform.detector.glimpse(rng, pose, places[k]) for pose in looks)
    assert target.dt == belief.dt
    sigma = np.sqrt(predicted * (1 - predicted) / runs)
    assert abs(found.mean() - predicted) < 3.0 * sigma


@pytest.mark.parametrize("motion", MOTIONS)
def test_token_negotiation_reaches_most_of_the_best_joint_choice(motion: TargetMotion) -> None:
    belief = frozen(motion)
    candidates = []
    for platform in team(belief):
        assert platform.options is not None
        flights = platform.options.flights[::9]
        candidates.append([platform.impact(belief, flight) for flight in flights])
    best = exhaustive(OBJECTIVE, belief, candidates).value
    agreed = negotiate(OBJECTIVE, belief, candidates, Tree.chain(3))
    assert agreed.converged
    assert agreed.bound is not None
    assert 0.9 * best <= agreed.value <= best + 1e-9
    assert best <= agreed.bound + 1e-9


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: worth.plain(0), "horizon"),
        (lambda: worth.plain(3, 1.5), "tail"),
        (lambda: worth.discounted(3, 1.1), "gamma"),
        (lambda: Worth(np.array([0.5, 1.0]), 2), "never rise"),
        (lambda: Worth(np.array([1.0, np.nan]), 2), "never rise"),
    ],
)
def test_a_bad_worth_is_refused(make: object, words: str) -> None:
    with pytest.raises(InputError, match=words):
        make()  # type: ignore[operator]

"""Uncertain motion and endless horizons: what they are worth, and that they change decisions, by domain."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest

from tests.support.mapping_scenes import CORRIDOR, SPEC, explored, frozen
from tests.support.search_scenes import MOVING, OBJECTIVE, SEA
from tests.support.tracking_scenes import random_impact, random_tracks
from vedette import InputError, Tree, negotiate
from vedette.domains.mapping import layers
from vedette.domains.mapping.impact import NOTHING
from vedette.domains.mapping.objective import MappingObjective
from vedette.domains.mapping.platform import MappingPlatform
from vedette.domains.mapping.tour import STAY
from vedette.domains.search import worth
from vedette.domains.search.belief import SearchBelief, TargetPdf, freeze
from vedette.domains.search.detectors import DefiniteRange
from vedette.domains.search.platform import SearchPlatform
from vedette.domains.search.priors import GaussianPart, gaussians
from vedette.domains.tracking.belief import Tracks, tracks
from vedette.domains.tracking.gusts import drawn_courses
from vedette.domains.tracking.models import constant_velocity, static
from vedette.domains.tracking.objective import Endless, TrackingObjective
from vedette.domains.tracking.platform import TrackingPlatform
from vedette.domains.tracking.sensors import RangeBearing
from vedette.kernels.tracking import chain_values
from vedette.problem.sampled import Sampled
from vedette.testing import check_objective
from vedette.vehicle import Gust

# -- search --------------------------------------------------------------------------------------------


def sea(*spots: tuple[float, float, float], steps: int = 3) -> SearchBelief:
    """A sea where the target is near one of these places (x, y, weight) [m]."""
    parts = [GaussianPart((x, y), 40.0, weight) for x, y, weight in spots]
    return freeze(TargetPdf(SEA, gaussians(SEA, parts), dt=2.0), worth.plain(steps, tail=0.0))


def searcher(belief: SearchBelief, gusts: tuple[Gust, ...] = (Gust(1.0, (0.0, 0.0)),)) -> SearchPlatform:
    platform = SearchPlatform(
        speed=30.0, turn_rate=0.4, detector=DefiniteRange(0.9, 60.0), controls=3, gusts=gusts
    )
    platform.place((0.0, 400.0, np.pi / 2), None)
    platform.prepare(belief)
    return platform


def test_a_flights_expected_misses_are_the_mean_over_the_gusts_for_a_look_by_itself() -> None:
    belief = sea((0.0, 480.0, 1.0), steps=1)
    gusts = (Gust(0.5, (25.0, 0.0)), Gust(0.3, (-25.0, 0.0)), Gust(0.2, (0.0, 0.0)))
    expected = searcher(belief, gusts)
    apart = [searcher(belief, (Gust(1.0, gust.wind),)) for gust in gusts]
    assert expected.options is not None
    for flight in expected.options.flights:
        values = [OBJECTIVE.value(belief, own.impact(belief, flight)) for own in apart]
        mean = sum(gust.chance * value for gust, value in zip(gusts, values, strict=True))
        assert OBJECTIVE.value(belief, expected.impact(belief, flight)) == pytest.approx(mean, abs=0.01)


def test_a_searcher_that_may_be_blown_off_flies_elsewhere_than_one_that_is_sure_of_its_way() -> None:
    belief = sea((0.0, 560.0, 1.0), (130.0, 500.0, 0.8))
    nothing = OBJECTIVE.nothing(belief)
    sure = searcher(belief)
    blown = searcher(belief, (Gust(0.5, (-40.0, 0.0)), Gust(0.5, (40.0, 0.0))))
    flights = [own.reply(belief, nothing, own.start) for own in (sure, blown)]
    assert flights[0] != flights[1]
    gains = blown.gains(belief, nothing)
    assert blown.options is not None
    index = blown.options.index
    assert gains[index[flights[1]]] > 1.05 * gains[index[flights[0]]]  # in the winds that there are


def test_gusts_that_do_not_add_up_are_refused() -> None:
    with pytest.raises(InputError, match="chances must sum to 1"):
        SearchPlatform(gusts=(Gust(0.5, (1.0, 0.0)),))
    with pytest.raises(InputError, match="chance must be from 0 to 1"):
        Gust(1.5, (0.0, 0.0))
    with pytest.raises(InputError, match="two finite speeds"):
        Gust(1.0, (float("nan"), 0.0))


# -- tracking ------------------------------------------------------------------------------------------


def two_targets() -> Tracks:
    """A target ahead, and a better known one aside."""
    spread = np.diag([25.0, 25.0])
    return tracks(
        [static(1.0, 0.0)] * 2,
        [np.array([60.0, 0.0]), np.array([40.0, 40.0])],
        [spread, 0.8 * spread],
        dt=1.0,
        horizon=4,
    )


def test_a_tracker_that_may_be_blown_off_takes_another_course() -> None:
    belief, objective = two_targets(), TrackingObjective()
    platform = TrackingPlatform(10.0, 0.3, RangeBearing(range=32.0, view=90.0), objective)
    platform.place(0.0, 0.0, 0.3)
    rng = np.random.default_rng(1)
    calm = drawn_courses(platform, belief, [Gust(1.0, (0.0, 0.0))], 1, rng)
    winds = [Gust(0.5, (-6.0, 6.0)), Gust(0.5, (-6.0, -6.0))]
    windy = drawn_courses(platform, belief, winds, 32, rng)
    assert calm[0] == windy[0]
    best = [
        int(np.argmax(Sampled(objective, k).values(belief, Sampled(objective, k).nothing(belief), impacts)))
        for k, (_, impacts) in ((1, calm), (32, windy))
    ]
    values = [Sampled(objective, 32).value(belief, windy[1][c]) for c in best]
    assert best[0] != best[1]
    assert values[1] > 1.02 * values[0]  # in the winds that there are


def test_teams_negotiate_on_draws_of_their_motion() -> None:
    belief, rng = two_targets(), np.random.default_rng(2)
    candidates = []
    for y in (0.0, 30.0):
        platform = TrackingPlatform(10.0, 0.3, RangeBearing(range=32.0, view=90.0))
        platform.place(0.0, y, 0.3)
        winds = [Gust(0.5, (0.0, 6.0)), Gust(0.5, (0.0, -6.0))]
        candidates.append(drawn_courses(platform, belief, winds, 8, rng)[1])
    result = negotiate(Sampled(TrackingObjective(), 8), belief, candidates, Tree.chain(2))
    assert result.converged
    assert result.bound is not None
    assert 0.0 < result.value <= result.bound


# -- mapping -------------------------------------------------------------------------------------------


def test_a_robot_that_may_get_stuck_on_its_way_leaves_the_far_room_for_the_near_one() -> None:
    belief = frozen(explored(CORRIDOR), worth=layers.plain())  # when it is seen does not count
    ways = []
    for stall in (0.0, 0.5):
        robot = MappingPlatform(SPEC, max_stops=1, stall=stall)
        robot.place(3.0, 7.1, [], [], 0.0)
        robot.prepare(belief)
        assert robot.stops is not None
        tour = robot.reply(belief, NOTHING, STAY)
        ways.append(float(tour.arrivals[0]))
    assert ways[1] < ways[0]


def test_stalls_scale_each_stops_shares_by_the_chance_to_get_there() -> None:
    belief = frozen(explored(CORRIDOR), worth=layers.plain())
    sure, unsure = (MappingPlatform(SPEC, max_stops=1, stall=stall) for stall in (0.0, 0.1))
    values = []
    for robot in (sure, unsure):
        robot.place(3.0, 7.1, [], [], 0.0)
        robot.prepare(belief)
        tours = [robot.tour(np.array([k])) for k in range(len(robot.stops or ()))]
        values.append([MappingObjective().value(belief, robot.impact(belief, tour)) for tour in tours])
    assert sure.stops is not None
    chance = np.exp(-0.1 * sure.stops.first_leg * SPEC.speed)
    some = np.array(values[0]) > 0.2 * max(values[0])  # small shares round to nothing
    np.testing.assert_allclose(np.array(values[1])[some], (chance * values[0])[some], rtol=0.15)


# -- endless horizons ------------------------------------------------------------------------------------


def test_endless_worth_counts_promises_by_when_they_would_be_kept() -> None:
    weights = worth.endless(4, 0.9).weights
    np.testing.assert_allclose(weights[:4], 0.9 ** np.arange(4))
    np.testing.assert_allclose(weights[4:], 0.9 ** (4 * (1.0 + worth.DELAYS)))
    patient, hasty = worth.endless(4, 0.999).weights, worth.endless(4, 0.5).weights
    assert patient[6] / patient[0] > 0.9 > 0.01 > hasty[6] / hasty[0]
    for gamma in (0.0, 1.0):
        with pytest.raises(InputError, match="less than 1 for an endless horizon"):
            worth.endless(4, gamma)


def test_a_patient_searcher_leaves_for_the_far_place_that_holds_more_and_a_hasty_one_stays() -> None:
    parts = [GaussianPart((60.0, 460.0), 60.0, 1.0), GaussianPart((800.0, 1000.0), 60.0, 3.0)]
    target = TargetPdf(SEA, gaussians(SEA, parts), MOVING, dt=2.0)
    goals = []
    for gamma in (0.5, 0.995):
        belief = freeze(target, worth.endless(4, gamma))
        platform = searcher(belief)
        flight = platform.reply(belief, OBJECTIVE.nothing(belief), platform.start)
        assert flight.goal is not None
        goals.append(np.hypot(flight.goal[0] - 800.0, flight.goal[1] - 1000.0))
    assert goals[1] < 200.0 < goals[0]


@pytest.mark.parametrize("seed", range(4))
def test_the_endless_objective_is_the_discounted_sum_of_the_steps_gains(seed: int) -> None:
    rng = np.random.default_rng(seed)
    belief, objective = random_tracks(rng), Endless()
    impact = random_impact(rng, belief)
    starts = np.array([0, 0])
    upto = [0.0]
    for k in range(1, belief.horizon + 1):
        nobody = impact.targets[:0], np.zeros((0, k, 3))
        team = impact.targets, np.ascontiguousarray(impact.blocks[:, :k])
        upto.append(float(chain_values(belief.motion, "trajectory", team, starts, nobody)[0]))
    gains = np.diff(upto)
    gamma = objective.discount(belief)
    expected = float(gains @ gamma ** np.arange(belief.horizon))
    assert objective.value(belief, impact) == pytest.approx(expected, rel=1e-12)


def test_the_endless_objective_keeps_its_laws_with_and_without_layers() -> None:
    rng = np.random.default_rng(7)
    belief = random_tracks(rng)
    check_objective(Endless(), belief, [random_impact(rng, belief) for _ in range(4)])


def test_its_gradient_agrees_with_differences() -> None:
    rng = np.random.default_rng(8)
    belief, objective = random_tracks(rng), Endless()
    impact = random_impact(rng, belief)
    slope = objective.gradient(belief, impact)
    for at in itertools.islice(np.ndindex(impact.blocks.shape), 6):
        step = np.zeros_like(impact.blocks)
        step[at] = 1e-6
        ends = [replace(impact, blocks=impact.blocks + sign * step) for sign in (1.0, -1.0)]
        difference = (objective.value(belief, ends[0]) - objective.value(belief, ends[1])) / 2e-6
        assert slope[at] == pytest.approx(difference, rel=1e-4, abs=1e-7)


def leaving(far: tuple[float, ...]) -> Tracks:
    """A target that is known well where the vehicle is, and one 300 m off that is not."""
    spread = [np.diag([0.01, 0.01]), np.diag([400.0, 400.0, 1.0, 1.0])]
    means = [np.array([20.0, 0.0]), np.array([300.0, 0.0, 0.0, 0.0])]
    models = [static(1.0, 0.0), constant_velocity(1.0, 0.01)]
    return tracks(models, means, spread, dt=1.0, horizon=4, layers=far)


def test_layers_count_by_the_discount_of_their_steps_and_the_last_for_ever() -> None:
    ends = (10.0, 26.0, 120.0)
    gamma = Endless().discount(leaving(ends))
    steps = np.arange(4, 4000)
    layer = np.searchsorted(4 + np.array(ends[:-1]), steps, side="right")
    weights = Endless().layer_weights(leaving(ends))
    np.testing.assert_allclose(weights, np.bincount(layer, gamma**steps), rtol=1e-9)


def test_an_endless_tracker_leaves_a_target_it_knows_for_one_that_a_finite_horizon_does_not_see() -> None:
    plans = []
    for objective, far in ((TrackingObjective(), ()), (Endless(), (10.0, 26.0, 68.0, 170.0))):
        belief = leaving(far)
        platform = TrackingPlatform(10.0, 0.5, RangeBearing(range=60.0, view=120.0), objective)
        platform.place(0.0, 0.0, 0.0)
        platform.prepare(belief)
        start = platform.carry_over(belief, None)
        plans.append(platform.reply(belief, objective.nothing(belief), start))
    assert [plan.target for plan in plans] == [None, 1]

"""Trackers: what they can do, their replies, their negotiation, and their continuous controls."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from dataclasses import replace
from functools import reduce

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from tests.support.tracking_scenes import SIDE, random_impact, random_platform, random_tracks
from vedette import Tree, exhaustive, negotiate
from vedette.domains.tracking.ascent import ascend, turn_rate_gradient
from vedette.domains.tracking.belief import tracks
from vedette.domains.tracking.codec import TrackImpactCodec
from vedette.domains.tracking.courses import Course, sequences
from vedette.domains.tracking.models import constant_velocity, static
from vedette.domains.tracking.objective import OBJECTIVES, FinalEntropy, TrackingObjective
from vedette.domains.tracking.platform import TrackingPlatform
from vedette.domains.tracking.sensing import Sensor
from vedette.domains.tracking.sensors import BearingOnly, Position, RangeBearing, RangeOnly
from vedette.errors import InputError
from vedette.vehicle import drive

OBJECTIVE = TrackingObjective()
seeds = st.integers(0, 2**32 - 1)
Float = NDArray[np.float64]


@pytest.mark.parametrize("horizon", [1, 2, 5, 6, 8, 15])
def test_courses_are_all_sequences_or_blocks_of_them(horizon: int) -> None:
    rates = sequences(0.5, horizon)
    assert rates.shape == (3 ** min(horizon, 5), horizon)
    assert len(np.unique(rates, axis=0)) == len(rates)
    assert not rates[0].any()  # straight ahead comes first
    assert (np.abs(rates) <= 0.5).all()


def test_what_cannot_turn_has_one_course() -> None:
    np.testing.assert_array_equal(sequences(0.0, 4), np.zeros((1, 4)))


def test_a_course_goes_on_at_later_steps_and_then_straight() -> None:
    course = Course(3, (0.1, 0.2, 0.3))
    assert course.from_step(3, 3) == course
    assert course.from_step(4, 3) == Course(4, (0.2, 0.3, 0.0))
    assert course.from_step(9, 2) == Course(9, (0.0, 0.0))


@settings(deadline=None, max_examples=25)
@given(seeds, st.booleans())
def test_a_reply_is_the_best_of_all_candidates_or_keeps_the_present_course(
    seed: int, continuous: bool
) -> None:
    rng = np.random.default_rng(seed)
    belief = random_tracks(rng)
    platform = random_platform(rng, belief, continuous=continuous)
    others = random_impact(rng, belief)
    current = Course(belief.k0, tuple(rng.uniform(-1, 1, belief.horizon) * platform.turn_rate))
    platform.place(*platform.pose, present=current)  # as in a mission, where it is among the candidates
    platform.prepare(belief)

    def value(course: Course) -> float:
        return OBJECTIVE.value(belief, OBJECTIVE.combine(others, platform.impact(belief, course)))

    reply = platform.reply(belief, others, current)
    best = max(value(course) for course in platform.courses)
    base = OBJECTIVE.value(belief, others)
    if max(best, value(current)) > base + 1e-6:
        assert value(reply) >= max(best, value(current)) - 1e-8 * max(1.0, abs(base))
    assert platform.reply(belief, others, reply) == reply or continuous  # who has replied is content
    assert value(reply) - base <= platform.slack(belief, others) + 1e-9
    assert all(abs(rate) <= platform.turn_rate + 1e-12 for rate in reply.rates)


@settings(deadline=None, max_examples=20)
@given(seeds)
def test_candidates_are_the_impacts_of_the_courses_one_by_one(seed: int) -> None:
    rng = np.random.default_rng(seed)
    belief = random_tracks(rng, targets=5)
    platform = random_platform(rng, belief)
    assert platform.candidates is not None
    assert len(platform.candidates) == len(platform.courses) >= 27
    for course, impact in list(zip(platform.courses, platform.candidates, strict=True))[::5]:
        poses = drive(platform.pose, course.rates, platform.speed, belief.dt)
        means = belief.predicted_means[..., :2].swapaxes(0, 1)
        spreads = belief.predicted_covariances[..., :2, :2].swapaxes(0, 1)
        dense = platform.sensor.foresee(poses[None], means, spreads, platform.speed * belief.dt)[0]
        seen = dense.any(axis=(1, 2))
        np.testing.assert_array_equal(impact.targets, np.flatnonzero(seen))
        np.testing.assert_allclose(impact.blocks, dense[seen], rtol=1e-12, atol=1e-15)


def test_the_present_course_is_among_the_candidates() -> None:
    rng = np.random.default_rng(0)
    belief = random_tracks(rng)
    platform = random_platform(rng, belief)
    platform.place(*platform.pose, present=Course(belief.k0 - 1, (0.1, 0.05, -0.02)))
    platform.prepare(belief)
    assert Course(belief.k0, (0.05, -0.02, 0.0)) in platform.courses
    assert platform.carry_over(belief, platform.present) == Course(belief.k0, (0.05, -0.02, 0.0))
    assert platform.carry_over(belief, None) == platform.courses[0]


@pytest.mark.parametrize("name", sorted(OBJECTIVES))
def test_token_negotiation_is_near_the_optimum_of_all_joint_courses(name: str) -> None:
    ratios = []
    for seed in range(20):
        rng = np.random.default_rng(seed)
        belief = random_tracks(rng, targets=4, horizon=2)
        teams = [random_platform(rng, belief).candidates for _ in range(3)]
        candidates = [team for team in teams if team is not None]
        found = negotiate(
            OBJECTIVES[name](),
            belief,
            candidates,
            Tree.chain(3),
            codec=TrackImpactCodec(len(belief), belief.horizon),
        )
        best = exhaustive(OBJECTIVES[name](), belief, candidates)
        ratios.append(found.value / best.value if best.value else 1.0)
        assert found.converged
        if OBJECTIVES[name].submodular:
            assert found.bound is not None
            assert best.value <= found.bound + 1e-9
            assert ratios[-1] >= 0.5
        else:
            assert found.bound is None
    assert np.mean(ratios) > 0.95


@settings(deadline=None, max_examples=15)
@given(seeds)
def test_messages_clipped_to_what_their_receivers_can_reach_change_no_choice(seed: int) -> None:
    rng = np.random.default_rng(seed)
    belief = random_tracks(rng, targets=8, horizon=2)
    team = [random_platform(rng, belief) for _ in range(5)]
    candidates = [platform.candidates for platform in team if platform.candidates is not None]
    tree, codec = Tree.random(5, seed=seed % 1000), TrackImpactCodec(len(belief), belief.horizon)
    full = negotiate(OBJECTIVE, belief, candidates, tree, codec=codec)
    reach = [platform.reach(belief) for platform in team]
    clipped = negotiate(OBJECTIVE, belief, candidates, tree, codec=codec, reach=reach)
    for i, k in enumerate(clipped.choice):  # another course only if it is worth the same to the last digits
        swapped = [*full.choice[:i], k, *full.choice[i + 1 :]]
        team_impact = reduce(OBJECTIVE.combine, (own[c] for own, c in zip(candidates, swapped, strict=True)))
        assert OBJECTIVE.value(belief, team_impact) == pytest.approx(full.value, rel=1e-9, abs=1e-9)
    assert clipped.value == pytest.approx(full.value, rel=1e-9, abs=1e-9)
    assert clipped.bound == pytest.approx(full.bound, rel=1e-9, abs=1e-9)


def test_the_papers_sweep_with_the_inverse_agrees_with_the_one_without() -> None:
    rng = np.random.default_rng(4)
    belief = random_tracks(rng, targets=4)
    teams = [random_platform(rng, belief).candidates for _ in range(4)]
    candidates = [team for team in teams if team is not None]
    one, other = (
        negotiate(OBJECTIVE, belief, candidates, Tree.chain(4), "jacobi", inverse=inverse)
        for inverse in (True, False)
    )
    assert one.choice == other.choice
    assert one.value == pytest.approx(other.value, rel=1e-9)


RATES = np.array([0.3, -0.2, 0.0, 0.5, 0.1])  # one at the straight limit


def slopes(objective: TrackingObjective, sensor: Sensor) -> tuple[Float, Callable[[Float], float]]:
    """The gradient by turn rates at RATES, and the value that it is the gradient of."""
    rng = np.random.default_rng(3)
    belief = random_tracks(rng, targets=3, horizon=5)
    platform = TrackingPlatform(4.0, 0.6, sensor, objective)
    platform.place(10.0, 20.0, 0.4)
    platform.prepare(belief)
    others = random_impact(rng, belief)

    def value(turns: Float) -> float:
        own = platform.impact(belief, Course(belief.k0, tuple(turns)))
        return objective.value(belief, objective.combine(others, own))

    poses = drive(platform.pose, RATES, 4.0, belief.dt)
    points = belief.predicted_means[..., :2].swapaxes(0, 1)
    team = objective.combine(others, platform.impact(belief, Course(belief.k0, tuple(RATES))))
    spreads = belief.predicted_covariances[..., :2, :2].swapaxes(0, 1)
    by_pose = sensor.foreseen_slope(poses, points, spreads, objective.gradient(belief, team), 4.0).sum(axis=0)
    return turn_rate_gradient(platform.pose, RATES, 4.0, belief.dt, by_pose), value


@pytest.mark.parametrize("name", sorted(OBJECTIVES))
@pytest.mark.parametrize("kind", [BearingOnly, RangeOnly, RangeBearing])
def test_the_gradient_by_turn_rates_agrees_with_central_differences(name: str, kind: type[Sensor]) -> None:
    found, value = slopes(OBJECTIVES[name](), kind(range=1e3, detection=0.9))
    steps = 1e-5 * np.eye(5)
    differences = np.array([(value(RATES + step) - value(RATES - step)) / 2e-5 for step in steps])
    assert np.abs(differences).min() > 1e-3
    np.testing.assert_allclose(found, differences, rtol=1e-5, atol=1e-6)


@pytest.mark.parametrize("name", sorted(OBJECTIVES))
def test_who_measures_places_gains_nothing_by_turning_while_all_targets_are_in_view(name: str) -> None:
    found, value = slopes(OBJECTIVES[name](), Position(range=1e3, detection=0.9))
    np.testing.assert_allclose(found, np.zeros(5), atol=1e-6)  # a thousandth of the least slope above
    assert value(RATES + 0.1) == pytest.approx(value(RATES), rel=1e-12, abs=0.0)


def test_the_ascent_finds_the_top_of_a_hill_and_stays_in_its_limits() -> None:
    top = np.array([0.3, -2.0])

    def hill(points: np.ndarray) -> np.ndarray:
        return np.asarray(-((points - top) ** 2).sum(axis=-1))

    point, value = ascend(hill, lambda p: -2.0 * (p - top), np.array([-0.5, 0.5]), limit=1.0)
    np.testing.assert_allclose(point, [0.3, -1.0], atol=1e-3)
    assert value == pytest.approx(-1.0, abs=1e-6)
    assert ascend(hill, lambda p: np.zeros(2), point, 1.0)[1] == value  # no slope, no step


def test_continuous_controls_are_never_worse_than_discrete_ones_and_mostly_better() -> None:
    better = 0
    for seed in range(12):
        rng = np.random.default_rng(seed)
        belief = random_tracks(rng, targets=4)
        platform = random_platform(rng, belief)
        others, straight = random_impact(rng, belief), platform.courses[0]
        values = []
        for platform.continuous in (False, True):
            reply = platform.reply(belief, others, straight)
            values.append(OBJECTIVE.value(belief, OBJECTIVE.combine(others, platform.impact(belief, reply))))
        assert values[1] >= values[0]
        better += values[1] > values[0] + 1e-3
    assert better >= 4


def test_while_nothing_is_in_reach_a_vehicle_heads_for_what_is_worth_most_and_arrives() -> None:
    models = [static(1.0), static(1.0)]
    covariances = [np.diag([0.01, 0.01]), np.diag([25.0, 25.0])]  # the first is known already
    belief = tracks(models, [[-300.0, 0.0], [0.0, -300.0]], covariances, dt=1.0, horizon=4)
    platform = TrackingPlatform(5.0, 0.4, RangeBearing(range=40.0, view=120.0))
    pose, course, seen = np.array([0.0, 0.0, 0.0]), None, 0
    for step in range(80):
        platform.place(*pose, present=course)
        now = replace(belief, k0=step)
        platform.prepare(now)
        nobody = OBJECTIVE.nothing(now)
        course = platform.reply(now, nobody, platform.carry_over(now, course))
        seen = len(platform.impact(now, course).targets)
        if seen:
            break
        pose = drive(pose, course.rates, 5.0, 1.0)[0]
    assert seen
    assert math.dist(pose[:2], (0.0, -300.0)) < 62.0
    assert step < 60  # (300 - 40) m at 5 m/s, and a turn


def test_what_others_see_already_attracts_nobody() -> None:
    belief = tracks(
        [static(1.0)] * 2, [[-300.0, 0.0], [0.0, -290.0]], [np.diag([25.0, 25.0])] * 2, dt=1.0, horizon=4
    )
    platform = TrackingPlatform(5.0, 0.4, Position(range=40.0, noise=1.0))
    platform.place(0.0, 0.0, -3 * np.pi / 4)  # looks between them
    platform.prepare(belief)
    mate = TrackingPlatform(5.0, 0.4, Position(range=40.0, noise=0.01))
    mate.place(0.0, -290.0, 0.0)
    mate.prepare(belief)
    straight = platform.courses[0]
    nobody, claimed = OBJECTIVE.nothing(belief), mate.impact(belief, straight)
    ends = [
        drive(platform.pose, platform.reply(belief, others, straight).rates, 5.0, 1.0)[-1]
        for others in (nobody, claimed)
    ]
    assert ends[0][1] < ends[0][0]  # towards the nearer one
    assert ends[1][0] < ends[1][1]  # towards the other


def test_a_pivot_that_looks_one_way_turns_to_the_target_behind_it() -> None:
    belief = tracks([constant_velocity(1.0, 0.01)], [[-20, 0, 0, 0]], [np.eye(4)], dt=1.0, horizon=2)
    platform = TrackingPlatform(0.0, math.radians(20.0), RangeBearing(range=30.0, view=30.0))
    heading, course = 0.1, None
    for step in range(12):
        platform.place(0.0, 0.0, heading, course)
        now = replace(belief, k0=step)
        platform.prepare(now)
        course = platform.reply(now, OBJECTIVE.nothing(now), platform.carry_over(now, course))
        heading += course.rates[0]
    assert len(platform.impact(now, course).targets) == 1
    assert platform.sensor.sees((0.0, 0.0, heading), (-20.0, 0.0))


def test_where_no_target_can_ever_be_reached_the_course_is_kept() -> None:
    belief = tracks([static(1.0)], [[500.0, 0.0]], [np.eye(2)], dt=1.0, horizon=2)
    pivot = TrackingPlatform(0.0, 0.5, Position(range=10.0))
    pivot.prepare(belief)
    present = Course(0, (0.5, 0.0))
    assert pivot.reply(belief, OBJECTIVE.nothing(belief), present) == present


def test_only_an_objective_with_a_bound_has_a_finite_slack() -> None:
    belief = random_tracks(np.random.default_rng(0))
    for objective in (OBJECTIVE, FinalEntropy()):
        platform = TrackingPlatform(5.0, 0.5, Position(range=SIDE), objective)
        platform.prepare(belief)
        slack = platform.slack(belief, objective.nothing(belief))
        assert math.isfinite(slack) == objective.submodular


@pytest.mark.parametrize("seed", range(4))
def test_the_slack_of_courses_to_choose_from_is_what_the_best_of_them_adds(seed: int) -> None:
    rng = np.random.default_rng(seed)
    belief = random_tracks(rng, targets=4)
    platform = random_platform(rng, belief, continuous=False)
    team = random_impact(rng, belief)
    values = [
        OBJECTIVE.value(belief, OBJECTIVE.combine(team, platform.impact(belief, course)))
        for course in platform.courses
    ]
    most = max(0.0, max(values) - OBJECTIVE.value(belief, team))
    assert platform.slack(belief, team) == pytest.approx(most, rel=1e-9, abs=1e-12)


def test_a_target_on_the_rim_of_the_range_counts_in_what_a_reply_can_add_at_most() -> None:
    belief = tracks([static(1.0, 0.0)], [[50.0, 0.0]], [np.eye(2)], dt=1.0, horizon=2)
    platform = TrackingPlatform(0.0, 0.5, Position(range=50.0), continuous=True)
    platform.place(0.0, 0.0, 0.0)
    platform.prepare(belief)
    nobody = OBJECTIVE.nothing(belief)
    reply = platform.reply(belief, nobody, platform.carry_over(belief, None))
    gain = OBJECTIVE.value(belief, platform.impact(belief, reply))
    assert 0.0 < gain <= platform.slack(belief, nobody)


def test_the_teams_continuous_replies_stay_below_the_bound_that_slack_gives() -> None:
    rng = np.random.default_rng(1)
    belief = random_tracks(rng, targets=4)
    team = [random_platform(rng, belief, continuous=True) for _ in range(3)]
    courses = [platform.courses[0] for platform in team]
    nobody = OBJECTIVE.nothing(belief)
    for _ in range(3):
        for i, platform in enumerate(team):
            mates = [
                p.impact(belief, c) for k, (p, c) in enumerate(zip(team, courses, strict=True)) if k != i
            ]
            courses[i] = platform.reply(
                belief, functools.reduce(OBJECTIVE.combine, mates, nobody), courses[i]
            )
    total = functools.reduce(
        OBJECTIVE.combine, (p.impact(belief, c) for p, c in zip(team, courses, strict=True))
    )
    value = OBJECTIVE.value(belief, total)
    assert value <= sum(platform.slack(belief, nobody) for platform in team)


def test_speeds_that_are_none_are_refused() -> None:
    with pytest.raises(InputError, match="speed must be >= 0 m/s; got -1"):
        TrackingPlatform(-1.0, 0.5, Position())
    with pytest.raises(InputError, match="turn_rate must be >= 0 rad/s; got nan"):
        TrackingPlatform(1.0, math.nan, Position())


def test_gains_are_compared_relative_to_what_they_are_gains_of() -> None:
    """A poor sensor far from a target known to a millimetre gains some 1e-11 nat, and still chooses."""
    belief = tracks([static(1.0)], [[0.0, 60.0]], [1e-6 * np.eye(2)], dt=1.0, horizon=2)
    platform = TrackingPlatform(5.0, 0.4, BearingOnly(range=100.0, bearing_noise=90.0))
    platform.prepare(belief)
    nobody = OBJECTIVE.nothing(belief)
    values = OBJECTIVE.values(belief, nobody, platform.candidates or [])
    assert 0.0 < values.max() < 1e-9
    reply = platform.reply(belief, nobody, Course(0, (-0.4, -0.4)))
    assert reply == platform.courses[int(np.argmax(values))]
    assert OBJECTIVE.value(belief, platform.impact(belief, reply)) > values.min()

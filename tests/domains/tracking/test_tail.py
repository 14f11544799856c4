"""The tail after the horizon: its targets, its worth, and where it sends vehicles."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.support.tracking_scenes import random_impact, random_platform, random_tracks
from vedette.domains.tracking.attending import Attending
from vedette.domains.tracking.belief import Tracks, tracks
from vedette.domains.tracking.filter import predict
from vedette.domains.tracking.impact import Impact, nothing
from vedette.domains.tracking.models import constant_velocity, static
from vedette.domains.tracking.objective import TrackingObjective
from vedette.domains.tracking.platform import TrackingPlatform
from vedette.domains.tracking.sensors import Position, RangeBearing
from vedette.domains.tracking.tail import edges
from vedette.testing import check_objective
from vedette.vehicle import drive

OBJECTIVE = TrackingObjective()
LAYERS = 4.0, 10.0, 30.0
seeds = st.integers(0, 2**32 - 1)


def with_tail(rng: np.random.Generator) -> Tracks:
    return replace(random_tracks(rng), layers=LAYERS)


def some_impact(rng: np.random.Generator, belief: Tracks) -> Impact:
    near, after = random_impact(rng, belief), random_impact(rng, belief)
    blocks = np.zeros((len(belief), belief.blocks, 3))
    blocks[near.targets, : belief.horizon] = near.blocks
    blocks[after.targets, belief.horizon :] = after.blocks
    seen = np.flatnonzero(blocks.any(axis=(1, 2)))
    return Impact(seen, blocks[seen])


def test_layers_grow_to_the_end_of_the_tail_and_there_are_none_in_a_short_one() -> None:
    assert edges(0.0) == edges(10.0) == ()
    ends = edges(1500.0)
    assert ends[-1] == 1500.0
    assert len(ends) == 11
    assert all(later > sooner for sooner, later in pairwise(ends))


@settings(deadline=None, max_examples=20)
@given(seeds)
def test_targets_in_the_tail_are_those_of_the_filter_without_measurements(seed: int) -> None:
    belief = with_tail(np.random.default_rng(seed))
    for b, middle in enumerate((2, 7, 20)):
        then = predict(belief, belief.horizon + middle)
        np.testing.assert_allclose(belief.tail.means[b], then.means, rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(
            belief.tail.covariances[b], then.covariances[:, :2, :2], rtol=1e-6, atol=1e-9
        )


@settings(deadline=None, max_examples=20)
@given(seeds)
def test_the_tail_adds_the_entropy_that_looks_take_off_each_layer_in_steps(seed: int) -> None:
    rng = np.random.default_rng(seed)
    belief = with_tail(rng)
    impact = some_impact(rng, belief)
    bare = replace(belief, layers=())
    near = Impact(impact.targets, impact.blocks[:, : belief.horizon])
    expected = OBJECTIVE.value(bare, near)
    for target, blocks in zip(impact.targets, impact.blocks[:, belief.horizon :], strict=True):
        for b, (xx, xy, yy) in enumerate(blocks):
            p = belief.tail.covariances[b, target]
            expected += (4.0, 6.0, 20.0)[b] * 0.5 * np.linalg.slogdet(np.eye(2) + p @ [[xx, xy], [xy, yy]])[1]
    np.testing.assert_allclose(OBJECTIVE.value(belief, impact), expected, rtol=1e-9)
    own = [nothing(belief.blocks), some_impact(rng, belief)]
    values = OBJECTIVE.values(belief, impact, own)
    each = [OBJECTIVE.value(belief, OBJECTIVE.combine(impact, one)) for one in own]
    np.testing.assert_allclose(values, each, rtol=1e-9)


def test_with_a_tail_the_objective_keeps_its_laws_monotone_and_submodular() -> None:
    for seed in range(5):
        rng = np.random.default_rng(seed)
        belief = with_tail(rng)
        check_objective(OBJECTIVE, belief, [some_impact(rng, belief) for _ in range(4)])


def test_a_look_that_finds_its_target_half_the_time_is_worth_half_as_much() -> None:
    belief = with_tail(np.random.default_rng(1))
    belief = replace(belief, Y=np.tile(np.eye(4), (len(belief), 1, 1)))  # as wide in x as in y
    attending = Attending(Position(range=50.0), 5.0, 0.5)
    every = np.arange(len(belief))
    sure, half = (
        belief.tail.worth(every, attending.looks(belief.tail, p * np.ones(len(every)))) for p in (1.0, 0.5)
    )
    np.testing.assert_allclose(half, 0.5 * sure, rtol=1e-6)


def test_a_look_in_the_tail_says_as_much_in_all_directions() -> None:
    belief = with_tail(np.random.default_rng(1))
    looks = Attending(Position(range=50.0, noise=2.0, detection=1.0), 5.0, 0.5).looks(belief.tail)
    np.testing.assert_allclose(looks, np.broadcast_to([0.25, 0.0, 0.25], looks.shape), rtol=1e-9)


def test_who_goes_to_a_target_finds_what_is_within_its_range_when_it_arrives() -> None:
    spread = np.diag([400.0, 400.0, 4.0, 4.0])
    models, layers = [constant_velocity(1.0, 1.0)], (10.0, 26.0, 68.0)
    belief = tracks(models, [[180.0, 0.0, 0.0, 0.0]], [spread], dt=1.0, horizon=2, layers=layers)
    tail, sensor = belief.tail, Position(range=40.0, noise=5.0, detection=1.0)
    told = Attending(sensor, 10.0, 0.5).blocks(tail, np.zeros((1, 3)), 0)[0, 0, :, 0]
    assert told[0] == 0.0 < told[1]  # it arrives in the second layer
    share = np.log1p(told * tail.spreads[:, 0]) / np.log1p(tail.spreads[:, 0] / 25.0)
    assert share[2] == pytest.approx(1.0 - np.exp(-(40.0**2) / (2.0 * tail.spreads[1, 0])))


def test_who_stays_in_its_place_sees_beside_a_target_what_is_in_its_view_when_it_faces_it() -> None:
    places = [[30.0, 0.0], [28.0, 4.0], [0.0, 30.0], [200.0, 0.0]]
    belief = tracks([static(1.0, 0.0)] * 4, places, [np.eye(2)] * 4, dt=1.0, horizon=2, layers=(10.0, 30.0))
    turret = Attending(RangeBearing(range=60.0, view=60.0), 0.0, 1.0)
    poses = np.array([[0.0, 0.0, 0.0]])
    seen = [turret.blocks(belief.tail, poses, target)[0, :, -1, 0] > 0.0 for target in range(4)]
    assert np.array(seen).tolist() == [
        [True, True, False, False],
        [True, True, False, False],
        [False, False, True, False],
        [False, False, False, False],  # out of its range
    ]


@settings(deadline=None, max_examples=15)
@given(seeds, st.booleans())
def test_replies_with_a_tail_stay_below_the_slack_that_is_promised(seed: int, continuous: bool) -> None:
    rng = np.random.default_rng(seed)
    belief = with_tail(rng)
    platform = random_platform(rng, belief, continuous=continuous)
    others, present = some_impact(rng, belief), platform.carry_over(belief, None)
    reply = platform.reply(belief, others, present)
    value = OBJECTIVE.value(belief, OBJECTIVE.combine(others, platform.impact(belief, reply)))
    assert value - OBJECTIVE.value(belief, others) <= platform.slack(belief, others) * (1 + 1e-9) + 1e-9
    assert (
        value >= OBJECTIVE.value(belief, OBJECTIVE.combine(others, platform.impact(belief, present))) - 1e-9
    )


def test_a_vehicle_leaves_a_target_that_it_knows_for_one_far_away_that_it_does_not_and_gets_there() -> None:
    """Without a tail it would stay: within the horizon there is nothing else to see."""
    models = [static(1.0, 0.01), static(1.0, 0.01)]
    now = tracks(
        models,
        [[0.0, 0.0], [900.0, 0.0]],
        [np.eye(2), 900 * np.eye(2)],
        dt=1.0,
        horizon=4,
        layers=edges(600.0),
    )
    platform = TrackingPlatform(20.0, 0.4, Position(range=100.0), decisions=2)
    pose, course = np.array([-20.0, 10.0, 2.0]), None
    for step in range(60):
        platform.place(*pose, present=course)
        belief = replace(now, k0=step)
        platform.prepare(belief)
        course = platform.reply(belief, OBJECTIVE.nothing(belief), platform.carry_over(belief, course))
        assert course.target == 1
        pose = drive(pose, course.rates, 20.0, 1.0)[0]
    assert np.hypot(*(pose[:2] - (900.0, 0.0))) < 100.0


def test_what_a_mate_attends_in_the_tail_attracts_nobody_else() -> None:
    models = [constant_velocity(1.0, 0.01)] * 2
    means, wide = [[500.0, 300.0, 0, 0], [500.0, -280.0, 0, 0]], np.diag([400.0, 400.0, 0.1, 0.1])
    belief = tracks(models, means, [wide] * 2, dt=1.0, horizon=4, layers=edges(600.0))
    platform = TrackingPlatform(20.0, 0.4, Position(range=100.0), decisions=2)
    platform.prepare(belief)
    present = platform.carry_over(belief, None)
    alone = platform.reply(belief, OBJECTIVE.nothing(belief), present)
    mate = platform.impact(belief, alone)
    assert platform.reply(belief, mate, present).target != alone.target

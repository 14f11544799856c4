"""Odometry that drifts, and the simulated SLAM that puts it right: the model, the graph, loops, missions."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import least_squares

from bench.margins import measure
from tests.support.small_missions import robots, run, small_maze, small_office
from vedette.agent.events import Scan
from vedette.errors import InputError
from vedette.kernels.lidar import cast_rays
from vedette.maps import FREE, OCCUPIED, UNKNOWN, GridFrame
from vedette.maps.world import World
from vedette.missions.explore.own_map import OwnMap
from vedette.sim.odometry import Odometry, laid_at, seen_from
from vedette.sim.pose_graph import PoseGraph
from vedette.sim.slam import LOOP, Slam
from vedette.team import PlatformSpec

Floats = NDArray[np.float64]


# -- odometry -------------------------------------------------------------------------------------------


def test_a_place_seen_from_a_frame_and_laid_there_again_is_itself() -> None:
    frames, places = np.random.default_rng(0).uniform(-3.0, 3.0, (2, 50, 3))
    there = laid_at(frames, seen_from(frames, places))
    np.testing.assert_allclose(there[:, :2], places[:, :2])
    np.testing.assert_allclose(np.cos(there[:, 2] - places[:, 2]), 1.0)
    ahead = seen_from(np.array((1.0, 1.0, math.pi / 2)), np.array((1.0, 3.0, math.pi)))
    np.testing.assert_allclose(ahead, (2.0, 0.0, math.pi / 2), atol=1e-12)


def test_without_drift_what_is_counted_is_the_way_that_was_driven() -> None:
    wheels = Odometry(0.0, np.random.default_rng(0))
    places = np.cumsum(np.random.default_rng(1).uniform(-0.3, 0.3, (40, 3)), axis=0)
    for before, after in pairwise(places):
        wheels.count(before, after)
    np.testing.assert_allclose(laid_at(places[0], wheels.counted), places[-1], atol=1e-12)


@pytest.mark.parametrize("ticks", [1, 8])
def test_what_wheels_count_errs_as_the_model_says_whatever_the_ticks(ticks: int) -> None:
    drift, straight, turned = 0.01, [], []
    for seed in range(1500):
        driving, turning = (Odometry(drift, np.random.default_rng([seed, k])) for k in range(2))
        for before, after in pairwise(np.linspace(0.0, 1.0, ticks + 1)):
            driving.count(np.array((4.0 * before, 0.0, 0.0)), np.array((4.0 * after, 0.0, 0.0)))
            turning.count(np.array((0.0, 0.0, 2.0 * before)), np.array((0.0, 0.0, 2.0 * after)))
        straight.append(driving.counted - (4.0, 0.0, 0.0))
        turned.append(turning.counted - (0.0, 0.0, 2.0))
    ahead, _, heading = np.std(straight, axis=0)
    assert (ahead, heading) == (pytest.approx(0.02, rel=0.08), pytest.approx(0.02, rel=0.08))
    np.testing.assert_allclose(np.std(turned, axis=0)[2], drift * math.sqrt(2.0), rtol=0.08)
    assert np.abs(np.array(turned)[:, :2]).max() == 0.0


# -- the graph ------------------------------------------------------------------------------------------


def ring(count: int) -> Floats:
    """Places round a ring of 3 m about (5, 5), heading along it; the last is the first again."""
    turn = np.linspace(0.0, 2.0 * math.pi, count)
    return np.column_stack((5.0 + 3.0 * np.cos(turn), 5.0 + 3.0 * np.sin(turn), turn + math.pi / 2))


def test_a_graph_puts_places_where_a_general_solver_does() -> None:
    rng, truth = np.random.default_rng(3), ring(12)
    graph, ties = PoseGraph(truth[:1].copy()), []
    for k in range(1, 12):
        deviation = np.array((0.05, 0.05, 0.03)) * rng.uniform(0.5, 2.0)
        measured = seen_from(truth[k - 1], truth[k]) + deviation * rng.standard_normal(3)
        graph.add(measured, deviation)
        ties.append((k - 1, k, measured, deviation))
    for first, second in ((0, 11), (2, 9)):
        close = seen_from(truth[first], truth[second]), np.full(3, 0.02)
        graph.tie(first, second, *close)
        ties.append((first, second, *close))

    def residuals(flat: Floats) -> Floats:
        places = np.vstack((truth[0], flat.reshape(-1, 3)))
        gaps = [(seen_from(places[i], places[j]) - z) / s for i, j, z, s in ties]
        for gap, (*_, s) in zip(gaps, ties, strict=True):
            gap[2] = math.remainder(gap[2] * s[2], math.tau) / s[2]
        return np.concatenate(gaps)

    expected = least_squares(residuals, graph.places[1:].ravel(), xtol=1e-14).x.reshape(-1, 3)
    before = np.abs(graph.places[1:] - expected).max()
    graph.solve()
    np.testing.assert_allclose(graph.places[1:], expected, atol=1e-3)
    assert before > 0.05


# -- the SLAM -------------------------------------------------------------------------------------------


def block_in_a_hall() -> World:
    """Ten metres square, with a block of four in its middle."""
    solid = np.pad(np.zeros((98, 98), np.bool_), 1, constant_values=True)
    solid[30:70, 30:70] = True
    return World(GridFrame(0.1, *solid.shape), solid, "hall")


def driven(drift: float, seed: int, rounds: float) -> Iterator[tuple[Slam, Floats, OwnMap | None]]:
    """Drive round the block, ticks of 0.1 s, and yield the SLAM, where the robot truly is, and new maps."""
    world, spec = block_in_a_hall(), PlatformSpec(drift=drift)
    count = round(rounds * 480)
    turn = np.arange(count) * math.tau / 480
    around = np.maximum(np.abs(np.cos(turn)), np.abs(np.sin(turn)))
    x, y = 5.0 + 3.2 * np.cos(turn) / around, 5.0 + 3.2 * np.sin(turn) / around
    places = np.column_stack((x, y, np.unwrap(np.arctan2(np.gradient(y), np.gradient(x)))))
    slam = Slam(world.frame, spec, places[0], np.random.default_rng(seed))
    beams = np.radians(np.arange(360.0))
    for k, place in enumerate(places):
        slam.advance(place)
        heading = float(slam.place[2])
        ranges = cast_rays(
            world.solid, 0.1, place[0], place[1], place[2] + beams, spec.range, np.empty((0, 3))
        )
        yield slam, place, slam.look(Scan(heading + beams, ranges), 0.1 * k, arrived=False)


def error(slam: Slam, place: Floats) -> float:
    return float(np.hypot(*(slam.place - place)[:2]))


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_closing_a_loop_puts_the_past_right(seed: int) -> None:
    worst, own_map = 0.0, None
    after: list[float] = []
    for slam, place, own in driven(0.02, seed, 1.3):
        own_map = own or own_map
        if slam.closures == 0:
            worst = max(worst, error(slam, place))
        elif len(after) < 20:
            after.append(error(slam, place))
    assert len(after) == 20
    assert after[0] < 0.15  # matching errs by 2 cm, and half a degree over some metres
    assert worst > 3.0 * after[0]
    assert own_map is not None
    world = block_in_a_hall()
    classes = own_map.laid(world.frame)
    assert np.count_nonzero((classes == FREE) & world.solid) < 0.05 * np.count_nonzero(classes != UNKNOWN)


def test_without_noise_of_the_wheels_the_map_is_the_building() -> None:
    own_map = next(own for *_, own in driven(1e-9, 0, 1.0) if own is not None)
    for _, _, own in driven(1e-9, 0, 1.0):
        own_map = own or own_map
    world = block_in_a_hall()
    classes = own_map.laid(world.frame)
    assert not (world.solid & (classes == FREE)).any()
    assert not (~world.solid & (classes == OCCUPIED)).any()
    assert np.count_nonzero(classes != UNKNOWN) > 6000


# -- missions -------------------------------------------------------------------------------------------


def test_a_team_that_drifts_completes_its_mission_and_the_same_seed_gives_the_same() -> None:
    once, again = (run(small_maze(), robots(2, drift=0.003))[1] for _ in range(2))
    summary = once.summary
    assert summary.outcome.value == "complete"
    assert summary.collisions == 0
    assert summary.map_error_share < 0.03
    errors = summary.pose_error_m
    assert errors is not None
    assert all(0.0 < error < 0.5 for error in errors.values())
    assert summary == again.summary
    np.testing.assert_array_equal(once.classes, again.classes)


def test_closures_halve_what_drift_makes_wrong_and_without_drift_nothing_is(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    exact = run(small_office(), robots(2))[1].summary
    assert (exact.map_errors, exact.pose_error_m) == (0, {"robot-1": 0.0, "robot-2": 0.0})
    wrong = []
    for loop in (LOOP, math.inf):
        monkeypatch.setattr("vedette.sim.slam.LOOP", loop)
        played = [run(small_office(), robots(2, drift=0.01), seed=seed)[1].summary for seed in (0, 1)]
        assert all(summary.collisions == 0 for summary in played)
        wrong.append(sum(summary.map_error_share for summary in played))
    assert 0.0 < wrong[0] < 0.5 * wrong[1]


def test_honest_robots_that_drift_are_not_expelled(tmp_path: Path) -> None:
    margin = measure(3, 0, tmp_path, drift=0.005)
    assert margin.worst.against > 0
    assert not margin.expelled


def test_drift_beside_another_error_of_the_pose_is_refused() -> None:
    with pytest.raises(InputError, match="drift makes the pose wrong already"):
        PlatformSpec(drift=0.01, pose_std=0.1)
    with pytest.raises(InputError, match="drift must be"):
        PlatformSpec(drift=0.2)

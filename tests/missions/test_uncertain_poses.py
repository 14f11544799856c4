"""Robots that are not quite where they take themselves to be: evidence, footprints, ways, missions."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy import ndimage

from tests.support.explorers import HERE, explorer, mate_at, scan_from
from tests.support.grids import on_dense
from tests.support.mapping_scenes import BEAMS, FRAME, building, explored, frozen
from tests.support.small_missions import robots, run, small_maze
from vedette.agent.events import Pose, Scan
from vedette.domains.mapping.blur import blurred, displacement
from vedette.domains.mapping.sightings import measured_model
from vedette.domains.mapping.stops import CLEARANCES, find_stops, survey
from vedette.domains.mapping.views import look
from vedette.kernels import lidar
from vedette.kernels.frontier import traversable
from vedette.kernels.reference import lidar as reference_lidar
from vedette.kernels.reference.coverage import dense
from vedette.maps import FREE, OCCUPIED, UNKNOWN
from vedette.sim.localisation import CORRELATION_TIME, Localisation
from vedette.team import PlatformSpec

seeds = st.integers(0, 2**32 - 1)
RESOLUTION = FRAME.resolution


# -- the error ------------------------------------------------------------------------------------------


def localised(seed: int) -> Localisation:
    spec = PlatformSpec(pose_std=0.15, pose_std_heading=2.0)
    found = Localisation.of(spec, np.random.default_rng(seed))
    assert found is not None
    return found


def test_the_error_has_its_deviation_at_all_times_and_fades_with_its_correlation_time() -> None:
    first, later = [], []
    for seed in range(3000):
        localiser = localised(seed)
        first.append(localiser.error)
        for _ in range(5):
            localiser.advance(CORRELATION_TIME / 5)
        later.append(localiser.error)
    deviation = (0.15, 0.15, math.radians(2.0))
    for errors in (first, later):
        np.testing.assert_allclose(np.std(errors, axis=0), deviation, rtol=0.05)
    correlation = np.mean(np.multiply(first, later), axis=0) / np.square(deviation)
    np.testing.assert_allclose(correlation, math.exp(-1.0), atol=0.06)


def test_a_localiser_takes_nothing_from_the_robots_own_stream_of_chance() -> None:
    stream, untouched = np.random.default_rng(5), np.random.default_rng(5)
    assert Localisation.of(PlatformSpec(), stream) is None
    localiser = Localisation.of(PlatformSpec(pose_std=0.1), stream)
    assert localiser is not None
    localiser.advance(0.1)
    assert stream.random() == untouched.random()


# -- evidence -------------------------------------------------------------------------------------------


def random_scan(seed: int) -> dict[str, Any]:
    rng = np.random.default_rng(seed)
    rows, cols = (int(n) for n in rng.integers(1, 25, 2))
    beams = int(rng.integers(0, 12))
    return {
        "rng": rng,
        "shape": (rows, cols),
        "place": (RESOLUTION, rng.uniform(0, cols * RESOLUTION), rng.uniform(0, rows * RESOLUTION)),
        "beams": (rng.uniform(-10, 10, beams), rng.uniform(0, 2.5, beams), rng.random(beams) < 0.6),
        "margins": rng.choice([0.0, 0.03, 0.15, 0.4]) * rng.uniform(0.5, 1.0, beams),
    }


@settings(deadline=None, max_examples=120)
@given(seeds)
def test_a_blurred_scan_equals_its_twin(seed: int) -> None:
    scan = random_scan(seed)
    log_odds = scan["rng"].integers(-9, 10, scan["shape"]).astype(np.int8)
    twin = log_odds.copy()
    arguments: tuple[Any, ...] = (*scan["place"], *scan["beams"], scan["margins"], 5, 3, 9, 0.04)
    changed = on_dense(lidar.integrate_blurred_scan, log_odds, *arguments)
    np.testing.assert_array_equal(changed, reference_lidar.integrate_blurred_scan(twin, *arguments))
    np.testing.assert_array_equal(log_odds, twin)


@settings(deadline=None, max_examples=60)
@given(seeds)
def test_without_margins_a_blurred_scan_is_a_sharp_one(seed: int) -> None:
    scan = random_scan(seed)
    blurry, sharp = np.zeros((2, *scan["shape"]), np.int8)
    beams, gains = (*scan["place"], *scan["beams"]), (4, 2, 20, 0.025)
    arguments: tuple[Any, ...] = (*beams, *gains)
    blurred_arguments: tuple[Any, ...] = (*beams, np.zeros(len(scan["margins"])), *gains)
    for _ in range(3):
        on_dense(lidar.integrate_blurred_scan, blurry, *blurred_arguments)
        on_dense(lidar.integrate_scan, sharp, *arguments)
    np.testing.assert_array_equal(blurry, sharp)


@settings(deadline=None, max_examples=60)
@given(seeds, st.sampled_from([0.05, 0.15, 0.3]))
def test_nothing_within_the_margin_of_a_return_becomes_free(seed: int, margin: float) -> None:
    scan = random_scan(seed)
    log_odds = np.zeros(scan["shape"], np.int8)
    (_, x, y), (angles, ranges, hits) = scan["place"], scan["beams"]
    margins, gains = np.full(len(angles), margin), (4, 2, 20, 0.0)
    arguments: tuple[Any, ...] = (*scan["place"], *scan["beams"], margins, *gains)
    on_dense(lidar.integrate_blurred_scan, log_odds, *arguments)
    rows, cols = (np.indices(scan["shape"]) + 0.5) * RESOLUTION
    sensor = (np.abs(cols - x) <= RESOLUTION / 2) & (np.abs(rows - y) <= RESOLUTION / 2)
    for angle, reach in zip(angles[hits], ranges[hits], strict=True):
        away = np.hypot(cols - x - reach * math.cos(angle), rows - y - reach * math.sin(angle))
        assert not ((log_odds < 0) & (away <= margin) & ~sensor).any()


@pytest.mark.parametrize("margin", [0.0, 0.05, 0.1, 0.15, 0.3])
def test_a_wall_gets_the_same_evidence_in_all_however_it_is_spread(margin: float) -> None:
    angles = np.radians(np.arange(-45.0, 45.0, 0.25))
    total, middle = [], []
    for wall in np.arange(4.0, 4.1, 0.01) + 0.003:
        log_odds = np.zeros((41, 61), np.int8)
        scan = (RESOLUTION, 1.0, 2.05, angles, (wall - 1.0) / np.cos(angles), np.ones(len(angles), bool))
        on_dense(lidar.integrate_blurred_scan, log_odds, *scan, np.full(len(angles), margin), 12, 2, 100, 0.0)
        across = np.maximum(log_odds[20], 0)
        total.append(across.sum())
        middle.append(np.average(np.arange(61) + 0.5, weights=across) * RESOLUTION - wall)
    assert np.mean(total) == pytest.approx(12.0, rel=0.07)
    assert np.mean(middle) == pytest.approx(0.0, abs=0.01)


def test_what_was_seen_is_never_unknown_again() -> None:
    log_odds = np.array([[-1, 2, 1]], np.int8)
    scan = (1.0, 0.5, 0.5, np.zeros(1), np.array([2.0]), np.array([True]), np.array([1e-9]))
    on_dense(lidar.integrate_blurred_scan, log_odds, *scan, 4, 2, 20, 0.0)
    assert log_odds.tolist() == [[-3, -1, 5]]


def test_margins_that_do_not_fit_are_refused() -> None:
    scan = (1.0, 0.5, 0.5, np.zeros(1), np.zeros(1), np.zeros(1, bool))
    for margins in (np.zeros(2), np.array([-0.1]), np.array([np.nan])):
        with pytest.raises(ValueError, match="margins must be as many as beams"):
            on_dense(lidar.integrate_blurred_scan, np.zeros((2, 2), np.int8), *scan, margins, 1, 1, 9, 0.0)


def drive_both_sides(std: float, blur: bool, seed: int) -> NDArray[np.int8]:
    """Return the map of a robot that drove the corridor, then through a room above it and one below."""
    rng = np.random.default_rng(seed)
    localiser = Localisation(np.array((std, std, 0.0)), rng)
    log_odds = np.zeros(FRAME.shape, np.int8)
    corridor = [(0.4 + 0.2 * step, 5.05) for step in range(65)]
    rooms = [(0.6 + 0.2 * step, y) for y in (7.0, 3.0) for step in range(18)]
    for x, y in corridor + rooms:
        localiser.advance(0.4)
        ranges = lidar.cast_rays(building(), RESOLUTION, x, y, BEAMS, 4.0, np.empty((0, 3)))
        hits = np.isfinite(ranges)
        told = x + localiser.error[0], y + localiser.error[1]
        beams = (log_odds, RESOLUTION, *told, BEAMS, np.minimum(ranges, 4.0), hits)
        if blur:
            on_dense(lidar.integrate_blurred_scan, *beams, np.full(len(BEAMS), std), 4, 2, 20, 0.025)
        else:
            on_dense(lidar.integrate_scan, *beams, 4, 2, 20, 0.025)
    return log_odds


def test_walls_stay_closed_and_doors_stay_open_at_fifteen_centimetres() -> None:
    wrong = {True: 0, False: 0}
    for seed in range(4):
        for blur in (True, False):
            log_odds = drive_both_sides(0.15, blur, seed)
            wrong[blur] += int(((log_odds < 0) & building()).sum())
            if not blur:
                continue
            classes = np.where(log_odds > 0, OCCUPIED, np.where(log_odds < 0, FREE, UNKNOWN))
            doors_shut = classes.astype(np.uint8)
            doors_shut[40:46, 14:35] = doors_shut[56:62, 14:35] = OCCUPIED
            for shut, ways in ((classes.astype(np.uint8), 1), (doors_shut, 3)):
                where, _ = ndimage.label(traversable(shut, 0.2, RESOLUTION))
                places = {int(where[cell]) for cell in ((50, 20), (70, 25), (30, 25))}
                assert 0 not in places
                assert len(places) == ways
    assert wrong[True] < 0.5 * wrong[False]


# -- ways and footprints ----------------------------------------------------------------------------------


def footprints(spec: PlatformSpec) -> tuple[Any, Any]:
    belief = frozen()
    ground = survey(belief, spec, -0.5, 7.1, [], CLEARANCES[0])
    model = measured_model(belief.counts, RESOLUTION, 40, by_distance=False)
    return belief, find_stops(belief, ground, spec, model, 0.08, look(belief, ground, spec))


def random_rows(
    rng: np.random.Generator, shape: tuple[int, int]
) -> tuple[Any, Any, Any, NDArray[np.float64]]:
    dense = np.where(rng.random((3, *shape)) < 0.5, rng.uniform(0.1, 1.0, (3, *shape)), 0.0)
    rows = [np.flatnonzero(row) for row in dense]
    starts = np.concatenate(([0], np.cumsum([len(row) for row in rows])))
    shares = np.concatenate([row.ravel()[at] for row, at in zip(dense, rows, strict=True)])
    return starts, np.concatenate(rows).astype(np.uint32), shares.astype(np.float32), dense


def dense_rows(rows: tuple[Any, Any, Any], shape: tuple[int, int]) -> NDArray[np.float64]:
    starts, cells, shares = rows
    out = np.zeros((len(starts) - 1, shape[0] * shape[1]))
    for k in range(len(out)):
        out[k, cells[starts[k] : starts[k + 1]]] = shares[starts[k] : starts[k + 1]]
        assert np.all(np.diff(cells[starts[k] : starts[k + 1]].astype(int)) > 0)
    return out.reshape(-1, *shape)


def test_without_deviation_nothing_changes() -> None:
    rows = random_rows(np.random.default_rng(0), (6, 8))[:3]
    assert blurred(rows, np.ones((6, 8), np.uint16), 0.0) is rows
    assert displacement(0.0).tolist() == [1.0]


@pytest.mark.parametrize("deviation", [0.1, 0.25, 0.75, 2.0])
def test_displacements_are_those_of_a_cells_content(deviation: float) -> None:
    rng = np.random.default_rng(0)
    lands = np.floor(rng.random(200_000) + deviation * rng.standard_normal(200_000)).astype(int)
    taps = displacement(deviation)
    reach = len(taps) // 2
    drawn = [np.mean(lands == j) for j in range(-reach, reach + 1)]
    assert taps.sum() == pytest.approx(1.0)
    np.testing.assert_allclose(taps, drawn, atol=0.005)


def test_a_blurred_footprint_is_the_mean_over_displaced_ones() -> None:
    rng, shape, deviation = np.random.default_rng(1), (14, 17), 0.75
    starts, cells, shares, dense = random_rows(rng, shape)
    unknown = rng.integers(0, 5, shape).astype(np.uint16)
    got = dense_rows(blurred((starts, cells, shares), unknown, deviation), shape)
    seen, present = np.zeros(dense.shape), np.zeros(shape)
    shifts = np.floor(rng.random((40_000, 2)) + deviation * rng.standard_normal((40_000, 2))).astype(int)
    for shift, times in zip(*np.unique(shifts, axis=0, return_counts=True), strict=True):
        present += times * ndimage.shift(unknown.astype(float), shift, order=0)
        for k in range(3):
            seen[k] += times * ndimage.shift(dense[k] * unknown, shift, order=0)
    expected = np.where(unknown > 0, seen / np.maximum(present, 1e-9), 0.0)
    clear = np.abs(expected - 1 / 16) > 0.02  # shares that round to nothing are left out
    np.testing.assert_allclose(got[clear], np.where(expected > 1 / 16, expected, 0.0)[clear], atol=0.02)


def test_where_all_is_unknown_blurring_conserves_what_is_seen() -> None:
    unknown = np.full((40, 40), 4, np.uint16)
    dense = np.zeros((40, 40))
    dense[15:25, 12:28] = 1.0
    cells = np.flatnonzero(dense)
    rows = (np.array([0, len(cells)]), cells.astype(np.uint32), np.ones(len(cells), np.float32))
    spread = dense_rows(blurred(rows, unknown, 0.75), (40, 40))[0]
    assert spread.sum() == pytest.approx(dense.sum(), rel=0.03)  # but for what rounds to nothing
    assert spread.max() <= 1.0
    np.testing.assert_allclose(spread[18:22, 16:24], 1.0, atol=1e-3)


def test_a_scrap_that_is_seen_whole_is_seen_whole_from_a_little_beside() -> None:
    unknown = np.zeros((9, 9), np.uint16)
    unknown[4, 4:6] = 3
    rows = (np.array([0, 2]), np.array([40, 41], np.uint32), np.ones(2, np.float32))
    got = blurred(rows, unknown, 0.75)
    np.testing.assert_array_equal(got[1], rows[1])
    np.testing.assert_allclose(got[2], 1.0)


def test_stops_reveal_less_at_their_edges_and_as_much_in_all_when_poses_are_uncertain() -> None:
    belief, sharp = footprints(PlatformSpec(range=4.0))
    _, blurry = footprints(PlatformSpec(range=4.0, pose_std=0.15))
    np.testing.assert_array_equal(sharp.targets, blurry.targets)
    worth = [
        np.sum(dense(belief.weights)[stops.footprints.cells] * (1 - np.exp(stops.footprints.misses / -16.0)))
        for stops in (sharp, blurry)
    ]
    assert worth[1] == pytest.approx(worth[0], rel=0.1)
    assert len(blurry.footprints.cells) > len(sharp.footprints.cells)


def test_ways_keep_farther_from_walls_the_less_a_robot_knows_where_it_is() -> None:
    away = ndimage.distance_transform_edt(~building()) * RESOLUTION
    nearest = []
    for std in (0.0, 0.05, 0.15):
        log_odds = drive_both_sides(std, True, 1)
        classes = np.where(log_odds > 0, OCCUPIED, np.where(log_odds < 0, FREE, UNKNOWN)).astype(np.uint8)
        corridor = traversable(classes, 0.2, RESOLUTION)[44:58]
        nearest.append(np.quantile(away[44:58][corridor], 0.05))
    assert nearest == sorted(nearest)
    assert nearest[2] > nearest[0] + 0.05


# -- missions ---------------------------------------------------------------------------------------------


def test_a_mate_whose_place_is_uncertain_does_not_get_into_the_map() -> None:
    mission, told, there = explorer(), mate_at(1.0, 7.2), mate_at(1.25, 7.3)
    pose = Pose(HERE.x, HERE.y, 0.0, deviation=0.15)
    mission.observe(scan_from(HERE, np.random.default_rng(0), mates=(there,)), pose, [told], 0.1)
    mission.publish(0.0)
    around = np.hypot(*(FRAME.centres(np.arange(FRAME.size)) - (there.x, there.y)).T) < 0.3
    assert not np.equal(mission.fusion.classes.window().flat[np.flatnonzero(around)], OCCUPIED).any()


def test_a_certain_pose_gives_the_sharp_map() -> None:
    mission = explorer()
    scan = Scan(BEAMS, scan_from(HERE, np.random.default_rng(0)).ranges)
    mission.observe(scan, Pose(HERE.x, HERE.y, 0.0, deviation=0.0), [], 0.0)
    sharp = np.zeros(FRAME.shape, np.int8)
    x, y = HERE.x - FRAME.origin_x, HERE.y - FRAME.origin_y
    reach = mission.spec.range
    beams = (BEAMS, np.minimum(scan.ranges, reach), scan.ranges < reach)
    on_dense(lidar.integrate_scan, sharp, RESOLUTION, x, y, *beams, 4, 2, 20, 0.25 * RESOLUTION)
    np.testing.assert_array_equal(mission.own.log_odds.window(), sharp)
    assert explored([]).max() == UNKNOWN


def test_a_team_with_uncertain_poses_completes_its_mission() -> None:
    _, report = run(small_maze(), robots(2, pose_std=0.05, pose_std_heading=0.2))
    assert report.summary.outcome.value == "complete"
    assert report.summary.coverage > 0.98
    assert report.summary.collisions == 0


def test_the_same_seed_gives_the_same_errors_and_the_same_mission() -> None:
    fields: dict[str, float] = {"pose_std": 0.15, "pose_std_heading": 1.0}
    once, again = (run(small_maze(), robots(2, **fields), max_time=10.0)[1].summary for _ in range(2))
    assert once == again

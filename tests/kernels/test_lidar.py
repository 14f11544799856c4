"""Lidar kernels against their twins, and against rooms whose ranges are known in closed form."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from tests.support.grids import on_dense
from vedette.kernels import lidar
from vedette.kernels.reference import lidar as reference_lidar
from vedette.kernels.tiles import TiledGrid, Tiling

seeds = st.integers(0, 2**32 - 1)
NOTHING = TiledGrid(Tiling(2, 2), np.int8)
RESOLUTION = 0.1


def random_place(seed: int) -> dict[str, Any]:
    """Draw a small grid's shape and a sensor in it with beams in generic directions."""
    rng = np.random.default_rng(seed)
    rows, cols = rng.integers(1, 25, 2)
    beams = int(rng.integers(0, 12))
    return {
        "rng": rng,
        "shape": (int(rows), int(cols)),
        "x": rng.uniform(0, cols * RESOLUTION),
        "y": rng.uniform(0, rows * RESOLUTION),
        "angles": rng.uniform(-10, 10, beams),
        "ranges": rng.uniform(0, 2.5, beams),
        "hits": rng.random(beams) < 0.6,
    }


@settings(deadline=None, max_examples=80)
@given(seeds)
def test_cast_rays_equals_its_twin(seed: int) -> None:
    place = random_place(seed)
    rng = place["rng"]
    solid = rng.random(place["shape"]) < rng.choice([0.0, 0.05, 0.4])
    discs = np.column_stack((rng.uniform(-0.5, 2.5, (3, 2)), rng.uniform(0.01, 0.4, 3)))
    scan = (RESOLUTION, place["x"], place["y"], place["angles"], rng.uniform(0.1, 3.0), discs)
    np.testing.assert_allclose(
        lidar.cast_rays(solid, *scan), reference_lidar.cast_rays(solid, *scan), atol=1e-9
    )


@settings(deadline=None, max_examples=80)
@given(seeds)
def test_integrate_scan_equals_its_twin(seed: int) -> None:
    place = random_place(seed)
    log_odds = place["rng"].integers(-9, 10, place["shape"]).astype(np.int8)
    twin = log_odds.copy()
    scan = (RESOLUTION, *(place[key] for key in ("x", "y", "angles", "ranges", "hits")), 5, 3, 9, 0.04)
    changed = on_dense(lidar.integrate_scan, log_odds, *scan)
    np.testing.assert_array_equal(changed, reference_lidar.integrate_scan(twin, *scan))
    np.testing.assert_array_equal(log_odds, twin)


@settings(deadline=None, max_examples=80)
@given(seeds, st.sampled_from([0.0, 0.05]), st.integers(1, 6), st.integers(1, 3))
@example(2599, 0.0, 4, 1)  # a grid of two cells, and nothing occupied
def test_count_sightings_equals_its_twin(seed: int, nudge: float, berths: int, step: int) -> None:
    place = random_place(seed)
    log_odds = place["rng"].choice([-3, 0, 0, 0, 3], place["shape"]).astype(np.int8)
    beams = (RESOLUTION, *(place[key] for key in ("x", "y", "angles", "ranges", "hits")))
    scan = (*beams, 2.5, 0.3, berths, step, 2, nudge)
    counts = on_dense(lidar.count_sightings, log_odds, *scan)
    np.testing.assert_array_equal(counts, reference_lidar.count_sightings(log_odds, *scan))


def test_ranges_in_an_empty_room_are_the_distances_to_its_walls() -> None:
    solid = np.zeros((40, 60), bool)  # 4 m x 6 m, closed by the grid's border
    angles = np.linspace(0, 2 * math.pi, 73)
    x, y = 2.13, 1.57
    with np.errstate(divide="ignore"):
        to_x = np.where(np.cos(angles) > 0, 6 - x, x) / np.abs(np.cos(angles))
        to_y = np.where(np.sin(angles) > 0, 4 - y, y) / np.abs(np.sin(angles))
    ranges = lidar.cast_rays(solid, RESOLUTION, x, y, angles, 100.0, np.empty((0, 3)))
    np.testing.assert_allclose(ranges, np.minimum(to_x, to_y), rtol=1e-12)


def test_a_beam_stops_at_the_nearer_of_wall_and_disc_and_passes_the_disc_around_the_sensor() -> None:
    solid = np.zeros((10, 100), bool)
    solid[:, 80] = True
    own, other, behind = [1.0, 0.55, 0.2], [5.0, 0.55, 0.5], [9.5, 0.55, 0.2]
    cast = [[own], [own, other], [own, behind]]
    ranges = [
        lidar.cast_rays(solid, RESOLUTION, 1.0, 0.55, np.zeros(1), 20.0, np.array(discs))[0] for discs in cast
    ]
    assert ranges == pytest.approx([7.0, 3.5, 7.0])


def test_nothing_within_max_range_is_infinity_and_max_range_itself_is_within() -> None:
    solid = np.zeros((3, 100), bool)
    solid[:, 64] = True
    at = (0.25, 4.0, 0.375, np.zeros(1))  # 12 m to the wall, exactly
    none = np.empty((0, 3))
    assert lidar.cast_rays(solid, *at, 12.0, none)[0] == 12.0
    assert lidar.cast_rays(solid, *at, 11.999, none)[0] == math.inf


def test_a_sensor_inside_a_wall_or_outside_the_grid_measures_zero() -> None:
    solid = np.ones((3, 3), bool)
    none = np.empty((0, 3))
    assert lidar.cast_rays(solid, 1.0, 1.5, 1.5, np.zeros(1), 5.0, none)[0] == 0.0
    assert lidar.cast_rays(~solid, 1.0, -0.5, 1.5, np.zeros(1), 5.0, none)[0] == 0.0


def test_a_hit_wins_over_a_miss_and_each_cell_counts_once_a_scan() -> None:
    log_odds = np.zeros((1, 10), np.int8)
    angles, ranges, hits = np.zeros(3), np.array([5.0, 5.0, 9.0]), np.array([True, True, False])
    changed = on_dense(lidar.integrate_scan, log_odds, 1.0, 0.5, 0.5, angles, ranges, hits, 4, 1, 100, 0.6)
    assert log_odds.tolist() == [[-1, -1, -1, -1, -1, -1, 4, -1, -1, -1]]
    assert changed.tolist() == list(range(10))


def test_log_odds_saturate_and_only_class_changes_are_returned() -> None:
    log_odds = np.array([[-99, 2, 98]], np.int8)
    scan = (1.0, 0.5, 0.5, np.zeros(1), np.array([2.0]), np.array([True]))
    assert on_dense(lidar.integrate_scan, log_odds, *scan, 4, 3, 100, 0.1).tolist() == [1]
    assert log_odds.tolist() == [[-100, -1, 100]]


def test_sightings_stop_at_known_walls_and_count_the_unknown_length_before_a_cell() -> None:
    log_odds = np.array([[-1, -1, 0, 0, 0, 9, 0]], np.int8)
    scan = (np.zeros(1), np.array([3.5]), np.array([True]))
    counts = on_dense(lidar.count_sightings, log_odds, 1.0, 0.5, 0.5, *scan, 7.0, 1.0, 1, 1, 1)
    assert counts[0].tolist() == [
        0,
        0,
        1,
        1,
        1,
        0,
        0,
    ]  # entered at 1.5, 2.5 and 3.5 m: middles at 2, 3 and 4 m
    assert counts[1].tolist() == [0, 0, 1, 1, 1, 0, 0]  # the hit at 3.5 m is on the face of the third
    assert counts[2].tolist() == counts[3].tolist() == [1, 1, 1, 0, 0, 0, 0]


def test_a_beam_counts_by_the_narrowest_berth_that_it_has_passed() -> None:
    log_odds = np.full((7, 9), -1, np.int8)
    log_odds[3, [2, 3, 5, 7]] = 0  # in three stretches, entered at columns 2, 5 and 7
    log_odds[1, 5] = 9  # two cells from the second entry alone
    scan = (np.zeros(1), np.array([8.5]), np.array([False]))
    counts = on_dense(lidar.count_sightings, log_odds, 1.0, 0.5, 3.5, *scan, 9.0, 1.0, 4, 1, 1)
    by_berth = counts[2::2].tolist()
    assert by_berth[2][:4] == [1, 1, 0, 0]  # three cells from the wall, along the farther axis
    assert by_berth[1][:4] == [0, 0, 1, 1]  # and so it stays
    assert np.count_nonzero(by_berth) == 4


@pytest.mark.parametrize(
    ("angles", "ranges", "hits", "message"),
    [
        (np.zeros(2), np.zeros(1), np.zeros(1, bool), "equally long"),
        (np.array([np.nan]), np.zeros(1), np.zeros(1, bool), "angles must be finite"),
        (np.zeros(1), np.array([np.inf]), np.zeros(1, bool), "ranges must be finite"),
    ],
)
def test_beams_that_do_not_fit_are_refused(angles: Any, ranges: Any, hits: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        on_dense(
            lidar.integrate_scan, np.zeros((2, 2), np.int8), 1.0, 0.5, 0.5, angles, ranges, hits, 1, 1, 9, 0.0
        )

"""Scans of real lidars, against points in a world that are known beforehand."""

from __future__ import annotations

from dataclasses import replace
from math import cos, inf, nan, pi, radians, sin

import numpy as np
import pytest
from numpy.typing import NDArray

from vedette.errors import InputError
from vedette.ros2.scans import Beams, LaserSweep, Lidar, beams, measured
from vedette.ros2.transforms import Matrix, matrix, planar

WALL = 3.0  # every beam meets the wall x = WALL or goes on for ever [m]


def sweep(ranges: NDArray[np.float64] | list[float], **told: float) -> LaserSweep:
    usual = {
        "angle_min": -1.0,
        "angle_increment": 0.1,
        "time_increment": 0.0,
        "range_min": 0.1,
        "range_max": 8.0,
    }
    return LaserSweep("laser", 5.0, ranges=np.asarray(ranges, np.float64), **{**usual, **told})


def facing_the_wall(poses: list[Matrix], at: NDArray[np.float64]) -> NDArray[np.float64]:
    """Ranges that beams at angles ``at`` of the lidar's frame measure, each from its own pose."""
    ranges = []
    for T, angle in zip(poses, at, strict=True):
        along = T[:2, :2] @ (cos(angle), sin(angle))
        ranges.append((WALL - T[0, 3]) / along[0] if along[0] > 0.1 else inf)
    return np.array(ranges)


def ends(told: Beams) -> NDArray[np.float64]:
    met = np.isfinite(told.ranges)
    along = np.column_stack((np.cos(told.angles), np.sin(told.angles)))[met]
    return np.array((told.x, told.y)) + told.ranges[met, None] * along


def on_the_wall(told: Beams) -> None:
    points = ends(told)
    assert len(points) > 5
    np.testing.assert_allclose(points[:, 0], WALL, atol=1e-9)


def test_what_is_no_number_or_too_near_is_no_measurement() -> None:
    told = measured(sweep([nan, 0.05, 0.0, -1.0, -inf, 0.1, 7.9]), "free")
    assert np.isnan(told[:5]).all()
    assert told[5:].tolist() == [0.1, 7.9]


@pytest.mark.parametrize(("no_return", "says"), [("free", inf), ("ignore", nan)])
def test_what_a_missing_return_says_is_an_option(no_return: str, says: float) -> None:
    np.testing.assert_array_equal(measured(sweep([inf, 8.0, 9.0, 1.0]), no_return), [says, says, says, 1.0])


def test_a_range_min_that_is_no_number_does_not_hide_the_scan() -> None:
    assert measured(sweep([1.0, nan], range_min=nan), "free")[0] == 1.0


@pytest.mark.parametrize("increment", [0.1, -0.1])
def test_beams_either_way_round_meet_the_wall(increment: float) -> None:
    at = -increment * 10 + increment * np.arange(21)
    T = planar(0.5, 1.0, 0.3)
    told = beams(
        sweep(facing_the_wall([T] * 21, at), angle_min=float(at[0]), angle_increment=increment),
        [T, T],
        "free",
    )
    on_the_wall(told)
    assert (told.x, told.y) == (0.5, 1.0)


def test_a_lidar_upside_down_and_off_centre_meets_the_wall() -> None:
    T_map_base = planar(0.5, 1.0, 0.3)
    T_base_laser = matrix((0.2, 0.1, 0.3), (1.0, 0.0, 0.0, 0.0))  # rolled by half a turn
    T = T_map_base @ T_base_laser
    at = -1.0 + 0.1 * np.arange(21)
    turned = [planar(T[0, 3], T[1, 3], 0.3)] * 21
    told = beams(sweep(facing_the_wall(turned, -at)), [T, T], "free")
    on_the_wall(told)
    assert (told.x, told.y) == pytest.approx(T[:2, 3].tolist())


def test_a_scan_from_a_robot_that_drives_and_turns_is_straightened() -> None:
    first, last, n = planar(0.0, 0.0, -0.2), planar(0.1, 0.05, 0.2), 41
    shares = np.linspace(0.0, 1.0, n)
    poses = [planar(0.1 * s, 0.05 * s, -0.2 + 0.4 * s) for s in shares]
    at = -1.0 + 0.05 * np.arange(n)
    scan = sweep(facing_the_wall(poses, at), angle_increment=0.05, time_increment=0.002)
    assert scan.ends == pytest.approx(5.0 + 40 * 0.002)
    on_the_wall(beams(scan, [first, last], "free"))
    crooked = ends(beams(scan, [last, last], "free"))
    assert np.abs(crooked[:, 0] - WALL).max() > 0.05


def test_a_scan_in_whose_middle_the_robot_begins_to_turn_is_straightened_by_what_lies_between() -> None:
    n, at = 41, -1.0 + 0.05 * np.arange(41)
    turned = np.maximum(np.linspace(-0.3, 0.3, n), 0.0)  # not before the middle
    poses = [planar(0.0, 0.0, yaw) for yaw in turned]
    scan = sweep(facing_the_wall(poses, at), angle_increment=0.05, time_increment=0.002)
    on_the_wall(beams(scan, [poses[0], poses[20], poses[40]], "free"))
    crooked = ends(beams(scan, [poses[0], poses[40]], "free"))
    assert np.abs(crooked[:, 0] - WALL).max() > 0.05


def test_directions_without_a_return_are_told_too() -> None:
    T = planar(1.0, 2.0, pi / 2)
    told = beams(sweep([inf, 2.0, inf], angle_min=-0.1), [T, T], "free")
    np.testing.assert_allclose(told.angles, pi / 2 + np.array((-0.1, 0.0, 0.1)))
    assert told.ranges.tolist() == [inf, 2.0, inf]


def test_a_lidar_is_what_its_scans_tell() -> None:
    told = Lidar.of(sweep(np.ones(540), angle_increment=-radians(0.5), range_max=12.0), "scan")
    assert (told.range, told.beams) == (12.0, 540)
    assert told.view == pytest.approx(270.0)
    assert Lidar.of(sweep(np.ones(800), angle_increment=0.01), "scan").view == 360.0


@pytest.mark.parametrize(
    ("wrong", "named"),
    [
        ({"range_max": 0.0}, "range_max"),
        ({"range_max": inf}, "range_max"),
        ({"angle_increment": 0.0}, "angle_increment"),
        ({"angle_increment": nan}, "angle_increment"),
    ],
)
def test_scans_that_no_lidar_sends_are_refused_by_name(wrong: dict[str, float], named: str) -> None:
    with pytest.raises(InputError, match=f"robot1/scan: {named}"):
        Lidar.of(replace(sweep(np.ones(9)), **wrong), "robot1/scan")


def test_a_scan_without_beams_is_refused() -> None:
    with pytest.raises(InputError, match="0 beams"):
        Lidar.of(sweep([]), "scan")

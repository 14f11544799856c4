"""Transforms by time, against closed forms and SciPy's rotations."""

from __future__ import annotations

from math import pi, radians

import numpy as np
import pytest
from scipy.spatial.transform import Rotation, Slerp

from vedette.ros2.transforms import KEPT, Gap, Matrix, Transforms, between, deviations, matrix, place, planar

RNG = np.random.default_rng(3)


def random_transform() -> Matrix:
    return matrix(RNG.normal(size=3).tolist(), RNG.normal(size=4).tolist())


def test_a_quaternion_gives_the_rotation_that_scipy_gives() -> None:
    for _ in range(20):
        q = RNG.normal(size=4)
        np.testing.assert_allclose(matrix((0, 0, 0), q.tolist())[:3, :3], Rotation.from_quat(q).as_matrix())


def test_between_two_transforms_places_move_straight_and_turns_are_spherical() -> None:
    for _ in range(20):
        first, last = random_transform(), random_transform()
        ends = Rotation.from_matrix([first[:3, :3], last[:3, :3]])
        shares = np.array((0.0, 0.3, 1.0))
        told = between(first, last, shares)
        np.testing.assert_allclose(told[:, :3, :3], Slerp([0.0, 1.0], ends)(shares).as_matrix(), atol=1e-9)
        np.testing.assert_allclose(told[1, :3, 3], 0.7 * first[:3, 3] + 0.3 * last[:3, 3])


def test_frames_are_chained_up_and_down_the_tree_at_the_time_asked_for() -> None:
    tree = Transforms()
    mount = planar(0.2, 0.0, pi)
    tree.add("base_link", "laser", 0.0, mount, fixed=True)
    tree.add("map", "odom", 0.0, planar(1.0, 0.0, 0.0))
    tree.add("map", "odom", 10.0, planar(1.0, 2.0, 0.0))
    tree.add("odom", "base_link", 4.0, planar(0.0, 0.0, 0.0))
    tree.add("odom", "base_link", 6.0, planar(2.0, 0.0, pi / 2))
    told = tree.lookup("map", "laser", 5.0)
    assert not isinstance(told, Gap)
    np.testing.assert_allclose(told, planar(1.0, 1.0, 0.0) @ planar(1.0, 0.0, pi / 4) @ mount, atol=1e-12)
    back = tree.lookup("laser", "map", 5.0)
    np.testing.assert_allclose(back, np.linalg.inv(told), atol=1e-12)


def test_what_is_not_told_yet_is_waited_for_and_what_is_forgotten_is_not() -> None:
    tree = Transforms()
    for stamp in np.arange(0.0, 20.1, 0.5):
        tree.add("odom", "base_link", stamp, planar(stamp, 0.0, 0.0))
    tree.add("map", "odom", 12.0, planar(0.0, 0.0, 0.0))
    assert tree.lookup("map", "base_link", 13.0) is Gap.NOT_YET
    tree.add("map", "odom", 21.0, planar(0.0, 0.0, 0.0))  # dated into the future
    told = tree.lookup("map", "base_link", 13.0)
    assert not isinstance(told, Gap)
    assert place(told) == pytest.approx((13.0, 0.0, 0.0))
    assert tree.lookup("odom", "base_link", 20.0 - KEPT - 1.0) is Gap.FORGOTTEN
    assert tree.lookup("odom", "base_link", 20.5) is Gap.NOT_YET
    assert tree.lookup("map", "camera") is Gap.UNCONNECTED


def test_the_newest_of_each_joint_is_where_the_robot_is_by_now() -> None:
    tree = Transforms()
    tree.add("map", "odom", 30.0, planar(5.0, 0.0, 0.0))
    tree.add("odom", "base_footprint", 12.0, planar(1.0, 0.0, 0.0))
    tree.add("base_footprint", "base_link", 0.0, planar(0.0, 0.0, 0.0), fixed=True)
    told = tree.lookup("map", "base_link")
    assert not isinstance(told, Gap)
    assert place(told)[0] == pytest.approx(6.0)
    assert tree.newest("base_link") == 12.0


def test_a_clock_that_begins_anew_begins_the_memory_anew() -> None:
    tree = Transforms()
    tree.add("odom", "base_link", 1000.0, planar(9.0, 0.0, 0.0))
    tree.add("odom", "base_link", 0.0, planar(1.0, 0.0, 0.0))
    tree.add("odom", "base_link", 1.0, planar(2.0, 0.0, 0.0))
    told = tree.lookup("odom", "base_link", 0.5)
    assert not isinstance(told, Gap)
    assert place(told)[0] == pytest.approx(1.5)


def test_transforms_out_of_order_repeated_malformed_or_in_a_ring_do_no_harm() -> None:
    tree = Transforms()
    for stamp in (3.0, 1.0, 2.0, 2.0):
        tree.add("/odom", "/base_link", stamp, planar(stamp, 0.0, 0.0))
    tree.add("odom", "base_link", 2.5, np.full((4, 4), np.nan))
    tree.add("one", "other", 2.0, planar(0.0, 0.0, 0.0))
    tree.add("other", "one", 2.0, planar(0.0, 0.0, 0.0))
    told = tree.lookup("odom", "base_link", 2.5)
    assert not isinstance(told, Gap)
    assert place(told)[0] == pytest.approx(2.5)
    assert tree.lookup("map", "base_link") is Gap.UNCONNECTED
    assert tree.lookup("odom", "one") is Gap.UNCONNECTED


def test_deviations_are_those_of_a_poses_covariance() -> None:
    covariance = np.zeros((6, 6))
    covariance[0, 0] = covariance[1, 1] = 0.04
    covariance[5, 5] = radians(3.0) ** 2
    assert deviations(covariance.ravel().tolist()) == pytest.approx((0.2, radians(3.0)))
    assert deviations([float("nan")] * 36) == (0.0, 0.0)

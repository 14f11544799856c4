"""Visibility kernels against separating axes on every pair of cells."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vedette.kernels import visibility
from vedette.kernels.reference import visibility as reference_visibility

seeds = st.integers(0, 2**32 - 1)


@settings(deadline=None, max_examples=100)
@given(seeds)
def test_visible_cells_equal_testing_every_cell_against_every_pose(seed: int) -> None:
    rng = np.random.default_rng(seed)
    shape = tuple(rng.integers(1, 18, 2))
    solid = rng.random(shape) < rng.uniform(0, 0.6)
    solid[rng.integers(shape[0])] = rng.random(shape[1]) >= rng.uniform(0, 0.5)  # a wall with holes
    poses = rng.random(shape) < rng.choice([0.0, 0.01, 0.05, 0.3])
    range_cells = float(rng.choice([0.0, 1.0, 2.5, 5.0, 9.3, 40.0, np.inf]))
    expected = reference_visibility.visible_cells(solid, poses, range_cells)
    np.testing.assert_array_equal(visibility.visible_cells(solid, poses, range_cells), expected)


@settings(deadline=None, max_examples=100)
@given(seeds)
def test_line_of_sight_equals_its_twin_and_works_both_ways(seed: int) -> None:
    rng = np.random.default_rng(seed)
    shape = tuple(rng.integers(1, 25, 2))
    blocked = rng.random(shape) < rng.uniform(0, 0.4)
    start, cells = int(rng.integers(blocked.size)), rng.integers(blocked.size, size=20)
    sights = visibility.line_of_sight(blocked, start, cells)
    np.testing.assert_array_equal(sights, reference_visibility.line_of_sight(blocked, start, cells))
    back = [visibility.line_of_sight(blocked, int(cell), np.array([start]))[0] for cell in cells]
    assert sights.tolist() == back


def test_a_segment_through_a_corner_touches_the_squares_beside_it() -> None:
    blocked = np.array([[0, 1], [0, 0]], bool)
    assert not visibility.line_of_sight(blocked, 0, np.array([3]))[0]
    poses = np.array([[1, 0], [0, 0]], bool)
    assert visibility.visible_cells(blocked, poses, 5.0).tolist() == [[True, False], [True, False]]


def test_the_ends_of_a_line_of_sight_may_be_blocked() -> None:
    blocked = np.array([[1, 0, 0, 1]], bool)
    assert visibility.line_of_sight(blocked, 0, np.array([0, 1, 2, 3])).all()


def test_a_closed_room_without_poses_is_not_seen() -> None:
    solid = np.zeros((30, 30), bool)
    solid[10:21, [10, 20]] = solid[[10, 20], 10:21] = True
    poses = np.zeros_like(solid)
    poses[0, 0] = poses[29, 29] = True
    assert not visibility.visible_cells(solid, poses, 100.0)[11:20, 11:20].any()


def test_masks_of_different_shapes_are_refused() -> None:
    with pytest.raises(ValueError, match="one shape"):
        visibility.visible_cells(np.zeros((2, 3), bool), np.zeros((3, 2), bool), 5.0)

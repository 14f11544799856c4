"""Distance kernels against Dijkstra's algorithm on every move, and paths against the field they follow."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from vedette.kernels import distance
from vedette.kernels.reference import distance as reference_distance

seeds = st.integers(0, 2**32 - 1)


def random_mask(seed: int) -> tuple[NDArray[np.bool_], np.random.Generator]:
    """Draw a small traversable mask: noise at a random scale, so that both mazes and halls occur."""
    rng = np.random.default_rng(seed)
    rows, cols = rng.integers(1, 30, 2)
    scale = int(rng.integers(1, 5))
    coarse = rng.random((rows // scale + 1, cols // scale + 1)) < rng.uniform(0.4, 1.0)
    return np.kron(coarse, np.ones((scale, scale), bool))[:rows, :cols], rng


def path_length(path: NDArray[np.int64], cols: int) -> float:
    """Return a cell path's length with the kernels' diagonal, in cells."""
    steps = np.abs(np.diff(np.column_stack(np.divmod(path, cols)), axis=0))
    return float(np.sum(np.where(steps.sum(axis=1) == 2, 17 / 12, 1.0)))


@settings(deadline=None, max_examples=120)
@given(seeds)
def test_distance_field_equals_dijkstra_on_all_moves(seed: int) -> None:
    mask, rng = random_mask(seed)
    source = int(rng.integers(mask.size))
    field = distance.distance_field(mask, source, 0.1)
    np.testing.assert_array_equal(field, reference_distance.distance_field(mask, source, 0.1))


def large_mask(seed: int) -> tuple[NDArray[np.bool_], np.random.Generator]:
    """Draw a mask larger than what a search near its ends looks at first, with walls that lead far round."""
    rng = np.random.default_rng(seed)
    mask = rng.random(rng.integers(100, 400, 2)) < rng.choice([0.6, 0.8, 0.97])
    for _ in range(rng.integers(0, 6)):
        row = int(rng.integers(mask.shape[0]))
        mask[row, int(rng.integers(mask.shape[1])) :] = False
        mask[row - 1, : int(rng.integers(mask.shape[1]))] = False
    return mask, rng


@settings(deadline=None, max_examples=60)
@given(seeds, st.booleans())
def test_lengths_and_paths_near_their_ends_are_those_of_the_whole_field(seed: int, large: bool) -> None:
    mask, rng = large_mask(seed) if large else random_mask(seed)
    source = int(rng.integers(mask.size))
    spread = rng.integers(-25, 26, (4, 2)) if rng.random() < 0.7 else rng.integers(0, 400, (4, 2))
    places = np.clip(np.add(divmod(source, mask.shape[1]), spread), 0, np.subtract(mask.shape, 1))
    targets = places[:, 0] * mask.shape[1] + places[:, 1]
    field = distance.distance_field(mask, source, 0.1)
    np.testing.assert_array_equal(distance.lengths_to(mask, source, targets, 0.1), field.flat[targets])
    for target in targets.tolist():
        path = distance.shortest_path(mask, source, target, 0.1)
        np.testing.assert_array_equal(path, distance.path_to(field, mask, target))


@settings(deadline=None, max_examples=60)
@given(seeds, st.sampled_from([math.inf, 0.0, 0.75, 1.5]))
def test_distance_matrix_equals_dijkstra_on_all_moves(seed: int, limit: float) -> None:
    mask, rng = random_mask(seed)
    cells = rng.integers(mask.size, size=int(rng.integers(0, 6)))
    matrix = distance.distance_matrix(mask, cells, 0.1, limit)
    np.testing.assert_array_equal(matrix, reference_distance.distance_matrix(mask, cells, 0.1, limit))
    np.testing.assert_array_equal(matrix, matrix.T)


@settings(deadline=None, max_examples=80)
@given(seeds)
def test_a_path_equals_its_twin_and_is_as_long_as_the_field_says(seed: int) -> None:
    mask, rng = random_mask(seed)
    source, target = (int(cell) for cell in rng.integers(mask.size, size=2))
    field = distance.distance_field(mask, source, 1.0)
    path = distance.path_to(field, mask, target)
    np.testing.assert_array_equal(path, reference_distance.path_to(field, mask, target))
    if not math.isfinite(field.flat[target]):
        assert len(path) == 0
        return
    assert (path[0], path[-1]) == (source, target)
    if mask.flat[source]:
        assert path_length(path, mask.shape[1]) == pytest.approx(float(field.flat[target]), abs=1e-4)


@settings(deadline=None, max_examples=60)
@given(seeds)
def test_a_shortcut_equals_its_twin_and_is_no_longer_than_the_path(seed: int) -> None:
    mask, rng = random_mask(seed)
    source, target = (int(cell) for cell in rng.integers(mask.size, size=2))
    path = distance.path_to(distance.distance_field(mask, source, 1.0), mask, target)
    short = distance.shortcut(mask, path)
    np.testing.assert_array_equal(short, reference_distance.shortcut(mask, path))
    assert short[:1].tolist() == path[:1].tolist()
    assert short[-1:].tolist() == path[-1:].tolist()

    def euclidean(cells: NDArray[np.int64]) -> float:
        return float(np.sum(np.hypot(*np.diff(np.divmod(cells, mask.shape[1]), axis=1))))

    assert euclidean(short) <= euclidean(path) + 1e-9


def test_lengths_in_the_open_are_octile_within_two_tenths_of_a_percent() -> None:
    field = distance.distance_field(np.ones((50, 80), bool), 0, 0.1)
    rows, cols = np.indices((50, 80))
    octile = 0.1 * (np.maximum(rows, cols) + (math.sqrt(2) - 1) * np.minimum(rows, cols))
    assert np.all(field >= octile - 1e-5)
    assert np.all(field <= octile * (1 + 1.8e-3) + 1e-5)


def test_a_diagonal_step_does_not_cut_a_corner() -> None:
    corner = np.array([[1, 1, 1], [1, 1, 0], [1, 1, 1]], bool)
    assert distance.distance_field(corner, 1, 12.0)[2, 2] == 12 * 3  # down, down, right
    gap = np.array([[1, 0], [0, 1]], bool)
    assert distance.distance_field(gap, 0, 1.0)[1, 1] == math.inf


def test_a_robot_pushed_off_the_traversable_cells_still_finds_its_way() -> None:
    mask = np.zeros((9, 9), bool)
    mask[:, 5:] = True
    source, target = 4 * 9 + 3, 4 * 9 + 8
    field = distance.distance_field(mask, source, 1.0)
    assert field.flat[target] == 5.0
    assert distance.path_to(field, mask, target).tolist() == [source, *range(4 * 9 + 5, target + 1)]
    assert distance.distance_matrix(mask, np.array([source, target]), 1.0)[0, 1] == 5.0


def test_cells_outside_the_grid_are_refused() -> None:
    with pytest.raises(ValueError, match="cell 6 is outside a grid of 6 cells"):
        distance.distance_field(np.ones((2, 3), bool), 6, 0.1)
    with pytest.raises(ValueError, match="cell -1 is outside"):
        distance.distance_matrix(np.ones((2, 3), bool), np.array([0, -1]), 0.1)

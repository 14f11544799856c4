"""Frontier kernels against their twins."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from vedette.kernels import frontier
from vedette.kernels.reference import frontier as reference_frontier

seeds = st.integers(0, 2**32 - 1)


def random_classes(seed: int) -> NDArray[np.uint8]:
    """Draw a small map: noise at a random scale, so that both specks and areas occur."""
    rng = np.random.default_rng(seed)
    rows, cols = rng.integers(1, 40, 2)
    scale = int(rng.integers(1, 6))
    coarse = rng.choice(3, (rows // scale + 1, cols // scale + 1), p=rng.dirichlet([1, 2, 0.5]))
    return np.kron(coarse, np.ones((scale, scale), int))[:rows, :cols].astype(np.uint8)


@settings(deadline=None, max_examples=80)
@given(seeds, st.sampled_from([0.0, 0.04, 0.05, 0.1, 0.15, 0.2, 0.35, 0.61, 5.0]))
def test_traversable_equals_measuring_to_every_square(seed: int, radius: float) -> None:
    classes = random_classes(seed)
    expected = reference_frontier.traversable(classes, radius, 0.1)
    np.testing.assert_array_equal(frontier.traversable(classes, radius, 0.1), expected)


@settings(deadline=None, max_examples=120)
@given(seeds, st.integers(0, 5), st.integers(1, 12))
def test_frontiers_equal_flooding_and_bisection(seed: int, min_cells: int, max_extent: int) -> None:
    classes = random_classes(seed)
    cells, starts = frontier.find_frontiers(classes, min_cells, max_extent)
    twin_cells, twin_starts = reference_frontier.find_frontiers(classes, min_cells, max_extent)
    np.testing.assert_array_equal(starts, twin_starts)
    np.testing.assert_array_equal(cells, twin_cells)


def test_every_cluster_fits_the_extent_and_none_is_lost_when_none_is_too_small() -> None:
    classes = random_classes(7)
    cells, starts = frontier.find_frontiers(classes, 1, 5)
    assert sorted(cells) == np.flatnonzero(reference_frontier.frontier_mask(classes)).tolist()
    for first, last in pairwise(starts):
        rows, cols = np.divmod(cells[first:last], classes.shape[1])
        assert max(np.ptp(rows), np.ptp(cols)) < 5


@pytest.mark.parametrize("shape", [(0, 0), (0, 4), (4, 0), (1, 1)])
def test_a_map_without_free_cells_has_no_frontier_and_no_traversable_cell(shape: tuple[int, int]) -> None:
    classes = np.zeros(shape, np.uint8)
    cells, starts = frontier.find_frontiers(classes, 1, 5)
    assert (cells.tolist(), starts.tolist()) == ([], [0])
    assert not frontier.traversable(classes, 0.2, 0.1).any()


def test_an_extent_of_no_cells_is_refused() -> None:
    with pytest.raises(ValueError, match="max_extent_cells must be >= 1"):
        frontier.find_frontiers(np.ones((3, 3), np.uint8), 1, 0)

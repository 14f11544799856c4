"""Each search kernel equals its twin, the dense computation."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from vedette.kernels import search
from vedette.kernels.reference import search as reference_search
from vedette.kernels.search import Paths, Stencil

QUICK = settings(deadline=None, max_examples=40)
SEEDS = st.integers(0, 2**32 - 1)


def random_stencil(rng: np.random.Generator, most: int = 3) -> Stencil:
    taps = [rng.dirichlet(np.ones(rng.integers(1, most + 1))) for _ in range(2)]
    first = (int(rng.integers(-2, 2)), int(rng.integers(-2, 2)))
    return Stencil(first, taps[0], taps[1], leaves=bool(rng.integers(2)))


def random_mass(rng: np.random.Generator) -> NDArray[np.float64]:
    rows, cols = rng.integers(1, 13, 2)
    return rng.dirichlet(np.full(rows * cols, 0.3)).reshape(rows, cols)


def random_impact(
    rng: np.random.Generator, size: int, layers: int
) -> tuple[NDArray[np.uint32], NDArray[np.uint8]]:
    keys = np.flatnonzero(rng.random(size * layers) < 0.2).astype(np.uint32)
    levels = np.minimum(rng.integers(1, 60, len(keys)) * rng.choice([1, 20], len(keys)), 255)
    return keys, levels.astype(np.uint8)


def random_paths(rng: np.random.Generator, shape: tuple[int, int], layers: int) -> Paths:
    """A forest of looks at small patches: roots, children, and some that see nothing."""
    parents, depths, rows = [], [], []
    for node in range(rng.integers(1, 15)):
        above = [i for i in range(node) if depths[i] < layers - 1]
        parent = int(rng.choice([-1, *above])) if rng.random() < 0.8 else -1
        parents.append(parent)
        depths.append(0 if parent < 0 else depths[parent] + 1)
        row, col = rng.integers(0, shape)
        patch = np.zeros(shape, bool)
        patch[row : row + rng.integers(0, 4), col : col + rng.integers(0, 4)] = True
        rows.append(np.flatnonzero(patch))
    cells = np.concatenate(rows).astype(np.uint32)
    return Paths(
        np.array(parents, np.int64),
        np.cumsum([0, *map(len, rows)]).astype(np.int64),
        cells,
        rng.integers(1, 256, len(cells)).astype(np.uint8),
    )


@QUICK
@given(SEEDS)
def test_propagate_equals_its_twin_and_keeps_the_mass_that_may_not_leave(seed: int) -> None:
    rng = np.random.default_rng(seed)
    mass, stencil = random_mass(rng), random_stencil(rng, most=9)
    moved = search.propagate(mass, stencil)
    np.testing.assert_allclose(moved, reference_search.propagate(mass, stencil), atol=1e-15)
    assert moved.sum() <= 1.0 + 1e-14
    assert stencil.leaves or moved.sum() == pytest.approx(1.0, abs=1e-14)


@QUICK
@given(SEEDS)
def test_look_footprints_equal_their_twin(seed: int) -> None:
    rng = np.random.default_rng(seed)
    shape = tuple(rng.integers(1, 25, 2).tolist())
    poses = rng.uniform((-5, -5, -7), (25, 25, 7), (rng.integers(1, 4), rng.integers(1, 4), 3))
    view = rng.choice([2 * np.pi, rng.uniform(0.1, 6.2)])
    arguments = (
        shape,
        rng.uniform(0.5, 2),
        poses,
        rng.random(50),
        rng.uniform(0.1, 8),
        view,
        rng.integers(1, 7),
    )
    for mine, twin in zip(
        search.look_footprints(*arguments), reference_search.look_footprints(*arguments), strict=True
    ):
        np.testing.assert_allclose(mine, twin, rtol=1e-12)


@QUICK
@given(SEEDS)
def test_detected_mass_equals_the_dense_forward_filter(seed: int) -> None:
    rng = np.random.default_rng(seed)
    mass, stencil, layers = random_mass(rng), random_stencil(rng), int(rng.integers(1, 6))
    impact = random_impact(rng, mass.size, layers)
    steps = int(rng.integers(0, layers + 1))
    mine = search.detected_mass(mass, stencil, steps, layers, *impact)
    np.testing.assert_allclose(
        mine, reference_search.detected_mass(mass, stencil, steps, layers, *impact), atol=1e-14
    )


@QUICK
@given(SEEDS)
def test_path_gains_equal_the_dense_filter_with_the_path_less_that_without(seed: int) -> None:
    rng = np.random.default_rng(seed)
    mass, stencil, layers = random_mass(rng), random_stencil(rng), int(rng.integers(1, 6))
    weights = np.sort(rng.random(layers))[::-1]
    others = random_impact(rng, mass.size, layers)
    paths = random_paths(rng, mass.shape, layers)
    steps = int(rng.integers(0, layers + 1))
    mine = search.path_gains(mass, stencil, steps, weights, others, paths)
    twin = reference_search.path_gains(mass, stencil, steps, weights, others, paths)
    np.testing.assert_allclose(mine, twin, atol=1e-13)


@pytest.mark.parametrize("before", [False, True])
def test_who_looks_in_the_last_step_detects_what_has_come_from_as_far_as_it_can_get(before: bool) -> None:
    """Three cells a step, and five steps: from the third column to the eighteenth, by way of the sixth."""
    mass = np.zeros((3, 40))
    mass[1, 2] = 1.0
    drift = Stencil((0, 3), np.ones(1), np.ones(1))
    cells, levels = [*[40 + 5] * before, 40 + 17], [*[20] * before, 200]
    looks = Paths(
        np.arange(-1, 4),
        np.array([0, *[len(cells) - 1] * 4, len(cells)]),
        np.array(cells, np.uint32),
        np.array(levels, np.uint8),
    )
    nobody = np.empty(0, np.uint32), np.empty(0, np.uint8)
    gains = search.path_gains(mass, drift, 5, np.ones(5), nobody, looks)
    twin = reference_search.path_gains(mass, drift, 5, np.ones(5), nobody, looks)
    assert gains.tolist() == pytest.approx(twin.tolist())
    assert bool(twin[0] > 0.1) is before
    assert twin[4] - twin[3] > 0.1


def test_paths_that_see_nothing_gain_nothing() -> None:
    nothing = Paths(np.array([-1, 0]), np.zeros(3, np.int64), np.empty(0, np.uint32), np.empty(0, np.uint8))
    still = Stencil((0, 0), np.ones(1), np.ones(1))
    others = (np.array([3], np.uint32), np.array([9], np.uint8))
    gains = search.path_gains(np.full((2, 2), 0.25), still, 2, np.ones(2), others, nothing)
    assert gains.tolist() == [0.0, 0.0]


@pytest.mark.parametrize("seed", range(6))
def test_a_target_gets_as_far_in_a_step_as_the_stencil_says_and_no_farther(seed: int) -> None:
    stencil = random_stencil(np.random.default_rng(seed))
    mass = np.zeros((21, 21))
    mass[10, 10] = 1.0
    away = np.abs(np.argwhere(search.propagate(mass, stencil) > 0.0) - 10)
    assert away.max() == stencil.reach

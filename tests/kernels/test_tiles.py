"""Grids kept by tiles hold what plain arrays hold, and nothing else."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vedette.kernels.tiles import CELLS, SIDE, TiledGrid, Tiling

seeds = st.integers(0, 2**32 - 1)


@settings(deadline=None, max_examples=60)
@given(seeds)
def test_what_is_put_and_written_is_what_an_array_would_hold(seed: int) -> None:
    rng = np.random.default_rng(seed)
    rows, cols = (int(side) for side in rng.integers(1, 150, 2))
    grid, plain = TiledGrid(Tiling(rows, cols), np.int8), np.zeros((rows, cols), np.int8)
    for _ in range(6):
        cells = np.unique(rng.integers(0, rows * cols, 40))
        values = rng.integers(-9, 10, len(cells)).astype(np.int8)
        grid.put(cells, values)
        plain.flat[cells] = values
        some = rng.integers(0, rows * cols, 30)
        np.testing.assert_array_equal(grid.take(some), plain.flat[some])
        first, end = np.sort(rng.integers(0, rows + 5, 2)), np.sort(rng.integers(0, cols + 5, 2))
        window = slice(*first.tolist()), slice(*end.tolist())
        np.testing.assert_array_equal(grid.window(*window), plain[window])
        assert grid.window(*window).flags.c_contiguous
    np.testing.assert_array_equal(grid.window(), plain)
    np.testing.assert_array_equal(TiledGrid.of(plain).window(), plain)
    assert set(grid.held.tolist()) >= set(grid.tiling.holding(np.flatnonzero(plain)).tolist())


@settings(deadline=None, max_examples=30)
@given(seeds)
def test_tiles_are_read_as_they_were_written_and_blank_if_they_were_not(seed: int) -> None:
    rng = np.random.default_rng(seed)
    tiling = Tiling(200, 300)
    grid, plain = TiledGrid(tiling, np.uint8), np.zeros((tiling.count, CELLS), np.uint8)
    for _ in range(4):
        tiles = np.flatnonzero(rng.random(tiling.count) < 0.1)
        cells = rng.integers(0, 3, (len(tiles), CELLS)).astype(np.uint8)
        grid.write(tiles, cells)
        plain[tiles] = cells
    everywhere = rng.permutation(tiling.count)
    np.testing.assert_array_equal(grid.read(everywhere), plain[everywhere])
    np.testing.assert_array_equal(np.sort(grid.slots[grid.held]), np.arange(1, len(grid.held) + 1))


def test_memory_is_that_of_the_tiles_held_however_large_the_grid() -> None:
    grid = TiledGrid(Tiling(8192, 8192), np.int8)
    for tile in range(100):
        grid.put(np.array([tile * SIDE]), np.ones(1, np.int8))
    assert len(grid.held) == 100
    assert grid.blocks.nbytes <= 2 * 101 * CELLS


@pytest.mark.parametrize(("rows", "cols"), [(1, 1), (32, 32), (33, 64), (95, 31)])
def test_every_cell_is_in_one_tile_and_the_padding_of_tiles_is_outside(rows: int, cols: int) -> None:
    tiling = Tiling(rows, cols)
    tiles, places = tiling.split(np.arange(rows * cols))
    inside = np.zeros((tiling.count, CELLS), np.bool_)
    inside[tiles, places] = True
    assert inside.sum() == rows * cols
    np.testing.assert_array_equal(tiling.inside(np.arange(tiling.count)), inside)
    top, left = tiling.corners(tiles)
    row, col = np.divmod(np.arange(rows * cols), cols)
    np.testing.assert_array_equal(places, (row - top) * SIDE + col - left)

"""Tiles in another frame: equal to the twin, to whole moves of cells, and to the floats' own answer."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from vedette.kernels.reference import render as reference
from vedette.kernels.render import TileGround, TileMotion, render_tiles
from vedette.kernels.tiles import CELLS, TiledGrid, Tiling
from vedette.maps.transform import Transform


def ground_of(rows: int, cols: int, cell: int = 100_000) -> TileGround:
    """Return a grid whose origin is its middle."""
    return TileGround(rows, cols, -(cols // 2) * cell, -(rows // 2) * cell, cell)


def motion_of(transform: Transform) -> TileMotion:
    """Return a transform as the kernel takes it."""
    return TileMotion(1000 * transform.x, 1000 * transform.y, *transform.cosine)


def rendered(grid: NDArray[np.uint8], transform: Transform, ground: TileGround) -> NDArray[np.uint8]:
    """Return a whole grid in another frame."""
    source, out = TiledGrid.of(grid), TiledGrid(Tiling(*grid.shape), np.uint8)
    ids = np.sort(source.held)
    every = np.arange(out.tiling.count)
    out.write(every, render_tiles(ids, source.read(ids), every, ground, motion_of(transform)))
    return out.window()


@settings(deadline=None, max_examples=60)
@given(
    seed=st.integers(0, 2**32 - 1),
    shape=st.tuples(st.integers(1, 100), st.integers(1, 100)),
    cell=st.sampled_from([25_000, 50_000, 99_999, 100_000, 1_000_000]),
    transform=st.builds(
        Transform, st.integers(-9000, 9000), st.integers(-9000, 9000), st.integers(0, (1 << 16) - 1)
    ),
)
def test_a_rendering_is_the_twins_to_the_bit(
    seed: int, shape: tuple[int, int], cell: int, transform: Transform
) -> None:
    rng = np.random.default_rng(seed)
    ground, tiling = ground_of(*shape, cell), Tiling(*shape)
    ids = np.flatnonzero(rng.random(tiling.count) < 0.7)
    blocks = rng.integers(0, 5, (len(ids), CELLS), np.uint8) * tiling.inside(ids)
    wanted = rng.permutation(tiling.count)[: rng.integers(0, tiling.count + 1)]
    arguments = ids, blocks.astype(np.uint8), wanted, ground, motion_of(transform)
    assert np.array_equal(render_tiles(*arguments), reference.render_tiles(*arguments))


@pytest.mark.parametrize("quarters", range(4))
def test_a_quarter_turn_and_a_move_by_whole_cells_move_every_cell(quarters: int) -> None:
    grid = np.random.default_rng(3).integers(0, 5, (80, 80), np.uint8)
    turned = np.rot90(grid, -quarters)  # row 0 is the lowest y
    moved = np.zeros_like(grid)
    moved[5:, :-7] = turned[:-5, 7:]
    there = Transform(-700, 500, quarters << 14)
    assert np.array_equal(rendered(grid, there, ground_of(80, 80)), moved)


def test_a_cell_takes_what_is_under_its_middle() -> None:
    rng = np.random.default_rng(5)
    grid, ground = rng.integers(1, 5, (96, 96), np.uint8), ground_of(96, 96)
    there = Transform(1234, -567, 7919)
    out = rendered(grid, there, ground)
    c, s = math.cos(there.radians), math.sin(there.radians)
    checked = 0
    for row, col in rng.integers(0, 96, (500, 2)).tolist():
        x, y = (col - 48 + 0.5) * 0.1 - 1.234, (row - 48 + 0.5) * 0.1 + 0.567
        u, v = (c * x + s * y) / 0.1 + 48, (c * y - s * x) / 0.1 + 48
        if min(u % 1.0, v % 1.0) < 1e-3 or max(u % 1.0, v % 1.0) > 1.0 - 1e-3:
            continue  # on an edge
        inside = 0 <= u < 96 and 0 <= v < 96
        assert out[row, col] == (grid[int(v), int(u)] if inside else 0)
        checked += 1
    assert checked > 400

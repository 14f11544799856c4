"""Lattices: what a team must agree on, with or without an end."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from vedette.errors import InputError
from vedette.maps import GridFrame
from vedette.maps.area import Area
from vedette.maps.laid import laid
from vedette.maps.lattice import HALF, Lattice

YARD = Area.of([(-7.3, -2.0), (12.0, -2.0), (12.0, 9.05)])


def test_an_open_lattice_goes_as_far_to_each_side_of_the_origin_which_is_a_corner_of_cells() -> None:
    frame = Lattice.open(0.05, (1.0, -2.0)).frame
    assert frame.cell(1.0 + 1e-9, -2.0 + 1e-9) == (HALF, HALF)
    assert frame.cell(1.0 - 1e-9, -2.0 - 1e-9) == (HALF - 1, HALF - 1)
    assert frame.contains(-200.0, 200.0)


def test_the_lattice_of_an_area_holds_it_on_the_same_cells_as_the_open_one() -> None:
    lattice, around = Lattice.open(0.1, area=YARD), Lattice.open(0.1)
    x_min, x_max, y_min, y_max = lattice.frame.extent
    assert x_min <= -7.3 < x_min + 0.1
    assert y_max - 0.1 < 9.05 <= y_max + 1e-9
    assert (x_max, y_min) == pytest.approx((12.0, -2.0))
    for x, y in ((-7.0, -1.95), (0.06, 0.01), (11.93, 8.99)):
        here, there = lattice.frame.cell(x, y), around.frame.cell(x, y)
        np.testing.assert_allclose(
            lattice.frame.centres(np.array([here[0] * lattice.frame.cols + here[1]])),
            around.frame.centres(np.array([there[0] * around.frame.cols + there[1]])),
        )


def test_how_much_ground_there_is_is_known_of_a_map_and_an_area_only() -> None:
    assert Lattice(GridFrame(0.1, 30, 40)).cells == 1200
    assert Lattice.open(0.1).cells is None
    box = Area.of([(0, 0), (2, 0), (2, 1), (0, 1)])
    assert Lattice.open(0.1, area=box).cells == 200


def test_lattices_that_differ_in_anything_have_different_marks() -> None:
    lattice = Lattice.open(0.1, area=YARD)
    moved = replace(lattice, frame=replace(lattice.frame, origin_x=lattice.frame.origin_x + 0.1))
    others = [Lattice.open(0.1), Lattice.open(0.05, area=YARD), replace(lattice, area=None), moved]
    assert len({each.mark for each in (lattice, *others)}) == 5
    assert Lattice.open(0.1, area=YARD).mark == lattice.mark


def test_an_area_between_the_middles_of_all_cells_is_refused() -> None:
    for sliver in (
        [(0.06, 0.0), (0.14, 0.0), (0.14, 9.0), (0.06, 9.0)],
        [(3.0, 3.0), (3.01, 3.0), (3.0, 3.01)],
    ):
        with pytest.raises(
            InputError, match=r"area: no cell of 0\.1 m has its middle in it; give a larger one"
        ):
            Lattice.open(0.1, area=Area.of(sliver))


def test_an_area_of_too_many_cells_is_refused_and_so_is_no_resolution() -> None:
    with pytest.raises(InputError, match="smaller area or a larger resolution"):
        Lattice.open(0.001, area=YARD)
    for resolution in (0.0, float("nan"), -0.1):
        with pytest.raises(InputError, match="resolution"):
            Lattice.open(resolution)


def test_a_grid_laid_on_another_shows_what_is_under_each_middle() -> None:
    grid, frame = np.arange(1, 13, dtype=np.uint8).reshape(3, 4), GridFrame(0.1, 3, 4, 1.0, 2.0)
    onto = GridFrame(0.1, 5, 5, 0.8, 2.1)
    expected = np.zeros((5, 5), np.uint8)
    expected[:2, 2:] = grid[1:, :3]
    np.testing.assert_array_equal(laid(grid, frame, onto), expected)
    fine = laid(grid, frame, GridFrame(0.05, 6, 8, 1.0, 2.0))
    np.testing.assert_array_equal(fine, grid.repeat(2, axis=0).repeat(2, axis=1))
    assert not laid(grid, frame, GridFrame(0.1, 5, 5, 8.0, 2.1)).any()

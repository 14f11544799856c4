"""A map whose origin has a yaw lies where map_server puts it, in a grid along the axes."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from vedette.maps import FREE, OCCUPIED, UNKNOWN, GridFrame
from vedette.maps.turned import upright

CLASSES = hnp.arrays(
    np.uint8, hnp.array_shapes(min_dims=2, max_dims=2, max_side=7), elements=st.integers(0, 2)
)


def in_the_map(frame: GridFrame, row: int, col: int, yaw: float) -> tuple[float, float]:
    """Return where the centre of a cell lies when the grid is turned about its lower-left corner."""
    u, v = (col + 0.5) * frame.resolution, (row + 0.5) * frame.resolution
    return (
        frame.origin_x + math.cos(yaw) * u - math.sin(yaw) * v,
        frame.origin_y + math.sin(yaw) * u + math.cos(yaw) * v,
    )


@given(classes=CLASSES, quarters=st.integers(-4, 4), off=st.floats(-1, 1))
@settings(max_examples=60)
def test_quarter_turns_move_every_cell_to_where_its_centre_goes(
    classes: np.ndarray, quarters: int, off: float
) -> None:
    yaw = quarters * math.pi / 2
    almost = yaw + 0.49 * off / math.hypot(*classes.shape)  # moves no corner by half a cell
    frame, turned = upright(classes, 0.5, (10.0, -20.0, almost))
    before = GridFrame(0.5, *classes.shape, 10.0, -20.0)
    assert turned.size == classes.size
    for row, col in np.ndindex(*classes.shape):
        assert turned[frame.cell(*in_the_map(before, row, col, yaw))] == classes[row, col]


@pytest.mark.parametrize("yaw", [0.0, 1e-17, -1e-17, 1e-6, 0.0002, 2 * math.pi, -2 * math.pi + 1e-9])
def test_a_yaw_that_moves_no_corner_by_half_a_cell_is_none(yaw: float) -> None:
    classes = np.random.default_rng(0).integers(0, 3, (1200, 1600), np.uint8)
    frame, turned = upright(classes, 0.05, (448262.5, 5411932.25, yaw))
    assert frame == GridFrame(0.05, 1200, 1600, 448262.5, 5411932.25)
    np.testing.assert_array_equal(turned, classes)


@given(classes=CLASSES, yaw=st.floats(-math.pi, math.pi), x=st.sampled_from([0.0, 448262.5]))
@settings(max_examples=60, deadline=None)
def test_any_other_yaw_takes_the_class_at_each_centre_and_what_is_occupied_beside_it(
    classes: np.ndarray, yaw: float, x: float
) -> None:
    frame, turned = upright(classes, 0.1, (x, 2.0, yaw))
    rows, cols = classes.shape
    quarter = abs(math.remainder(yaw, math.pi / 2)) * math.hypot(rows, cols) < 0.5

    def at(u: float, v: float) -> int:
        inside = 0 <= math.floor(v) < rows and 0 <= math.floor(u) < cols
        return int(classes[math.floor(v), math.floor(u)]) if inside else UNKNOWN

    for row, col in np.ndindex(*turned.shape):
        px, py = (frame.centres(np.array([row * frame.cols + col]))[0] - (x, 2.0)) / 0.1
        u, v = math.cos(yaw) * px + math.sin(yaw) * py, math.cos(yaw) * py - math.sin(yaw) * px
        near = [at(u + a, v + b) for a, b in ((0.25, 0.25), (0.25, -0.25), (-0.25, 0.25), (-0.25, -0.25))]
        edges = [abs((w + d) % 1 - 0.5) for w in (u, v) for d in (0, 0.25, -0.25)]
        if quarter or max(edges) > 0.5 - 1e-6:  # moved as it is; or rounding decides
            continue
        assert turned[row, col] == (OCCUPIED if OCCUPIED in near else at(u, v))


@given(classes=CLASSES, yaw=st.floats(-math.pi, math.pi))
@settings(max_examples=60)
def test_the_grid_holds_every_corner_and_no_cell_more_than_it_must(classes: np.ndarray, yaw: float) -> None:
    frame, _ = upright(classes, 0.5, (1.0, 2.0, yaw))
    rows, cols = classes.shape
    corners = [(u * 0.5, v * 0.5) for u in (0, cols) for v in (0, rows)]
    x = [1.0 + math.cos(yaw) * u - math.sin(yaw) * v for u, v in corners]
    y = [2.0 + math.sin(yaw) * u + math.cos(yaw) * v for u, v in corners]
    x_min, x_max, y_min, y_max = frame.extent
    assert -0.26 < min(x) - x_min < 0.26
    assert -0.26 < min(y) - y_min < 0.26
    assert -0.26 < x_max - max(x) < 0.51
    assert -0.26 < y_max - max(y) < 0.51


@pytest.mark.parametrize("degrees", [1, 10, 30, 45, 61, 89, 123, 200, 315])
def test_walls_of_one_cell_stay_closed_to_who_cuts_no_corner(degrees: float) -> None:
    classes = np.full((40, 60), FREE, np.uint8)
    classes[10:30, 15:45] = OCCUPIED
    classes[11:29, 16:44] = FREE
    frame, turned = upright(classes, 0.1, (0.0, 0.0, math.radians(degrees)))
    room = turned == FREE
    reached = np.zeros_like(room)
    before = GridFrame(0.1, 40, 60)
    reached[frame.cell(*in_the_map(before, 20, 30, math.radians(degrees)))] = True
    while True:
        spread = reached.copy()
        spread[1:] |= reached[:-1]
        spread[:-1] |= reached[1:]
        spread[:, 1:] |= reached[:, :-1]
        spread[:, :-1] |= reached[:, 1:]
        spread &= room
        if (spread == reached).all():
            break
        reached = spread
    assert 0.8 * 18 * 28 < reached.sum() < 18 * 28

"""Areas hold the cells whose centre is in the polygon, as matplotlib finds them."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from matplotlib.path import Path

from vedette.errors import InputError
from vedette.maps import FREE, OCCUPIED, GridFrame
from vedette.maps.area import Area

seeds = st.integers(0, 2**32 - 1)


def star(rng: np.random.Generator) -> list[tuple[float, float]]:
    """A polygon that does not cross itself, neither convex nor aligned with anything."""
    angles = np.sort(rng.uniform(0.0, 2 * np.pi, int(rng.integers(3, 12))))
    reach = rng.uniform(0.5, 6.0, len(angles))
    return [
        (float(r * np.cos(a) - 1.0), float(r * np.sin(a) + 2.0)) for a, r in zip(angles, reach, strict=True)
    ]


@settings(deadline=None, max_examples=80)
@given(seeds)
def test_the_cells_of_an_area_are_those_that_matplotlib_finds_inside_the_polygon(seed: int) -> None:
    rng = np.random.default_rng(seed)
    corners = star(rng)
    frame = GridFrame(float(rng.uniform(0.05, 0.5)), 30, 40, *rng.uniform(-6.0, 2.0, 2).tolist())
    inside = Path(corners).contains_points(frame.centres(np.arange(frame.size))).reshape(frame.shape)
    for ordered in (corners, corners[::-1], [*corners[2:], *corners[:2]]):
        np.testing.assert_array_equal(Area.of(ordered).holds(frame), inside)


def test_a_rectangle_holds_just_the_cells_between_its_sides() -> None:
    frame = GridFrame(0.1, 40, 60, -1.0, -2.0)
    inside = Area.of([(0.0, -1.0), (3.0, -1.0), (3.0, 1.0), (0.0, 1.0)]).holds(frame)
    expected = np.zeros(frame.shape, np.bool_)
    expected[10:30, 10:40] = True
    np.testing.assert_array_equal(inside, expected)


def test_ground_beside_the_area_is_closed_and_ground_in_it_stays_as_it_is() -> None:
    frame = GridFrame(1.0, 3, 4)
    classes = np.full(frame.shape, FREE, np.uint8)
    closed = Area.of([(1.0, 0.0), (3.0, 0.0), (3.0, 3.0), (1.0, 3.0)]).close(classes, frame)
    assert closed.tolist() == [[OCCUPIED, FREE, FREE, OCCUPIED]] * 3


@pytest.mark.parametrize(
    ("corners", "told"),
    [
        ([(0, 0), (1, 0)], "2 corners"),
        ([(0, 0), (1, 0), (2, 0)], "on a line"),
        ([(0, 0), (1, 0), (1, float("nan"))], r"corner \[1, nan\]"),
        ([(0, 0), (1, 0), (1, 1e9)], "within 2"),
    ],
)
def test_what_is_no_polygon_is_refused_in_one_line(corners: list[tuple[float, float]], told: str) -> None:
    with pytest.raises(InputError, match=told):
        Area.of(corners)

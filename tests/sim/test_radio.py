"""Simulated radio: its law against hand-computed margins, walls against a fine walk along each segment."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from vedette.errors import InputError
from vedette.sim.radio import EDGE_LOSS, WALL_DB, Radio, packet_loss, parse_radio, walls_between
from vedette.sim.worlds import office

RESOLUTION = 0.1


def room(rows: int = 20, cols: int = 60) -> NDArray[np.bool_]:
    return np.zeros((rows, cols), dtype=bool)


def loss(solid: NDArray[np.bool_], radio: Radio, *positions: tuple[float, float]) -> float:
    return float(radio.quality(solid, RESOLUTION, np.array(positions))[0, 1])


def runs(solid: NDArray[np.bool_], start: NDArray[np.float64], end: NDArray[np.float64]) -> int:
    """Return the solid runs of a segment: its way in each solid cell by itself, joined where they meet."""
    ways = [_way_in(row, col, start, end - start) for row, col in np.argwhere(solid)]
    count, until = 0, -1.0
    for enters, leaves in sorted(way for way in ways if way[1] - way[0] > 1e-9):
        count += enters > until + 1e-9
        until = max(until, leaves)
    return count


def _way_in(row: int, col: int, start: NDArray[np.float64], step: NDArray[np.float64]) -> tuple[float, float]:
    sides = np.sort((np.array([[col, row], [col + 1, row + 1]]) - start) / step, axis=0)
    return max(0.0, *sides[0].tolist()), min(1.0, *sides[1].tolist())


def runs_by_walking(solid: NDArray[np.bool_], start: NDArray[np.float64], end: NDArray[np.float64]) -> int:
    """Return the solid runs that tiny even steps stand on."""
    share = np.linspace(0.0, 1.0, 200 * math.ceil(1 + math.dist(start, end)))[:, None]
    x, y = (start + share * (end - start)).astype(int).T
    return int((np.diff(solid[y, x].astype(int), prepend=0) > 0).sum())


@settings(deadline=None, max_examples=60)
@given(st.integers(0, 2**32 - 1))
def test_walls_are_the_solid_runs_by_geometry_of_each_cell(seed: int) -> None:
    rng = np.random.default_rng(seed)
    solid = rng.random((7, 11)) < 0.4
    start, end = rng.uniform(0, (11, 7), (5, 2)), rng.uniform(0, (11, 7), (5, 2))
    expected = [runs(solid, a, b) for a, b in zip(start, end, strict=True)]
    assert walls_between(solid, start, end).tolist() == expected


def test_walls_of_an_office_are_those_of_a_fine_walk() -> None:
    world = office(np.random.default_rng(4))
    free = np.argwhere(~world.solid)[:, ::-1]
    rng = np.random.default_rng(5)
    start, end = (free[rng.integers(len(free), size=40)] + rng.uniform(0.1, 0.9, (40, 2)) for _ in range(2))
    walls = walls_between(world.solid, start, end)
    expected = [runs_by_walking(world.solid, a, b) for a, b in zip(start, end, strict=True)]
    agree = np.array(expected) == walls
    assert walls.max() >= 5
    assert agree.mean() >= 0.9  # the walk steps over the smallest corners
    assert np.abs(walls - expected).max() <= 1


def test_a_wall_crossed_obliquely_counts_once_however_long_the_way_in_it() -> None:
    solid = room()
    solid[8:12] = True
    oblique = walls_between(solid, np.array([[1.5, 1.2]]), np.array([[58.3, 18.7]]))
    solid[:] = False
    solid[np.arange(20), np.arange(20) + 20] = solid[np.arange(20), np.arange(20) + 21] = True
    stairs = walls_between(solid, np.array([[1.5, 1.2]]), np.array([[58.3, 18.7]]))
    assert (oblique.tolist(), stairs.tolist()) == ([1], [1])


def test_two_walls_count_twice_and_robots_side_by_side_have_none() -> None:
    solid = room()
    solid[:, 20] = solid[:, 30:33] = True
    walls = walls_between(solid, np.full((3, 2), 10.5), np.array([[50.5, 10.5], [25.5, 3.5], [10.5, 15.5]]))
    assert walls.tolist() == [2, 1, 0]


def test_a_diagonal_through_corners_counts_the_cells_it_crosses_and_no_others() -> None:
    solid = room()
    solid[[5, 6], [5, 6]] = True  # on the diagonal
    solid[[9, 10], [10, 9]] = True  # beside it, touched at a corner
    walls = walls_between(solid, np.array([[2.5, 2.5], [12.5, 12.5]]), np.array([[12.5, 12.5], [2.5, 2.5]]))
    assert walls.tolist() == [1, 1]


def test_the_margin_is_the_distance_law_less_the_walls() -> None:
    radio = Radio(12.0, 3.0)
    margin = radio.margin(np.array([12.0, 6.0, 1.2, 6.0]), np.array([0, 0, 0, 2]))
    np.testing.assert_allclose(margin, [0.0, 20 * math.log10(2), 20.0, 20 * math.log10(2) - 6.0], atol=1e-12)


def test_loss_rises_smoothly_from_nothing_at_six_decibels_to_a_half_at_the_edge() -> None:
    margin = np.linspace(0.0, 6.0, 601)
    loss_at = packet_loss(margin)
    assert (loss_at[0], loss_at[-1]) == (EDGE_LOSS, 0.0)
    assert (np.diff(loss_at) < 0).all()
    assert np.abs(np.diff(loss_at)).max() < 0.002
    assert packet_loss(np.array([-1e-9, 7.0, math.inf])).tolist() == [1.0, 0.0, 0.0]


@settings(deadline=None, max_examples=30)
@given(st.integers(0, 2**32 - 1), st.floats(0.5, 5.0), st.floats(0.0, 20.0))
def test_links_follow_the_law_are_symmetric_and_never_beyond_range(
    seed: int, reach: float, wall_db: float
) -> None:
    rng = np.random.default_rng(seed)
    solid = rng.random((25, 40)) < 0.1
    positions = rng.uniform(0, (4.0, 2.5), (6, 2))
    radio = Radio(reach, wall_db)
    quality = radio.quality(solid, RESOLUTION, positions)
    np.testing.assert_array_equal(quality, quality.T)
    assert (np.diag(quality) == 1.0).all()
    for i, k in zip(*np.triu_indices(6, 1), strict=True):
        distance = math.dist(positions[i], positions[k])
        walls = int(walls_between(solid, positions[[i]] * 10, positions[[k]] * 10)[0])
        margin = 20 * math.log10(reach / distance) - wall_db * walls
        expected = 1.0 if margin < 0 else EDGE_LOSS * max(0.0, 1 - margin / 6) ** 2
        assert quality[i, k] == pytest.approx(expected, abs=1e-9)
        assert quality[i, k] == 1.0 or distance <= reach


def test_a_wall_shortens_a_link_by_its_decibels() -> None:
    solid = room(20, 200)
    solid[:, 5] = True
    radio = Radio(12.0, 6.0)
    reach = 12.0 * 10 ** (-6.0 / 20)
    assert loss(solid, radio, (0.25, 1.0), (0.25 + reach - 0.01, 1.0)) == pytest.approx(EDGE_LOSS, abs=0.01)
    assert loss(solid, radio, (0.25, 1.0), (0.25 + reach + 0.01, 1.0)) == 1.0
    assert loss(room(20, 200), radio, (0.25, 1.0), (0.25 + reach, 1.0)) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("count", [0, 1])
def test_a_team_of_one_or_none_has_no_links(count: int) -> None:
    quality = Radio(5.0).quality(room(), RESOLUTION, np.full((count, 2), 0.5))
    np.testing.assert_array_equal(quality, np.ones((count, count)))


def test_robots_in_the_same_place_hear_each_other() -> None:
    assert loss(room(), Radio(5.0), (1.0, 1.0), (1.0, 1.0)) == 0.0


def test_an_option_is_a_range_and_perhaps_the_loss_of_a_wall() -> None:
    assert parse_radio("12,3") == Radio(12.0, 3.0)
    assert parse_radio(" 7.5 , 0") == Radio(7.5, 0.0)
    assert parse_radio("12") == Radio(12.0, WALL_DB)


FORM = "--radio must be range in m[,dB lost a wall], such as 12 or 12,3.4; got "
MISTAKES = {
    "": FORM + "''",
    "far": FORM + "'far'",
    "12,": FORM + "'12,'",
    "12,3,4": FORM + "'12,3,4'",
    "-3": FORM + "'-3'",
    "nan": FORM + "'nan'",
    "0": "--radio 0: the range of a radio must be 0.1 to 10000 m; got 0",
    "1" + "0" * 400: f"--radio 1{'0' * 400}: the range of a radio must be 0.1 to 10000 m; got inf",
    "9,201": "--radio 9,201: what a radio loses in a wall must be 0 to 200 dB; got 201",
}


@pytest.mark.parametrize("text", MISTAKES)
def test_a_bad_option_is_told_in_one_line(text: str) -> None:
    with pytest.raises(InputError) as caught:
        parse_radio(text)
    assert str(caught.value) == MISTAKES[text]

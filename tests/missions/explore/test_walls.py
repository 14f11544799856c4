"""Walls drawn askew from robots' maps: their gaps are sealed as their makers have them, and openings stay."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from tests.support.mapping_scenes import CORRIDOR, FRAME, explored
from vedette.align.pose import FramePose
from vedette.align.turned import turned
from vedette.fusion.framed import Maker
from vedette.fusion.shared import SharedTiles
from vedette.fusion.tiles import codes_of
from vedette.kernels.frontier import find_frontiers
from vedette.kernels.tiles import TiledGrid
from vedette.maps import FREE, OCCUPIED, UNKNOWN, GridFrame
from vedette.maps.transform import Transform
from vedette.missions.explore.frames.walls import closed, sealed

ROOMS = [*CORRIDOR, (7.0, 7.1), (0.0, 4.0), (4.0, 4.0), (0.0, 10.0)]
ONTO = GridFrame(0.1, 260, 260, -10.0, -6.0)  # holds the building however it is turned about its middle
THERE = Transform(0, 0, 5000)  # 27 degrees


def maker(classes: NDArray[np.uint8]) -> Maker:
    log_odds = np.choose(classes, (0, -20, 20)).astype(np.int8)
    grid, tiles = TiledGrid.of(codes_of(log_odds)), SharedTiles(np.uint8)
    tiles.write(grid.held, grid.read(grid.held))
    return Maker(THERE, tiles)


def seen_askew(classes: NDArray[np.uint8], holes: float = 0.0) -> NDArray[np.uint8]:
    """Return a map as it is drawn in another frame, a share of its wall lost to others who saw beside it."""
    back = FramePose(0.0, 0.0, THERE.radians).inverse()
    drawn = turned(classes, FRAME, back, ONTO)
    lost = np.random.default_rng(3).random(drawn.shape) < holes
    return np.where((drawn == OCCUPIED) & lost, np.uint8(FREE), drawn)


def frontiers(classes: NDArray[np.uint8], least: int = 1) -> list[NDArray[np.int64]]:
    cells, starts = find_frontiers(classes, least, 1000)
    return np.split(cells, starts[1:-1])


@pytest.mark.parametrize("holes", [0.05, 0.2])
def test_gaps_of_a_wall_are_sealed_that_closing_the_drawn_one_leaves_open_and_no_opening_is(
    holes: float,
) -> None:
    classes = explored(ROOMS)
    drawn = closed(seen_askew(classes, holes))
    shut = sealed(drawn, ONTO, FRAME, [maker(classes)])
    at = THERE.places(FRAME.centres(np.concatenate(frontiers(closed(classes)))))

    def seams(of: NDArray[np.uint8]) -> list[NDArray[np.int64]]:
        """Return the frontiers that the maker does not have, in whose map the wall is whole."""
        away = [np.hypot(*(ONTO.centres(cells)[:, None] - at).transpose(2, 0, 1)) for cells in frontiers(of)]
        return [each for each in away if each.min() > 0.25]

    assert len(seams(drawn)) > 1
    assert not seams(shut)
    for opening in frontiers(closed(classes), 4):
        places = THERE.places(FRAME.centres(opening))
        left = ONTO.centres(np.concatenate(frontiers(shut)))
        assert np.hypot(*(left[:, None] - places).transpose(2, 0, 1)).min(axis=0).max() < 0.35


def test_what_is_sealed_is_what_lies_beside_a_wall_of_anybody_who_made_the_map() -> None:
    classes = explored(ROOMS)
    drawn = seen_askew(classes, 0.1)
    shut = sealed(drawn, ONTO, FRAME, [maker(classes)])
    for row, col in np.argwhere(drawn == UNKNOWN):
        around = drawn[max(row - 1, 0) : row + 2, col], drawn[row, max(col - 1, 0) : col + 2]
        meets = any(FREE in cells for cells in around)
        (x, y) = THERE.inverse().place(*ONTO.centres(np.array([row * ONTO.cols + col]))[0])
        i, j = FRAME.cell(x, y)
        walls = classes[max(i - 1, 0) : max(i + 2, 0), max(j - 1, 0) : max(j + 2, 0)] == OCCUPIED
        assert (shut[row, col] == OCCUPIED) == (meets and bool(walls.any()))
    assert np.array_equal(shut[drawn != UNKNOWN], drawn[drawn != UNKNOWN])


def test_a_map_that_nobody_made_stays_as_it_is() -> None:
    drawn = seen_askew(explored(ROOMS), 0.1)
    assert np.array_equal(sealed(drawn, ONTO, FRAME, []), drawn)

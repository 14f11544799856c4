"""What closes a way by mistake is doubted in the end, and what does close it is found to."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.support.small_missions import robots, run, two_rooms
from vedette.maps import FREE, OCCUPIED, UNKNOWN, GridFrame
from vedette.missions.explore.doubts import SETTLED, SURE, Doubts, jutting_out
from vedette.outcome import Outcome
from vedette.sim.explore.run import explore, prepare
from vedette.sim.explore.simulation import ExploreSetup
from vedette.team import PlatformSpec


@given(st.integers(0, 2**32 - 1))
def test_a_cell_juts_out_iff_it_lies_between_no_two_others(seed: int) -> None:
    occupied = np.random.default_rng(seed).random((7, 9)) < 0.4
    cells = {(int(row), int(col)) for row, col in np.argwhere(occupied)}
    directions = [(-1, -1), (-1, 0), (-1, 1), (0, -1), (0, 1), (1, -1), (1, 0), (1, 1)]
    for row, col in np.ndindex(occupied.shape):
        between = any({(row + u, col + v), (row - u, col - v)} <= cells for u, v in directions)
        assert jutting_out(occupied)[row, col] == ((row, col) in cells and not between)


def test_doubtful_is_what_the_robot_has_seldom_seen_itself_or_juts_out_until_it_could_not_get_on() -> None:
    classes = np.full((20, 40), FREE, np.uint8)
    classes[10, 1:-1] = OCCUPIED  # a wall, seen so often that it stands
    classes[11, 20] = OCCUPIED  # on its face
    classes[0, 0] = UNKNOWN
    own = np.where(classes == OCCUPIED, SURE, -SURE).astype(np.int8)
    own[10, 5:8] = SURE - 1  # seldom
    own[10, 30:33] = 0  # by mates alone
    frame = GridFrame(0.1, 20, 40, origin_x=-1.0)
    doubts = Doubts(0.2)
    ends = {(10, 1), (10, 38)}
    bump = {(11, 20)}
    assert marked(doubts.about(classes, own, frame)) == {(10, 5), (10, 6), (10, 7)} | ends | bump
    doubts.settle(-1.0 + 2.05, 1.15)
    assert marked(doubts.about(classes, own, frame)) == {(10, 5), (10, 6), (10, 7)} | ends
    doubts.settle(-1.0 + 0.65 + 0.2 + SETTLED, 1.05)
    assert marked(doubts.about(classes, own, frame)) == {(10, 5)} | ends


def marked(mask: np.ndarray) -> set[tuple[int, int]]:
    """The cells of a mask."""
    return {(int(row), int(col)) for row, col in np.argwhere(mask)}


@pytest.mark.parametrize(
    ("resolution", "width", "n", "view", "seed"),
    [(0.03, 0.45, 1, 360, 1), (0.05, 0.45, 3, 360, 2), (0.07, 0.49, 3, 360, 2), (0.1, 0.5, 1, 90, 2)],
)
def test_a_way_that_noise_has_closed_is_driven_through(
    resolution: float, width: float, n: int, view: float, seed: int
) -> None:
    specs = robots(n, view=float(view), beams=64 if view < 360 else 360)
    specs[0] = PlatformSpec(
        name=specs[0].name, view=specs[0].view, beams=specs[0].beams, start=(1.0, 1.0 + 0.3 * seed)
    )
    _, report = run(two_rooms(width, resolution, bent=True), specs, seed=seed)
    assert report.summary.outcome is Outcome.COMPLETE
    assert report.summary.coverage >= 0.99
    assert report.summary.collisions == 0


def test_who_has_often_doubted_in_vain_doubts_no_more() -> None:
    specs = [PlatformSpec(start=(1.0, 1.3))]
    setup = ExploreSetup(seed=1, max_time=900.0)
    simulation = prepare(two_rooms(0.45, 0.03, bent=True), specs, setup)  # driven through above
    simulation.missions[0].platform.in_vain = 10
    report = explore(simulation)
    assert report.summary.coverage < 0.7
    assert "out_of_reach" in {spot.why for spot in report.summary.left_out}


def test_a_way_that_a_post_closes_is_tried_once() -> None:
    world = two_rooms(0.6, 0.05)
    row, col = np.array(world.solid.shape) // 2
    world.solid[row, col] = True
    simulation, report = run(world, [PlatformSpec(start=(1.0, 1.0))], seed=1)
    assert simulation.missions[0].platform.in_vain == 1
    assert report.summary.outcome is Outcome.COMPLETE
    assert "out_of_reach" in {spot.why for spot in report.summary.left_out}
    assert report.summary.collisions == 0
    assert report.summary.time_s < 60.0

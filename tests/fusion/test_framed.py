"""Evidence in its maker's frame: shown is the sum of what lies under each cell, and a join is undone."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from vedette.fusion.frame_edges import FrameEdge, packed, room_for, unpacked
from vedette.fusion.framed import FramedEvidence
from vedette.fusion.link import Key
from vedette.fusion.tiles import LEVELS, codes_of
from vedette.kernels.tiles import SIDE, TiledGrid
from vedette.maps import FREE, OCCUPIED, UNKNOWN, GridFrame
from vedette.maps.transform import IDENTITY, TURN, Transform

COUNTS, ROBOTS, ROWS, COLS = 3, 3, 4 * SIDE, 5 * SIDE
FRAME = GridFrame(0.1, ROWS, COLS, -0.1 * (COLS // 2), -0.1 * (ROWS // 2))
KEYS: list[Key] = [(index, 7 + index) for index in range(ROBOTS)]

Logs = NDArray[np.int8]


def team() -> list[FramedEvidence]:
    """Return robots that all have links to all."""
    made = [FramedEvidence(*key, FRAME, COUNTS, ROBOTS) for key in KEYS]
    for index, one in enumerate(made):
        one.set_neighbours([other for other in range(ROBOTS) if other != index])
    return made


def seen(seed: int) -> Logs:
    """Return the log-odds of one robot, a few tiles of them."""
    rng = np.random.default_rng(seed)
    grid = np.zeros((ROWS, COLS), np.int8)
    top, left = rng.integers(0, (ROWS - 40, COLS - 40))
    grid[top : top + 40, left : left + 40] = rng.integers(-20, 21, (40, 40))
    return grid


def counts_with(edges: list[FrameEdge]) -> NDArray[np.int64]:
    return np.concatenate((np.arange(COUNTS), packed(edges, room_for(ROBOTS))))


def publish(one: FramedEvidence, grid: Logs, edges: list[FrameEdge] | None = None) -> None:
    one.publish(TiledGrid.of(grid), None, None if edges is None else counts_with(edges))


def talk(made: list[FramedEvidence], rng: np.random.Generator, loss: float = 0.0) -> None:
    """Let all tell all for a while, in any order; some of it is lost, and some said twice."""
    for second in range(12):
        lost = loss if second < 8 else 0.0
        for sender in rng.permutation(ROBOTS).tolist():
            for to in rng.permutation([k for k in range(ROBOTS) if k != sender]).tolist():
                payload = made[sender].outgoing(to, 3.0 * second)
                for _ in range(int(rng.integers(1, 3))):
                    if payload is not None and rng.random() >= lost:
                        made[to].receive(sender, payload, 3.0 * second)


def under(grid: Logs, there: Transform) -> NDArray[np.int64]:
    """Return the level that a grid has under each cell of another frame, cell by cell."""
    levels = LEVELS[codes_of(grid)]
    out = np.zeros((ROWS, COLS), np.int64)
    cos, sin = there.cosine
    for row in range(ROWS):
        for col in range(COLS):
            x = 50 * (2 * col + 1 - COLS) - there.x  # [mm]
            y = 50 * (2 * row + 1 - ROWS) - there.y
            u, v = (cos * x + sin * y) >> 24, (cos * y - sin * x) >> 24
            r, c = v // 100 + ROWS // 2, u // 100 + COLS // 2
            if 0 <= r < ROWS and 0 <= c < COLS:
                out[row, col] = levels[r, c]
    return out


def classes(grids: Mapping[Key, Logs], frames: Mapping[Key, Transform]) -> NDArray[np.uint8]:
    """Return the map that so many robots' evidence makes, by adding it up cell by cell."""
    laid = np.stack([under(grids[key], there) for key, there in frames.items()])
    told = (laid != 0).any(axis=0)
    return np.where(~told, UNKNOWN, np.where(laid.sum(axis=0) < 0, FREE, OCCUPIED)).astype(np.uint8)


SOMEWHERE = st.builds(Transform, st.integers(-3000, 3000), st.integers(-3000, 3000), st.integers(0, TURN - 1))


@settings(deadline=None, max_examples=8)
@given(seed=st.integers(0, 2**32 - 1), first=SOMEWHERE, second=SOMEWHERE)
def test_over_any_links_all_draw_one_plane_the_sum_of_what_lies_under_each_cell(
    seed: int, first: Transform, second: Transform
) -> None:
    rng, made = np.random.default_rng(seed), team()
    grids = {key: seen(seed + index) for index, key in enumerate(KEYS)}
    frames = dict(zip(KEYS, (IDENTITY, first, second), strict=True))
    made[1].place_plane(frames)  # one is told where they lie before, the others after
    for one, grid in zip(made, grids.values(), strict=True):
        publish(one, -grid)
    talk(made, rng, loss=0.4)
    for one, grid in zip(made, grids.values(), strict=True):
        publish(one, grid)
    talk(made, rng, loss=0.4)
    for one in (made[0], made[2]):
        one.place_plane(frames)
    assert len({one.digest for one in made}) == 1
    for one in made:
        assert np.array_equal(one.plane.classes.window(), classes(grids, frames))


def test_a_join_that_is_undone_leaves_what_there_was_before() -> None:
    made = team()
    grids = {key: seen(index) for index, key in enumerate(KEYS)}
    for one, grid in zip(made, grids.values(), strict=True):
        publish(one, grid)
    talk(made, np.random.default_rng(0))
    one, right = made[0], Transform(1200, -300, 9000)
    one.place_own({KEYS[1]: right})
    before = one.classes.window()
    assert np.array_equal(before, classes(grids, {KEYS[0]: IDENTITY, KEYS[1]: right}))
    one.place_own({KEYS[1]: right, KEYS[2]: Transform(-800, 500, 30000)})
    assert not np.array_equal(one.classes.window(), before)
    one.place_own({KEYS[1]: right})
    assert np.array_equal(one.classes.window(), before)
    one.place_own({})
    assert np.array_equal(one.classes.window(), classes(grids, {KEYS[0]: IDENTITY}))
    for two in made[1:]:  # and nobody has lost anything
        assert two.copies.keys() == one.copies.keys()
        assert all(two.copies[key].version == copy.version for key, copy in one.copies.items())


def test_where_nobody_is_placed_each_sees_its_own_map_and_planes_of_equal_frames_are_equal() -> None:
    made = team()
    for index, one in enumerate(made):
        publish(one, seen(index))
    talk(made, np.random.default_rng(1))
    for index, one in enumerate(made):
        own = classes({KEYS[index]: seen(index)}, {KEYS[index]: IDENTITY})
        assert np.array_equal(one.classes.window(), own)
        one.place_plane({KEYS[0]: IDENTITY})
    assert len({one.digest for one in made}) == 1
    made[2].place_plane({KEYS[0]: Transform(1, 0, 0)})
    assert made[2].digest != made[1].digest


def test_edges_reach_everybody_with_the_counts_and_the_last_word_of_each_stands() -> None:
    made = team()
    early = FrameEdge(KEYS[0], KEYS[1], Transform(10, -20, 300), 2500)
    late = FrameEdge(KEYS[0], KEYS[1], Transform(11, -21, 301), 3500)
    other = FrameEdge(KEYS[1], KEYS[2], Transform(-7, 5, 65535), 1)
    publish(made[0], seen(0), [early])
    publish(made[1], seen(1), [other])
    talk(made, np.random.default_rng(2), loss=0.3)
    assert all(one.edges == sorted([early, other]) for one in made)
    publish(made[0], seen(0), [late])
    talk(made, np.random.default_rng(3), loss=0.3)
    assert all(one.edges == sorted([late, other]) for one in made)
    publish(made[1], seen(1), [])
    talk(made, np.random.default_rng(4))
    assert all(one.edges == [late] for one in made)


def test_the_heaviest_edges_are_told_where_there_is_no_room_for_all() -> None:
    edges = [FrameEdge(KEYS[0], (1, boot), Transform(boot, 0, 0), 100 * boot) for boot in range(9)]
    assert unpacked(packed(edges, room_for(ROBOTS))) == edges[-4:]


@pytest.mark.parametrize(
    ("place", "number"),
    [(0, 0), (0, -1), (1, -1), (1, 1 << 54), (2, -1), (3, 1 << 31), (4, -(1 << 31)), (5, -1), (5, TURN)],
)
def test_numbers_that_are_no_edge_are_left_out(place: int, number: int) -> None:
    numbers = packed([FrameEdge(KEYS[0], KEYS[1], Transform(1, 2, 3), 4)], room_for(ROBOTS))
    assert len(unpacked(numbers)) == 1
    numbers[place] = number
    assert unpacked(numbers) == []

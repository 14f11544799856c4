"""Who is believed: liars are not, and a world that changes, or a map that corrects itself, is no lie."""

from __future__ import annotations

import itertools
from functools import partial
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from tests.support.notaries import PlainNotary
from vedette.fusion.particulars import Capabilities
from vedette.fusion.signed import SignedEvidence
from vedette.fusion.trust import liars
from vedette.kernels.tiles import TiledGrid

SHAPE = (90, 120)  # of cells of 10 cm
LIMITS = Capabilities(0.1, 20.0, 1.0)
WALL, OPEN = 20, -20
Grid = NDArray[np.int8]


class Team:
    """Robots that all hear what any of them publishes, at a time that the test sets [s]."""

    def __init__(self, robots: int, ahead: tuple[float, ...] = ()) -> None:
        """``ahead``: by how much clocks of the first ones are [s]."""
        self.now = 10_000.0
        clocks = [partial(self._clock, sum(ahead[i : i + 1])) for i in range(robots)]
        self.fusions = [
            SignedEvidence(i, 1, SHAPE, 1, notary=PlainNotary(i, clock), limits=LIMITS)
            for i, clock in enumerate(clocks)
        ]
        self._sent = 0.0
        for i, fusion in enumerate(self.fusions):
            fusion.set_out(45, 60)
            fusion.set_neighbours([k for k in range(robots) if k != i])

    def _clock(self, ahead: float) -> float:
        return self.now + ahead

    def sees(self, robot: int, grid: Grid) -> None:
        """Let a robot publish what it has seen by now."""
        self.fusions[robot].publish(TiledGrid.of(grid), None, None)

    def tell(self) -> frozenset[int]:
        """Let everybody hear everything; return whom nobody believes, and check that all agree on that."""
        for _ in range(4):
            self._sent += 3.0
            for a, b in itertools.permutations(range(len(self.fusions)), 2):
                payload = self.fusions[a].outgoing(b, self._sent)
                if payload is not None:
                    self.fusions[b].receive(a, payload, self._sent)
        (out,) = {fusion.out for fusion in self.fusions}
        assert len({fusion.digest for fusion in self.fusions}) == 1
        return out

    def stands(self, grids: list[Grid], seconds: float) -> frozenset[int]:
        """Let time pass in which everybody restates what it says."""
        everybody = frozenset[int]()
        for k in range(int(seconds)):
            self.now += 1.0
            for i, grid in enumerate(grids):
                self.fusions[i].publish(TiledGrid.of(grid), None, np.array([k]))
            everybody |= self.tell()
        return everybody


def hall() -> Grid:
    """Two rooms of 5.5 x 8.5 m with a door of 1 m between them, seen whole."""
    grid = np.full(SHAPE, OPEN, np.int8)
    for edge in (grid[:2], grid[-2:], grid[:, :2].T, grid[:, -2:].T, grid[:, 59:61].T):
        edge[...] = WALL
    grid[40:50, 59:61] = OPEN
    return grid


def with_block(grid: Grid, rows: slice, cols: slice) -> Grid:
    """Return it with a body in it, of which only the rim is seen."""
    new = grid.copy()
    new[rows, cols] = WALL
    new[rows.start + 1 : rows.stop - 1, cols.start + 1 : cols.stop - 1] = 0
    return new


def shifted(grid: Grid, rows: int, cols: int) -> Grid:
    return np.roll(grid, (rows, cols), (0, 1))


@pytest.mark.parametrize("lie", [WALL, OPEN])
def test_who_calls_everything_free_or_occupied_is_out_for_everybody(lie: int) -> None:
    team, truth = Team(3), hall()
    grids = [truth, np.full(SHAPE, lie, np.int8), truth]
    team.stands(grids, 12.0)
    assert team.tell() == {1}
    assert team.fusions[0].complaints.keys() == {1}
    shown = team.fusions[0].classes.window()
    assert np.array_equal(shown == 2, truth > 0)
    assert team.fusions[0].contributors() == 3


@pytest.mark.parametrize("lie", [WALL, OPEN])
def test_of_two_nobody_is_out(lie: int) -> None:
    team = Team(2)
    assert team.stands([hall(), np.full(SHAPE, lie, np.int8)], 15.0) == frozenset()


@pytest.mark.parametrize(
    "new",
    [
        pytest.param(lambda grid: with_block(grid, slice(30, 38), slice(20, 32)), id="a pallet"),
        pytest.param(lambda grid: with_block(grid, slice(30, 34), slice(20, 24)), id="a person"),
        pytest.param(lambda grid: with_block(grid, slice(40, 50), slice(59, 61)), id="a door"),
        pytest.param(lambda grid: with_block(grid, slice(20, 45), slice(70, 95)), id="a van"),
    ],
)
def test_a_changed_world_is_no_lie_to_those_who_saw_it_before(new: Any) -> None:
    before, after = hall(), new(hall())
    for grids in ([before, after, after], [after, before, before], [before, after, before]):
        assert Team(3).stands(grids, 15.0) == frozenset()


def test_a_room_that_was_rearranged_minutes_later_is_no_lie() -> None:
    team, before = Team(3), hall()
    after = before.copy()
    for row, col in itertools.product(range(12, 80, 17), range(14, 50, 14)):
        after = with_block(after, slice(row, row + 8), slice(col, col + 8))
    half = before.copy()
    half[:, 61:] = 0
    team.sees(0, half)
    team.now += 180.0
    after[:, 61:] = 0
    team.sees(1, after)
    team.sees(2, after)
    assert team.tell() == frozenset()
    team.now += 20.0
    team.sees(1, before)
    assert team.tell() == frozenset()


@pytest.mark.parametrize("jump", [(0, 12), (9, -9), (25, 0)])
def test_a_map_that_jumps_and_corrects_itself_expels_nobody(jump: tuple[int, int]) -> None:
    team, truth = Team(3), hall()
    assert team.stands([truth] * 3, 30.0) == frozenset()
    assert team.stands([truth, shifted(truth, *jump), truth], 8.0) == frozenset()
    assert team.stands([truth] * 3, 20.0) == frozenset()


def test_a_map_that_stays_wrong_is_left_out_until_it_is_right() -> None:
    team, truth = Team(3), hall()
    team.stands([truth] * 3, 15.0)
    assert team.stands([truth, shifted(truth, 0, 12), truth], 15.0) == {1}
    assert team.stands([truth] * 3, 5.0) == frozenset()


def test_what_is_less_than_the_pose_error_apart_contradicts_nothing() -> None:
    team, truth = Team(3), hall()
    assert team.stands([truth, shifted(truth, 4, 0), shifted(truth, 0, 4)], 15.0) == frozenset()
    assert team.fusions[0].contradictions(1 << 40) == {}


@pytest.mark.parametrize("ahead", [(61.0,), (-61.0,), (3600.0,), (-3600.0,), (3600.0, -3600.0)])
def test_clocks_more_than_a_minute_apart_expel_nobody_and_lose_no_evidence(ahead: tuple[float, ...]) -> None:
    """Also where the world changes meanwhile, which clocks that agree would tell from a lie."""
    team, before = Team(3, ahead), hall()
    after = with_block(before, slice(20, 45), slice(70, 95))
    assert team.stands([before] * 3, 15.0) == frozenset()
    assert team.stands([after, after, before], 15.0) == frozenset()
    assert team.stands([after] * 3, 5.0) == frozenset()
    shown = team.fusions[0].classes.window()
    assert np.array_equal(shown == 2, after > 0)


@pytest.mark.parametrize("ahead", [50.0, -50.0])
def test_a_clock_less_than_a_minute_off_hides_no_liar(ahead: float) -> None:
    """One that is ahead is judged so much later."""
    team, truth = Team(3, (0.0, ahead)), hall()
    team.stands([truth, np.full(SHAPE, OPEN, np.int8), truth], 12.0 + max(ahead, 0.0))
    assert team.tell() == {1}


def test_who_is_revoked_accuses_nobody() -> None:
    team, truth, lie = Team(4), hall(), np.full(SHAPE, OPEN, np.int8)
    for fusion in team.fusions:
        fusion.standing.revoke(frozenset({2, 3}))
        fusion.heed()
    assert team.stands([truth, truth, lie, lie], 15.0) == {2, 3}


def test_whoever_explains_the_most_goes_and_of_equals_nobody() -> None:
    assert liars({}) == frozenset()
    assert liars({(0, 1): 900}) == frozenset()
    assert liars({(0, 1): 50, (1, 2): 50}) == {1}
    assert liars({(0, 1): 50, (1, 2): 50, (0, 2): 900}) == frozenset()
    assert liars({(0, 2): 50, (0, 3): 50, (1, 2): 50, (1, 3): 50}) == frozenset()
    two = {(i, k): 100 for i in (0, 1) for k in (2, 3, 4)}
    assert liars(two) == {0, 1}
    assert liars(two | {(0, 1): 100}) == {0, 1}


def test_those_left_cannot_be_told_apart_and_the_order_of_pairs_does_not_matter() -> None:
    rng = np.random.default_rng(3)
    for _ in range(50):
        pairs = {(a, b): 10 for a, b in itertools.combinations(range(6), 2) if rng.random() < 0.4}
        gone = liars(pairs)
        assert gone == liars(dict(reversed(pairs.items())))
        left = [pair for pair in pairs if not gone & set(pair)]
        counts = {robot: sum(robot in pair for pair in left) for robot in range(6)}
        for robot in range(6):
            fewer = [pair for pair in left if robot in pair and counts[sum(pair) - robot] < counts[robot]]
            most = max(counts.values())
            assert counts[robot] < most or len(fewer) < 2

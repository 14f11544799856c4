"""Signed evidence of robots that share no frame: signed as it is made, judged where it is taken to lie."""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import suppress

import numpy as np
from numpy.typing import NDArray

from tests.support.notaries import certified
from tests.support.small_missions import small_office
from vedette.fusion.frame_edges import FrameEdge, packed, room_for
from vedette.fusion.link import Key
from vedette.fusion.particulars import Capabilities
from vedette.fusion.signed_framed import SignedFramedEvidence
from vedette.kernels.tiles import TiledGrid
from vedette.maps import OCCUPIED, GridFrame
from vedette.maps.transform import IDENTITY, Transform
from vedette.missions.explore.frames.borne_out import PATIENCE
from vedette.missions.explore.frames.shared import SharedFrames

FRAME = GridFrame(0.1, 512, 512, -25.6, -25.6)
LIMITS = Capabilities(0.1, 60.0, 1.0, (-25.6, -25.6))
THERE = (IDENTITY, Transform(600, -400, 0), Transform(-300, 800, 0))  # T_0_k: whole cells
KEYS: list[Key] = [(robot, 5) for robot in range(3)]


class Team:
    """Three robots that map one office, each in a frame of its own, and talk along a chain 0 - 1 - 2."""

    def __init__(self) -> None:
        self.now = 1000.0
        self.all = [
            SignedFramedEvidence(*key, FRAME, 1, 3, notary=certified(key[0], self.clock), limits=LIMITS)
            for key in KEYS
        ]
        for robot, evidence in enumerate(self.all):
            evidence.set_out(256, 256)
            evidence.set_neighbours([k for k in (robot - 1, robot + 1) if 0 <= k < 3])
        self.frames = [SharedFrames(evidence, FRAME, gap=2.0) for evidence in self.all]

    def clock(self) -> float:
        return self.now

    def publish(self, robot: int, grid: NDArray[np.int8], edges: Sequence[FrameEdge] = ()) -> None:
        told = np.concatenate(([0], packed(edges, room_for(3))))
        self.all[robot].publish(TiledGrid.of(moved(grid, robot)), None, told)

    def talk(self, seconds: int = 8) -> None:
        for _ in range(seconds):
            self.now += 1.0
            for one, other in ((0, 1), (1, 0), (1, 2), (2, 1)):
                payload = self.all[one].outgoing(other, self.now)
                if payload is not None:
                    self.all[other].receive(one, payload, self.now)

    def round(self) -> list[bool]:
        """The first is the root of a round; tell who agrees."""
        told = self.frames[0].lay_out()
        return [each.take(told) for each in self.frames]


def office() -> NDArray[np.int8]:
    solid = small_office(seed=1).solid
    grid = np.zeros(FRAME.shape, np.int8)
    grid[210 : 210 + solid.shape[0], 200 : 200 + solid.shape[1]] = np.where(solid, 20, -20)
    return grid


def fresh(grid: NDArray[np.int8], version: int) -> NDArray[np.int8]:
    """Return a grid with something new in each version."""
    grid = grid.copy()
    grid[*np.argwhere(grid < 0)[-1]] = -20 * (version % 2)
    return grid


def moved(grid: NDArray[np.int8], robot: int) -> NDArray[np.int8]:
    """Return a grid of the first one's frame as it lies in another's."""
    return np.roll(grid, (-THERE[robot].y // 100, -THERE[robot].x // 100), axis=(0, 1))


def true_edges(first: int = 0) -> list[FrameEdge]:
    return [FrameEdge(KEYS[0], KEYS[k], THERE[k], 5000) for k in (1, 2) if k > first]


def joined(team: Team, edges: Sequence[FrameEdge]) -> Team:
    for robot in range(3):
        team.publish(robot, office(), edges if robot == 0 else ())
    team.talk()
    assert team.round() == [True] * 3
    return team


def test_evidence_goes_round_signed_as_it_is_made_and_all_who_are_joined_hold_one_plane() -> None:
    team = joined(Team(), true_edges())
    assert len({each.digest for each in team.all}) == 1
    for robot, each in enumerate(team.all):
        assert each.frames.keys() == set(KEYS)
        assert each.out == frozenset()
        held = [each.copies[key] for key in KEYS]
        assert len({copy.root for copy in held}) == 3
        shown = each.classes.window()
        np.testing.assert_array_equal(shown == OCCUPIED, moved(office(), robot) > 0)


def test_what_somebody_has_changed_on_the_way_is_not_its_makers() -> None:
    team = Team()
    team.publish(0, office(), true_edges())
    team.talk(1)
    payload = team.all[1].outgoing(2, team.now + 5.0)
    assert payload is not None
    forged = bytearray(payload)
    forged[len(forged) // 2] ^= 1
    with suppress(ValueError):
        team.all[2].receive(1, bytes(forged), team.now)
    after = team.all[2].copies.get(KEYS[0])
    assert after is None or after.version == 0
    team.talk(12)
    assert team.all[2].copies[KEYS[0]].version == team.all[0].copies[KEYS[0]].version


def test_who_has_filled_what_is_open_to_two_others_is_not_believed_and_is_again_once_it_is_right() -> None:
    team = joined(Team(), true_edges())
    filled = office()
    solid = np.zeros(FRAME.shape, np.bool_)
    solid[215:300, 205:290] = True
    filled[solid & (filled < 0)] = 20
    for lies, out in ((filled, {2}), (office(), set())):
        for version in range(14):
            for robot in range(3):
                grid = fresh(office() if robot < 2 else lies, version)
                team.publish(robot, grid, true_edges() if robot == 0 else ())
            team.talk(2)
            team.round()
        assert [each.out for each in team.all] == [frozenset(out)] * 3
        np.testing.assert_array_equal(team.all[0].classes.window() == OCCUPIED, office() > 0)
        assert team.all[0].frames.keys() == set(KEYS)  # where it lies is known all along
    assert len({each.digest for each in team.all}) == 1


def test_nobody_is_accused_whose_join_was_wrong_and_the_join_is_undone() -> None:
    team = Team()
    wrong = FrameEdge(KEYS[0], KEYS[2], Transform(1100, 800, 0), 9000)  # of another part of the building
    half = office()
    half[:, 260:] = 0
    for robot in range(3):
        grid = half if robot < 2 else office()
        team.publish(robot, grid, [true_edges()[0], wrong] if robot == 0 else ())
    for _ in range(12):
        team.talk(3)
        team.round()
        for robot in range(3):
            team.publish(robot, office(), [true_edges()[0], wrong] if robot == 0 else ())
        assert all(each.out == frozenset() for each in team.all)
    assert all(KEYS[2] not in each.frames for each in team.all[:2])
    assert all(KEYS[1] in each.frames for each in team.all[:1])


def test_who_goes_on_telling_of_false_matches_is_named_and_joins_nobody() -> None:
    team = Team()
    false = [
        FrameEdge(KEYS[0], KEYS[1], Transform(9000, 3000, 20_000), 2**40),
        FrameEdge(KEYS[1], KEYS[2], Transform(-7000, 100, 5_000), 2**40),
    ]
    for version in range(PATIENCE + 20):
        for robot in range(3):
            edges = false if robot == 2 else true_edges()[:1]
            team.publish(robot, fresh(office(), version), edges)
        team.talk(2)
        team.round()
    for each in team.all[:2]:
        assert each.misleading == {2}
        assert list(each.complaints) == [2]
        assert "it tells that maps fit where they do not" in each.complaints[2]
        assert each.frames.keys() == set(KEYS[:2])
        assert each.out == frozenset()
    assert team.all[2].misleading == frozenset()


def test_a_match_lies_where_walls_pull_it_and_weighs_no_more_than_they_whatever_is_told_of_it() -> None:
    team = Team()
    bent = FrameEdge(KEYS[0], KEYS[1], THERE[1]._replace(x=THERE[1].x + 150), 2**50)
    true = [
        FrameEdge(KEYS[0], KEYS[2], THERE[2], 9000),
        FrameEdge(KEYS[1], KEYS[2], THERE[1].inverse().after(THERE[2]), 9000),
    ]
    for robot in range(3):
        team.publish(robot, office(), [bent] if robot == 2 else true)
    team.talk()
    team.frames[0].solve()
    shift, turn = team.frames[0].graph[KEYS[1]].there.apart(THERE[1], 0.0, 0.0)
    assert shift < 0.01
    assert turn < math.radians(0.05)


def test_notes_of_those_who_are_joined_are_moved_and_those_of_others_mean_nothing() -> None:
    team = Team()
    for robot in range(3):
        team.all[robot].tell([(100, 200, 7)])
        team.publish(robot, office(), true_edges()[:1])
    team.talk()
    team.frames[0].solve()
    told = team.all[0].notes()
    assert {robot: {note[:3] for note in notes} for robot, notes in told.items()} == {
        0: {(100, 200, 7)},
        1: {(160, 160, 7)},
    }


def test_of_whom_is_convicted_neither_map_nor_edges_count_and_an_operators_word_hides_a_map() -> None:
    team = joined(Team(), true_edges())
    for each in team.all:
        each.overrule(frozenset({1}), frozenset())
    assert [each.out for each in team.all] == [frozenset({1})] * 3
    assert len({each.digest for each in team.all}) == 1
    assert KEYS[1] in team.all[0].frames  # where it lies is known still
    for each in team.all[:2]:
        each.standing.convict(2, "it has signed two things")
        each.heed()
    assert KEYS[2] not in team.all[0].told
    assert team.all[0].out == {1, 2}

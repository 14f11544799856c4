"""What evidence says of edges: a false one joins nobody, and one that it comes to contradict is undone."""

from __future__ import annotations

from contextlib import suppress

import msgspec
import numpy as np
import pytest
from numpy.typing import NDArray

from tests.support.mutants import VALUES
from tests.support.small_missions import small_office
from vedette.agent.messages import FramedFreeze, FrameTold, decode, encode
from vedette.fusion.frame_edges import FrameEdge, packed, room_for
from vedette.fusion.framed import FramedEvidence
from vedette.fusion.link import Key
from vedette.kernels.tiles import TiledGrid
from vedette.maps import GridFrame
from vedette.maps.transform import IDENTITY, Transform
from vedette.missions.explore.frames.shared import SharedFrames

KEYS: list[Key] = [(0, 5), (1, 5)]
FRAME = GridFrame(0.1, 512, 512, -25.6, -25.6)
ANGLE = 5  # its place in `FrameTold`
THERE = Transform(600, -400, 0)  # of the second one's frame in the first one's: whole cells


def seen(rows: slice) -> NDArray[np.int8]:
    """Return what a robot knows of some rows of an office, its walls where they are."""
    solid = small_office(seed=1).solid
    grid = np.zeros(FRAME.shape, np.int8)
    inside = np.zeros(solid.shape, np.bool_)
    inside[rows] = True
    part = np.where(solid, np.int8(20), np.int8(-20)) * inside
    grid[210 : 210 + solid.shape[0], 200 : 200 + solid.shape[1]] = part
    return grid


def team(second: NDArray[np.int8], edges: list[FrameEdge]) -> list[SharedFrames]:
    """Return what both make of each other's evidence, and of edges that the second one tells."""
    both = [FramedEvidence(*key, FRAME, 1, 2) for key in KEYS]
    told = np.concatenate(([0], packed(edges, room_for(2))))
    both[0].publish(TiledGrid.of(seen(slice(0, 100))), None, np.zeros(len(told), np.int64))
    both[1].publish(TiledGrid.of(second), None, told)
    talk(both)
    return [SharedFrames(one, FRAME, gap=17.0) for one in both]


def talk(both: list[FramedEvidence]) -> None:
    for one, other in ((0, 1), (1, 0)):
        both[one].set_neighbours([other])
    for second in range(6):
        for one, other in ((0, 1), (1, 0)):
            payload = both[one].outgoing(other, 3.0 * second)
            if payload is not None:
                both[other].receive(one, payload, 3.0 * second)


def moved(grid: NDArray[np.int8]) -> NDArray[np.int8]:
    """Return a grid as it lies in the second one's frame."""
    return np.roll(grid, (4, -6), axis=(0, 1))


def edge(there: Transform) -> FrameEdge:
    return FrameEdge(KEYS[0], KEYS[1], there, 9000)


def is_joined(one: SharedFrames) -> bool:
    one.solve()
    return one.graph[KEYS[0]].anchor == one.graph[KEYS[1]].anchor


def test_an_edge_that_evidence_bears_out_joins_two_and_each_sees_the_others_map_in_its_own() -> None:
    one, two = team(moved(seen(slice(0, 100))), [edge(THERE)])
    assert is_joined(one)
    assert is_joined(two)
    assert one.own(1) == THERE
    assert two.own(0) == THERE.inverse()


@pytest.mark.parametrize(
    "false",
    [
        Transform(1600, -400, 0),
        Transform(600, -400, 2000),
        Transform(600, -400, 910),  # 5 degrees: walls still lie near walls, but they pull
        Transform(600, -400, -910),
        Transform(1000, -400, 0),
        Transform(90_000, 0, 0),
    ],
)
def test_a_false_edge_joins_nobody_whoever_tells_it(false: Transform) -> None:
    one, two = team(moved(seen(slice(0, 100))), [edge(false)])
    assert not is_joined(one)
    assert not is_joined(two)


def test_a_join_that_evidence_comes_to_contradict_is_undone_and_nothing_is_lost() -> None:
    one, two = team(moved(seen(slice(0, 60))), [edge(THERE)])
    assert is_joined(one)
    other = moved(np.ascontiguousarray(seen(slice(0, 100))[:, ::-1]))  # it is another place, after all
    for _ in range(5):  # what agreed is looked at again after some versions
        two.evidence.publish(TiledGrid.of(-other), None, None)
        two.evidence.publish(TiledGrid.of(other), None, None)
    talk([one.evidence, two.evidence])
    held = one.evidence.copies[KEYS[1]].version
    assert not is_joined(one)
    assert held == two.evidence.copies[KEYS[1]].version
    alone = one.evidence.classes.window()
    assert np.array_equal(alone != 0, seen(slice(0, 100)) != 0)


def test_who_solves_otherwise_than_the_root_knows_that_the_round_is_approximate() -> None:
    one, two = team(moved(seen(slice(0, 100))), [edge(THERE)])
    told = one.lay_out()
    assert one.take(told)
    assert two.take(told)
    assert one.evidence.digest == two.evidence.digest
    apart = tuple(FrameTold(t.robot, t.boot, t.robot, t.x + 40_000 * t.robot, t.y, t.angle) for t in told)
    assert not two.take(apart)
    beside = tuple(FrameTold(t.robot, t.boot, t.part, t.x + 200 * t.robot, t.y, t.angle) for t in told)
    assert not two.take(beside)
    with pytest.raises(ValueError, match="twice"):
        two.take([*told, told[0]])
    assert one.plane[KEYS[0]] == IDENTITY


@pytest.mark.parametrize("field", range(len(FrameTold.__struct_fields__)))
def test_whatever_a_root_says_of_a_frame_a_robot_refuses_it_or_knows_that_it_differs(field: int) -> None:
    one, two = team(moved(seen(slice(0, 100))), [edge(THERE)])
    told = one.lay_out()
    fields = msgspec.to_builtins(told[1])
    refused = 0
    for value in (*VALUES, 2**31, -(2**31), 2**16 - 1, 25_600, -25_600):
        says = [*fields[:field], value, *fields[field + 1 :]]
        data = msgspec.msgpack.decode(encode(FramedFreeze(1, 2, 0, 0, 2)))
        data[-1] = [msgspec.to_builtins(told[0]), says]
        try:
            message = decode(msgspec.msgpack.encode(data))
        except ValueError:
            refused += 1
            continue
        assert isinstance(message, FramedFreeze)
        agrees = says == fields or (field == ANGLE and value in (1, 2**16 - 1))  # by 0.005 degrees
        with suppress(ValueError):  # a contributor is told twice
            assert two.take(message.frames) == agrees, says
    assert refused >= 10
    assert two.take(told)
    assert one.take(told)
    assert one.evidence.digest == two.evidence.digest

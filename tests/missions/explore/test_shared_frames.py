"""What evidence says of edges: a false one joins nobody, and one that it comes to contradict is undone."""

from __future__ import annotations

from contextlib import suppress
from itertools import permutations

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
from vedette.missions.explore.frames import charts
from vedette.missions.explore.frames.borne_out import BorneOut
from vedette.missions.explore.frames.charts import Charts
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
    exchange(both)


def exchange(team: list[FramedEvidence]) -> None:
    for second in range(6):
        for one, other in permutations(range(len(team)), 2):
            payload = team[one].outgoing(other, 3.0 * second)
            if payload is not None:
                team[other].receive(one, payload, 3.0 * second)


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


def test_a_match_is_renewed_by_all_as_maps_change_whatever_was_told_of_it_first() -> None:
    one, two = team(moved(seen(slice(0, 100))), [edge(THERE)])
    assert is_joined(one)
    bent = np.roll(moved(seen(slice(0, 100))), 2, axis=1)  # its SLAM has put all of it right by 20 cm
    for _ in range(5):
        two.evidence.publish(TiledGrid.of(-bent), None, None)
        two.evidence.publish(TiledGrid.of(bent), None, None)
    talk([one.evidence, two.evidence])
    right = Transform(THERE.x - 200, THERE.y, 0)
    told = one.lay_out()
    assert two.take(told)
    assert one.take(told)
    for there in (one.own(1), two.graph[KEYS[1]].there):
        assert there is not None
        assert there.apart(right, 0.0, 0.0)[0] < 0.02


def test_others_word_of_a_match_counts_where_none_of_the_two_has_one_that_counts() -> None:
    keys: list[Key] = [*KEYS, (2, 5)]
    all_ = [FramedEvidence(*key, FRAME, 1, 3) for key in keys]
    false = FrameEdge(keys[0], keys[1], Transform(90_000, 0, 0), 9000)
    third = edge(Transform(THERE.x + 100, THERE.y, 0))._replace(weight=1 << 30)
    for own in (edge(THERE), false, None):
        told = [np.concatenate(([0], packed([each] if each else [], room_for(3)))) for each in (own, third)]
        all_[0].publish(TiledGrid.of(seen(slice(0, 100))), None, np.zeros(len(told[0]), np.int64))
        all_[1].publish(TiledGrid.of(moved(seen(slice(0, 100)))), None, told[0])
        all_[2].publish(TiledGrid.of(seen(slice(0, 0))), None, told[1])
        for one in all_:
            one.set_neighbours([k for k in range(3) if k != one.key[0]])
        exchange(all_)
        found = BorneOut(all_[0], Charts(all_[0], FRAME)).matches(all_[0].told, keys[:2])
        assert {(each.a, each.b) for each in found} == {tuple(keys[:2])}
        assert all(each.there.apart(THERE, 0.0, 0.0)[0] < 0.02 for each in found)
        assert len(found) == 1
        assert found[0].weight == 9000 if own is not None and own.there == THERE else found[0].weight < 20_000


def test_edges_that_change_at_every_version_are_kept_no_longer_than_they_are_told() -> None:
    one, two = team(moved(seen(slice(0, 100))), [])
    for version in range(12):
        wild = [edge(Transform(version * 997, 31 * version, version * 5077))]
        told = np.concatenate(([0], packed(wild, room_for(2))))
        two.evidence.publish(TiledGrid.of(moved(seen(slice(0, 100)))), None, told)
        talk([one.evidence, two.evidence])
        one.solve()
        one.solve()
    assert len(one._borne_out._verdicts) + len(one._borne_out._pulled) <= 4


@pytest.mark.parametrize("told", [(0, 0), (0, 511)])
def test_a_map_that_says_to_reach_across_the_world_joins_nobody_and_is_not_drawn_up(
    told: tuple[int, int], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(charts, "LARGEST", 200 * 200)
    far = moved(seen(slice(0, 100)))
    far[told] = -20
    one, _ = team(far, [edge(THERE)])
    assert one.charts.of(KEYS[1]) is None
    assert not is_joined(one)
    assert one.charts.of(KEYS[0]) is not None


def test_of_large_maps_few_charts_are_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(charts, "MOST", (64, 1000))
    monkeypatch.setattr(Charts, "_kept", type(Charts._kept)())
    one, _ = team(moved(seen(slice(0, 100))), [])
    kept = []
    for rows in range(60, 80, 2):
        one.evidence.publish(TiledGrid.of(seen(slice(0, rows))), None, None)
        kept.append(one.charts.of(KEYS[0]))
    assert len(Charts._kept) == charts.FEW
    assert [one.charts.of(KEYS[0])] == kept[-1:]


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

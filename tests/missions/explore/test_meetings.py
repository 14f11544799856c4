"""Meetings: who sees a disc move as a mate says knows its frame, and it counts where both have seen it."""

from __future__ import annotations

import math
from collections.abc import Collection
from typing import cast

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.support.small_missions import robots, small_office
from vedette.agent.events import Pose
from vedette.agent.mates import Mate
from vedette.fusion.frame_edges import EdgeKind, FrameEdge, packed, room_for, unpacked
from vedette.fusion.link import Key
from vedette.maps.transform import TURN, Transform
from vedette.missions.explore.frames.exploring import FramedExploring
from vedette.missions.explore.frames.graph import told_by_both
from vedette.missions.explore.frames.meetings import Meetings, Met
from vedette.sim.explore.run import ExploreRun, prepare
from vedette.sim.explore.simulation import ExploreSetup
from vedette.sim.framed import FramedRobots

OWN, MATE, THIRD = keys = [(0, 5), (1, 6), (2, 7)]
SCAN, BEACON = 0.2, 0.25  # [s]
Floats = np.ndarray[tuple[int, int], np.dtype[np.float64]]


def way(corners: list[tuple[float, float]], speed: float = 0.5) -> Floats:
    """Return where somebody is who follows corners, every tenth of a second ``(n, 2)``."""
    points = np.array(corners)
    arc = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))))
    along = np.arange(0.0, arc[-1], speed / 10.0)
    return np.column_stack([np.interp(along, arc, points[:, axis]) for axis in (0, 1)])


def moved(track: Floats, x: float, y: float) -> Floats:
    return track + np.array((x, y))


def watch(
    seen: list[Floats],
    said: dict[Key, Floats],
    noise: float = 0.01,
    unplaced: Collection[Key] | None = None,
) -> Meetings:
    """Let a robot see discs on some ways, and hear mates say theirs, each in its frame."""
    meetings, rng = Meetings(OWN), np.random.default_rng(3)
    for tick in range(max(len(track) for track in (*seen, *said.values()))):
        now = tick / 10.0
        mates = [
            Mate(robot, *track[tick].tolist(), 0.0, (), 0.0, 0.2, 0.5, now, boot)
            for (robot, boot), track in said.items()
            if tick < len(track) and tick % 3 == robot
        ]
        meetings.hear(mates)
        if tick % 2 == 0:
            places = [track[tick] + rng.normal(0.0, noise, 2) for track in seen if tick < len(track)]
            meetings.see([(float(x), float(y), 0.2) for x, y in places], now)
        meetings.compare(said.keys() if unplaced is None else unplaced, now)
    return meetings


CORNERS = [(0.0, 0.0), (2.5, 0.5), (2.0, 3.0), (4.0, 3.5)]


@settings(deadline=None, max_examples=20)
@given(x=st.integers(-20_000, 20_000), y=st.integers(-20_000, 20_000), angle=st.integers(0, TURN - 1))
def test_a_disc_that_moves_as_a_mate_says_tells_how_the_mates_frame_lies(x: int, y: int, angle: int) -> None:
    there, walked = Transform(x, y, angle), way(CORNERS)
    meetings = watch([there.places(walked)], {MATE: walked})
    (edge,) = meetings.found.values()
    assert (edge.a, edge.b, edge.met) == (OWN, MATE, True)
    shift, turn = edge.there.apart(there, *walked[-1].tolist())
    assert shift < 0.05
    assert turn < math.radians(1.0)


def test_what_moves_otherwise_than_a_mate_says_is_not_met() -> None:
    walked = way(CORNERS)
    assert not watch([way([(0.0, 0.0), (2.5, 0.5), (2.0, -3.0), (4.0, -3.5)])], {MATE: walked}).found
    assert not watch([1.3 * walked], {MATE: walked}).found
    assert not watch([walked], {}).found


def test_who_hardly_moves_tells_no_frame() -> None:
    still = np.repeat([[1.0, 2.0]], 100, axis=0)
    assert not watch([still], {MATE: still}).found
    assert not watch([way([(0.0, 0.0), (0.8, 0.0)])], {MATE: way([(0.0, 0.0), (0.8, 0.0)])}).found


def test_of_two_mates_that_say_the_same_way_neither_is_met() -> None:
    straight = way([(0.0, 0.0), (5.0, 0.0)])
    meetings = watch([moved(straight, 3.0, 1.0)], {MATE: straight, THIRD: moved(straight, 9.0, 9.0)})
    assert not meetings.found
    assert meetings.refused["several might have been met"] > 0


def test_who_says_the_way_of_a_mate_that_is_known_to_be_there_is_not_met() -> None:
    walked = way(CORNERS)
    said = {MATE: walked, THIRD: moved(walked, 3.0, 1.0)}
    meetings = watch([walked], said, unplaced=[THIRD])
    assert not meetings.found
    assert meetings.refused["several might have been met"] > 0
    alone = watch([walked], {MATE: walked, THIRD: moved(way(CORNERS[::-1]), 3.0, 1.0)}, unplaced=[THIRD])
    assert not alone.found  # nor is he who is known, again


def test_where_a_slam_puts_its_place_right_a_meeting_is_less_certain_and_taken_back_in_the_end() -> None:
    walked = way(CORNERS)
    meetings = watch([walked], {MATE: walked})
    weights = [meetings.found[OWN, MATE].weight]
    meetings.stand(Pose(0.0, 0.0, 0.0), 0.5, 100.0)
    meetings.stand(Pose(0.1, 0.0, 0.0), 0.5, 100.2)  # as far as it drives
    assert meetings.found[OWN, MATE].weight == weights[0]
    for number in range(2):
        meetings.stand(Pose(0.2 + 0.1 * number, 0.0, 0.0), 0.5, 100.2)  # by ten centimetres
        weights.append(meetings.found[OWN, MATE].weight)
    # by hand: 10 m leave 2 cm, and at least the square of 10 and of 20 cm is left
    assert weights[0] > 40 >= weights[1] > 10 >= weights[2]
    meetings.stand(Pose(0.5, 0.0, 0.0), 0.5, 100.2)
    assert not meetings.found
    assert meetings.refused["put right since"] == 1


def test_two_discs_are_told_apart_by_their_ways() -> None:
    there, other = Transform(4000, -2000, 9000), Transform(-500, 900, 40_000)
    one, two = way(CORNERS), way([(8.0, 1.0), (6.0, 1.0), (6.0, 4.0), (9.0, 4.0)])
    seen = [one, moved(two, 2.0, -6.0)]
    said = {MATE: there.inverse().places(seen[0]), THIRD: other.inverse().places(seen[1])}
    found = watch(seen, said).found
    assert {
        edge.b: edge.there.apart(right, 0.0, 0.0)[0] < 0.2
        for edge, right in zip((found[OWN, MATE], found[OWN, THIRD]), (there, other), strict=True)
    } == {MATE: True, THIRD: True}


def test_a_meeting_weighs_as_the_walls_that_leave_it_as_uncertain() -> None:
    there = Transform(0, 0, 0)
    assert Met(there, 0.04).weight == 250  # by hand: 10 m leave 2 cm, a quarter of that twice as much
    assert Met(there, 0.001).weight == 700
    assert Met(there, 9.0).weight == 1


AT = dict.fromkeys(keys, (2.0, 1.0))


def met(a: Key, b: Key, there: Transform, weight: int = 90) -> FrameEdge:
    return FrameEdge(a, b, there, weight, EdgeKind.MEETING)


def test_a_meeting_counts_if_both_tell_it_and_about_the_same() -> None:
    there = Transform(1500, -700, 8000)
    mine, theirs = met(OWN, MATE, there), met(MATE, OWN, Transform(1520, -700, 8020).inverse())
    assert set(told_by_both({OWN: [mine], MATE: [theirs]}, AT)) == {mine, theirs}
    assert told_by_both({OWN: [mine]}, AT) == []
    boast = met(MATE, OWN, there.inverse(), 1 << 40)
    doubted = met(OWN, MATE, there, 9)
    assert {edge.weight for edge in told_by_both({OWN: [doubted], MATE: [boast]}, AT)} == {9}
    boasts = {OWN: [met(OWN, MATE, there, 1 << 40)], MATE: [boast]}
    assert {edge.weight for edge in told_by_both(boasts, AT)} == {700}
    elsewhere = met(MATE, OWN, Transform(2500, -700, 8000).inverse())
    assert told_by_both({OWN: [mine], MATE: [elsewhere]}, AT) == []
    assert told_by_both({OWN: [mine], MATE: [theirs]}, {OWN: (0.0, 0.0)}) == []  # nothing seen to lay


@pytest.mark.parametrize("liar", [MATE, THIRD])
def test_nobody_alone_makes_a_meeting_of_two_others_nor_of_itself(liar: Key) -> None:
    there = Transform(1500, -700, 8000)
    told = {liar: [met(a, b, there) for a in keys for b in keys if a != b]}
    assert told_by_both(told, AT) == []


def test_edges_keep_their_kind_on_the_way() -> None:
    edges = [met(OWN, MATE, Transform(5, -6, 7), 0), FrameEdge(OWN, THIRD, Transform(-5, 6, 8), 700)]
    assert sorted(unpacked(packed(edges, room_for(3)))) == sorted(edges)


def test_robots_whose_maps_nobody_lays_on_each_other_are_joined_by_meeting() -> None:
    simulation = prepare(small_office(seed=1), robots(2), ExploreSetup(seed=8, frames="unknown"))
    assert isinstance(simulation.robots, FramedRobots)
    missions = [cast(FramedExploring, mission) for mission in simulation.missions]
    for mission in missions:
        mission.matcher._due = math.inf
    run = ExploreRun(simulation)
    while simulation.now < 60.0 and missions[0].frames.own(1) is None:
        run.step()
    simulation.stop()
    found = run.run().summary.frames
    assert found is not None
    (join,) = found.joins
    assert join.by == "meeting"
    assert join.error_m < 0.3
    assert join.error_deg < 3.0

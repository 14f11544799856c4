"""Robots that share no frame: what they make of edges, where their maps lie on a plane, whole missions."""

from __future__ import annotations

import math
from itertools import combinations
from typing import cast

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt

from tests.support.small_missions import robots, small_office
from vedette.errors import InputError
from vedette.fusion.frame_edges import EdgeKind, FrameEdge
from vedette.fusion.link import Key
from vedette.kernels.reference import coverage as reference_coverage
from vedette.maps import FREE, UNKNOWN
from vedette.maps.disc import cells_under
from vedette.maps.transform import IDENTITY, TURN, Transform
from vedette.missions.explore.frames.exploring import NUMBERED, FramedExploring
from vedette.missions.explore.frames.graph import Placed, solved
from vedette.missions.explore.frames.layout import Box, laid_out
from vedette.record.explore.observer import ExploreReport
from vedette.sim.explore.run import explore, prepare
from vedette.sim.explore.simulation import ExploreSetup
from vedette.sim.framed import FramedRobots

TRANSFORMS = st.builds(
    Transform, st.integers(-20_000, 20_000), st.integers(-20_000, 20_000), st.integers(0, TURN - 1)
)


def keys_of(robots: int) -> list[Key]:
    return [(robot, 5) for robot in range(robots)]


def always(a: Key, b: Key, there: Transform) -> bool:
    return True


def is_close(one: Transform, other: Transform, metres: float = 0.01, degrees: float = 0.1) -> bool:
    shift, turn = one.apart(other, 3.0, -2.0)
    return shift < metres and turn < math.radians(degrees)


@settings(deadline=None, max_examples=40)
@given(data=st.data(), n=st.integers(2, 6), seed=st.integers(0, 2**32 - 1))
def test_whoever_a_chain_of_edges_joins_lies_where_the_truth_says_in_the_lowest_ones_frame(
    data: st.DataObject, n: int, seed: int
) -> None:
    rng, keys = np.random.default_rng(seed), keys_of(n)
    true = data.draw(st.lists(TRANSFORMS, min_size=n, max_size=n))
    pairs = [(int(rng.integers(0, i)), i) for i in range(1, n) if rng.random() < 0.8]
    edges = []
    for i, j in pairs:
        a, b = (i, j) if rng.random() < 0.5 else (j, i)
        there = true[a].inverse().after(true[b])
        edges.append(FrameEdge(keys[a], keys[b], there, int(rng.integers(500, 9000))))
    graph = solved(edges, keys, dict.fromkeys(keys, (1.0, 2.0)), always)
    group = list(range(n))  # by the definition: who can be reached
    for i, j in pairs:
        group = [min(group[i], group[j]) if g in (group[i], group[j]) else g for g in group]
    for k, key in enumerate(keys):
        anchor = min(m for m in range(n) if group[m] == group[k])
        assert graph[key].anchor == keys[anchor]
        assert is_close(graph[key].there, true[anchor].inverse().after(true[k]), 0.05, 0.1)


@pytest.mark.parametrize("wrong", range(3))
def test_one_wrong_edge_in_a_cycle_bends_nothing_if_it_is_the_lightest(wrong: int) -> None:
    keys = keys_of(3)
    true = [IDENTITY, Transform(5000, -2000, 9000), Transform(-3000, 4000, 40_000)]
    edges = []
    for number, (a, b) in enumerate(combinations(range(3), 2)):
        there = true[a].inverse().after(true[b])
        if number == wrong:
            there = Transform(there.x + 900, there.y, there.angle)
        edges.append(FrameEdge(keys[a], keys[b], there, 1000 if number == wrong else 5000))
    graph = solved(edges, keys, dict.fromkeys(keys, (0.0, 0.0)), always)
    assert all(is_close(graph[key].there, there, 0.01) for key, there in zip(keys, true, strict=True))


def test_edges_that_nearly_agree_share_the_difference() -> None:
    keys = keys_of(3)
    edges = [
        FrameEdge(keys[0], keys[1], Transform(1000, 0, 0), 5000),
        FrameEdge(keys[1], keys[2], Transform(1000, 0, 0), 5000),
        FrameEdge(keys[0], keys[2], Transform(2090, 0, 0), 5000),
    ]
    graph = solved(edges, keys, dict.fromkeys(keys, (0.0, 0.0)), always)
    assert graph[keys[1]].there.x == pytest.approx(1030, abs=2)  # by hand: 9 cm over three edges alike
    assert graph[keys[2]].there.x == pytest.approx(2060, abs=2)


def test_a_meeting_that_evidence_refuses_joins_nobody_and_what_it_contradicts_parts_at_the_lightest() -> None:
    keys = keys_of(4)
    edges = [
        FrameEdge(keys[0], keys[1], Transform(1000, 0, 0), 5000),
        FrameEdge(keys[1], keys[2], Transform(1000, 0, 0), 3000),
        FrameEdge(keys[2], keys[3], Transform(1000, 0, 0), 4000),
    ]
    at = dict.fromkeys(keys, (0.0, 0.0))
    met = [*edges[:2], edges[2]._replace(kind=EdgeKind.MEETING)]
    graph = solved(met, keys, at, lambda a, b, there: (a, b) != (keys[2], keys[3]))
    assert [graph[key].anchor for key in keys] == [keys[0], keys[0], keys[0], keys[3]]
    graph = solved(edges, keys, at, lambda a, b, there: (a, b) != (keys[0], keys[3]))
    assert [graph[key].anchor for key in keys] == [keys[0], keys[0], keys[2], keys[2]]
    assert graph[keys[3]] == Placed(keys[2], Transform(1000, 0, 0))


def test_of_two_edges_between_a_pair_the_heavier_counts_whoever_tells_it() -> None:
    a, b = keys_of(2)
    edges = [FrameEdge(a, b, Transform(1, 0, 0), 10), FrameEdge(b, a, Transform(7000, 0, 0), 20)]
    graph = solved(edges, [a, b], {a: (0.0, 0.0), b: (0.0, 0.0)}, always)
    assert graph[b].there == Transform(-7000, 0, 0)


@settings(deadline=None, max_examples=50)
@given(
    boxes=st.lists(
        st.tuples(st.floats(-60, 50), st.floats(-60, 50), st.floats(1, 30), st.floats(1, 30)),
        min_size=1,
        max_size=5,
    ),
    joined=st.sets(st.integers(1, 4)),
    there=TRANSFORMS,
)
def test_components_lie_apart_by_the_gap_and_the_first_where_it_is(
    boxes: list[tuple[float, float, float, float]], joined: set[int], there: Transform
) -> None:
    keys = keys_of(len(boxes))
    seen: dict[Key, Box] = {key: (x, y, x + w, y + h) for key, (x, y, w, h) in zip(keys, boxes, strict=True)}
    graph = {key: Placed(keys[0], there) if key[0] in joined else Placed(key, IDENTITY) for key in keys}
    laid = laid_out(graph, seen, 17.0, 400.0)
    assert {each.key for each in laid} == set(keys)
    assert next(each.there for each in laid if each.key == keys[0]) == IDENTITY
    corners = {
        each.key: np.array(
            [each.there.place(x, y) for x in seen[each.key][::2] for y in seen[each.key][1::2]]
        )
        for each in laid
    }
    for one, other in combinations(laid, 2):
        if one.part == other.part:
            between = graph[one.key].there.inverse().after(graph[other.key].there)
            assert is_close(one.there.inverse().after(other.there), between, 0.02, 0.01)
            continue
        a, b = corners[one.key], corners[other.key]
        gaps = np.maximum(a.min(axis=0) - b.max(axis=0), b.min(axis=0) - a.max(axis=0))
        assert gaps.max() >= 17.0 - 1e-6


def test_a_component_that_the_plane_has_no_room_for_is_left_out() -> None:
    a, b = keys_of(2)
    graph = {a: Placed(a, IDENTITY), b: Placed(b, IDENTITY)}
    box = (-30.0, -30.0, 30.0, 30.0)
    assert [each.key for each in laid_out(graph, {a: box, b: box}, 17.0, 40.0)] == [a]


def test_whoever_tells_of_a_boundless_map_leaves_the_others_their_room() -> None:
    keys = keys_of(3)
    graph = {key: Placed(key, IDENTITY) for key in keys}
    boxes = {keys[0]: (-390.0, -390.0, 390.0, 390.0)} | dict.fromkeys(keys[1:], (-30.0, -20.0, 30.0, 20.0))
    laid = laid_out(graph, boxes, 41.0, 400.0)
    assert [each.key for each in laid] == keys[1:]
    assert laid[0].there == IDENTITY


# -- missions -------------------------------------------------------------------------------------------


def mission(seed: int, **setup: object) -> ExploreReport:
    given = ExploreSetup(seed=seed, **{"frames": "unknown", **setup})  # type: ignore[arg-type]
    return explore(prepare(small_office(seed=1), robots(2), given))


def test_two_robots_that_share_no_frame_map_an_office_together() -> None:
    summary = mission(7).summary
    assert summary.completed
    assert summary.coverage is not None
    assert summary.coverage > 0.99
    assert summary.map_error_share < 0.01
    assert summary.frames is not None
    assert summary.frames.components == (("robot-1", "robot-2"),)
    (join,) = summary.frames.joins
    assert join.error_m < 0.1
    assert join.error_deg < 1.0
    assert summary.maps == (("robot-1", "robot-2"),)


def test_what_a_mate_left_alone_counts_as_this_robots_own_map_had_it_when_it_was_told_first() -> None:
    simulation = prepare(small_office(seed=1), robots(2), ExploreSetup(seed=7, frames="unknown"))
    mission = cast(FramedExploring, simulation.missions[0])
    while (there := mission.frames.own(1)) is None:
        assert simulation.now < 40.0
        simulation.step()
    x, y = 30.05, 30.05  # where nobody is
    classes, (row, col) = mission.fusion.classes, mission.frame.cell(x, y)

    def square(reach: int) -> NDArray[np.int64]:
        beside = np.arange(-reach, reach + 1)
        return ((row + beside)[:, None] * mission.frame.cols + col + beside).ravel()

    for reach, of in ((20, FREE), (2, UNKNOWN)):
        classes.put(square(reach), np.full((2 * reach + 1) ** 2, of, np.uint8))
    at = there.inverse().place(x, y)
    note = round(100 * at[0]), round(100 * at[1]), 999 * NUMBERED + 1  # in the mate's map it was 999
    for _ in range(2):
        mission.hear_notes([note])
        (told,) = mission.platform.left_alone.told
        assert math.dist(told.at, (x, y)) < 0.02
        assert told.unknown == 25
        classes.put(square(2), np.full(25, FREE, np.uint8))  # it is seen after all


def test_berths_are_those_of_the_walls_that_looks_are_valued_with() -> None:
    simulation = prepare(small_office(seed=1), robots(2), ExploreSetup(seed=7, frames="unknown"))
    mission = cast(FramedExploring, simulation.missions[0])
    while mission.frames.own(1) is None or simulation.now < 20.0:
        simulation.step()
    plane = mission.freeze(simulation.now)
    valued = mission._to_value_by(plane)
    most = int(plane.berths.max())
    assert np.array_equal(valued.berths, reference_coverage.berths(valued.classes, 1, most))
    assert not np.array_equal(valued.berths, plane.berths)  # walls were closed


def test_a_mate_whose_frame_is_unknown_is_not_mapped_as_a_wall() -> None:
    simulation = prepare(small_office(seed=1), robots(2), ExploreSetup(seed=7, frames="unknown"))
    assert isinstance(simulation.robots, FramedRobots)
    while simulation.now < 4.5:
        simulation.step()
        for i, mission in enumerate(simulation.missions):
            x, y, _ = simulation.pose(1 - i)
            mate = simulation.robots.frames[i].inverse().places(np.array([[x, y]]))[0]
            under = cells_under(mission.frame, float(mate[0]), float(mate[1]), 0.15)
            assert (mission.own.log_odds.take(under) <= 0).all()


def test_robots_that_never_find_each_others_frames_neither_map_each_other_nor_collide() -> None:
    world = small_office(seed=1)
    simulation = prepare(world, robots(2), ExploreSetup(seed=7, frames="unknown", max_time=150.0))
    assert isinstance(simulation.robots, FramedRobots)
    missions = [cast(FramedExploring, mission) for mission in simulation.missions]
    for mission in missions:
        mission.matcher._due = mission.meetings._due = math.inf
    nearest = math.inf
    while simulation.over is None:
        simulation.step()
        nearest = min(nearest, math.dist(*(simulation.pose(i)[:2] for i in range(2))))
    assert nearest < 1.5  # they did come near each other
    assert simulation.robots.bodies.collisions.sum() == 0
    away = distance_transform_edt(~np.pad(world.solid, 1, constant_values=True))[1:-1, 1:-1]
    for mission, frame in zip(missions, simulation.robots.frames, strict=True):
        assert len(mission.frames.evidence.frames) == 1
        known = mission.frame.window(*mission.known)
        walls = np.flatnonzero(mission.own.log_odds.window(*mission.known) > 0)
        places = frame.places(known.centres(walls))
        inside = places[world.frame.holds(places)]
        off = [away.flat[world.frame.flat(x, y)] for x, y in inside.tolist()]
        assert len(off) > 1000
        assert np.mean(np.array(off) > 2.0) < 0.002  # cells from a wall


def test_the_same_seed_gives_the_same_mission() -> None:
    assert mission(8, max_time=40.0).summary == mission(8, max_time=40.0).summary


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"fusion": "channel"}, "cannot move what it has added up"),
        ({"planner": "nearest"}, "does not negotiate"),
        ({"area": ((0.0, 0.0), (5.0, 0.0), (5.0, 5.0))}, "a frame that nobody has"),
        ({"unbounded": True}, "a frame that nobody has"),
        ({"frames": "unknow"}, "known"),
    ],
)
def test_what_does_not_go_with_unknown_frames_is_refused_in_a_line(
    options: dict[str, object], says: str
) -> None:
    with pytest.raises(InputError, match=says):
        mission(1, **options)

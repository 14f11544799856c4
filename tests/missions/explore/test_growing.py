"""A team that does not know how large its ground is maps and plans as one that does, on what it has seen."""

from __future__ import annotations

import tracemalloc
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.path import Path
from numpy.typing import NDArray

from tests.support.explorers import exchange, scan_from
from tests.support.mapping_scenes import FRAME, RESOLUTION, SPEC
from tests.support.small_missions import covered, robots, small_office
from vedette.agent.events import Pose, Scan, Sensed
from vedette.domains.mapping.impact import NOTHING, moved
from vedette.domains.mapping.planners import planner
from vedette.domains.mapping.sightings import BINS, ROWS
from vedette.errors import InputError
from vedette.fusion import ReplicatedEvidence
from vedette.maps import FREE, UNKNOWN, GridFrame
from vedette.maps.area import Area
from vedette.maps.image import MAX_SIDE
from vedette.maps.laid import laid
from vedette.maps.lattice import Lattice
from vedette.maps.world import World
from vedette.missions.explore.exploring import Exploring
from vedette.missions.explore.options import ExploreOptions
from vedette.missions.explore.own_map import OwnMap
from vedette.outcome import Outcome
from vedette.sim.explore.run import explore, prepare
from vedette.sim.explore.simulation import ExploreSetup
from vedette.team import Most, PlatformSpec

POSES = [Pose(-0.53, 7.12, 0.0), Pose(2.97, 7.08, 0.4), Pose(-0.61, 4.03, 1.0), Pose(10.02, 7.93, 2.0)]
MARGIN = 100  # cells that the whole frame has beyond the building: no robot sees so far
WHOLE = GridFrame(
    RESOLUTION,
    FRAME.rows + 2 * MARGIN,
    FRAME.cols + 2 * MARGIN,
    FRAME.origin_x - MARGIN * RESOLUTION,
    FRAME.origin_y - MARGIN * RESOLUTION,
)
OPEN = Lattice.open(RESOLUTION, (FRAME.origin_x, FRAME.origin_y))


def explorer(lattice: Lattice, robot: int = 0, spec: PlatformSpec = SPEC) -> Exploring:
    """A robot's mission of which nothing is seen yet."""
    shape = lattice.frame.shape
    fusion = ReplicatedEvidence(robot, 1 + robot, shape, ROWS * BINS, mark=lattice.mark)
    return Exploring(lattice, spec, planner("tours"), fusion, most=Most.of([spec]))


def look(mission: Exploring, pose: Pose, seed: int) -> None:
    """Take a scan from a pose into the map and publish it."""
    mission.observe(scan_from(pose, np.random.default_rng(seed)), pose, [], 0.0)
    mission.publish(20.0 * seed)


def on_map(mission: Exploring) -> NDArray[np.uint8]:
    """The team's map on the whole frame."""
    known = mission.fusion.known
    return laid(mission.fusion.classes.window(*known), mission.frame.window(*known), WHOLE)


def test_a_growing_team_holds_cell_for_cell_what_a_team_with_the_whole_frame_holds() -> None:
    grown, given = ([explorer(lattice, robot) for robot in (0, 1)] for lattice in (OPEN, Lattice(WHOLE)))
    for team in (grown, given):
        for k, pose in enumerate(POSES):
            look(team[k % 2], pose, k)
            exchange(*team)
            assert team[0].fusion.digest == team[1].fusion.digest
    np.testing.assert_array_equal(on_map(grown[0]), given[0].fusion.classes.window())
    np.testing.assert_array_equal(grown[0].fusion.counts, given[0].fusion.counts)
    assert grown[0].fusion.digest != given[0].fusion.digest  # they are not of one team


def decided(mission: Exploring) -> tuple[NDArray[np.float64], NDArray[np.float64], float]:
    """Let a robot decide alone; return its views, their arrivals, and the value."""
    belief = mission.freeze(0.0)
    mission.prepare(belief, POSES[1], [], False, 0.0)
    tour = mission.platform.reply(belief, NOTHING, mission.strategy)
    value = mission.objective.value(belief, mission.platform.impact(belief, tour))
    return tour.views, tour.arrivals, value


def test_a_growing_robot_decides_what_one_with_the_whole_frame_decides() -> None:
    results = []
    for lattice in (OPEN, Lattice(WHOLE)):
        mission = explorer(lattice)
        for k, pose in enumerate(POSES[:2]):
            look(mission, pose, k)
        results.append(decided(mission))
    (views, arrivals, value), (other_views, other_arrivals, other_value) = results
    assert len(views)
    np.testing.assert_allclose(views, other_views, atol=1e-9)
    np.testing.assert_allclose(arrivals, other_arrivals, rtol=1e-5)
    assert value == pytest.approx(other_value, rel=1e-5)


def test_impacts_of_robots_that_know_different_parts_combine_as_on_the_whole_map() -> None:
    impacts, beliefs = [], []
    for lattice in (OPEN, Lattice(WHOLE)):
        for k in (0, 3):  # two robots, each with a map of its own
            mission = explorer(lattice, robot=k)
            look(mission, POSES[k], k)
            belief = mission.freeze(0.0)
            mission.prepare(belief, POSES[k], [], False, 0.0)
            tour = mission.platform.reply(belief, NOTHING, mission.strategy)
            impacts.append(mission.codec.decode(mission.codec.encode(mission.platform.impact(belief, tour))))
            beliefs.append(belief)
    assert beliefs[0].frame != beliefs[1].frame
    team, whole = (mission.objective.combine(*impacts[k : k + 2]) for k in (0, 2))
    there = moved(team, beliefs[0].planning, beliefs[2].planning)
    assert len(there.keys) > 0
    np.testing.assert_array_equal(there.keys, whole.keys)
    np.testing.assert_array_equal(there.misses, whole.misses)


def test_evidence_and_impacts_lie_on_either_side_of_the_origin() -> None:
    mission, mate = explorer(Lattice.open(RESOLUTION)), explorer(Lattice.open(RESOLUTION), robot=1)
    for k, pose in enumerate(POSES):
        look(mission, pose, k)
    exchange(mission, mate)
    rows, cols = mate.fusion.known
    corner = mate.frame.window(rows, cols)
    assert corner.origin_x < 0.0 < corner.extent[1]
    assert mate.fusion.digest == mission.fusion.digest
    np.testing.assert_array_equal(
        mate.fusion.classes.window(rows, cols), mission.fusion.classes.window(rows, cols)
    )


def test_robots_of_different_lattices_never_hold_the_same_digest() -> None:
    yard = Area.of([(-3.0, 2.0), (11.0, 2.0), (11.0, 12.0), (-3.0, 12.0)])
    lattices = [OPEN, Lattice.open(RESOLUTION), Lattice(FRAME), Lattice(FRAME, yard)]
    assert len({explorer(lattice).fusion.digest for lattice in lattices}) == len(lattices)


def test_nothing_outside_the_area_is_anybodys() -> None:
    yard = Area.of([(-3.0, 2.0), (2.0, 2.0), (2.0, 12.0), (-3.0, 12.0)])
    mission = explorer(Lattice(FRAME, yard))
    for k, pose in enumerate(POSES[:2]):
        look(mission, pose, k)
    belief = mission.freeze(0.0)
    outside = ~yard.holds(belief.frame)
    assert outside.any()
    assert not (belief.classes[outside] == UNKNOWN).any()
    points = belief.frame.centres(belief.frontier_cells)
    assert len(points)
    assert points[:, 0].max() < 2.0
    here = Pose(1.0, 7.1, 0.0)
    assert mission.route(here, (0.0, 7.1), [], False, 0.0) is not None
    assert mission.route(here, (3.0, 7.1), [], False, 0.0) is None


def test_a_team_that_does_not_know_how_large_its_world_is_explores_all_of_it() -> None:
    world = small_office(seed=1)
    simulation = prepare(world, robots(2), ExploreSetup(seed=7, unbounded=True))
    report = explore(simulation)
    assert report.summary.completed
    assert covered(world, simulation.specs, simulation.starts, report) >= 0.995
    assert report.summary.map_errors == 0
    assert report.summary.collisions == 0


HALF_THE_OFFICE = ((0.0, 0.0), (6.5, 0.0), (5.5, 10.0), (0.0, 10.0))


@pytest.mark.parametrize("unbounded", [False, True])
def test_a_team_explores_its_area_and_never_leaves_it(unbounded: bool) -> None:
    setup = ExploreSetup(seed=7, area=HALF_THE_OFFICE, unbounded=unbounded)
    simulation = prepare(small_office(seed=1), robots(2), setup)
    report = explore(simulation)
    assert report.summary.completed
    assert report.summary.coverage >= 0.99
    yard = Path(HALF_THE_OFFICE)
    places = report.log.poses[..., :2].reshape(-1, 2)
    assert yard.contains_points(places).all()
    assert all(yard.contains_points([(spot.x, spot.y)])[0] for spot in report.summary.left_out)


def test_a_start_beside_the_area_is_refused_in_one_line() -> None:
    specs = [PlatformSpec(name="far", start=(9.0, 1.5))]
    hall = World(GridFrame(0.1, 100, 120), np.zeros((100, 120), np.bool_), "hall")
    with pytest.raises(InputError, match=r"far: start 9,1\.5 is not all within the area"):
        prepare(hall, specs, ExploreSetup(area=HALF_THE_OFFICE))


def test_an_area_elsewhere_is_refused_in_one_line() -> None:
    far = tuple((x + 100.0, y) for x, y in HALF_THE_OFFICE)
    with pytest.raises(InputError, match="area: nothing of office that is free lies in it"):
        prepare(small_office(seed=1), robots(2), ExploreSetup(area=far))


def memory_and_tiles(team: list[Exploring], places: NDArray[np.float64], seed: int) -> tuple[int, int]:
    """Let robots see some places in turn and tell each other; return bytes in use, and tiles seen by all."""
    angles = np.radians(np.arange(360.0))
    for k, (x, y) in enumerate(places.tolist()):
        mission, time = team[k % len(team)], float(seed * len(places) + k)
        mission.observe(Scan(angles, np.full(360, np.inf)), Pose(x, y, 0.0), [], time)
        mission.publish(time)
    for one, other in ((0, 1), (1, 2), (0, 1)):
        exchange(team[one], team[other])
    return tracemalloc.get_traced_memory()[0], sum(len(mission.own.log_odds.held) for mission in team)


def test_three_robots_that_see_400_by_400_metres_piece_by_piece_use_memory_as_they_see_more() -> None:
    side = 66.0 * np.arange(-3, 4)
    places = np.random.default_rng(0).permutation(np.array([(x, y) for x in side for y in side]))[:48]
    tracemalloc.start()
    team = [explorer(Lattice.open(0.1), robot) for robot in range(3)]
    before = tracemalloc.get_traced_memory()[0]
    used = [memory_and_tiles(team, part, k) for k, part in enumerate(np.split(places, 4))]
    tracemalloc.stop()
    assert before < 8e6  # three tables of where tiles are, for 820 by 820 m
    rows, cols = team[0].fusion.known
    assert min(rows.stop - rows.start, cols.stop - cols.start) > 3900
    assert [tiles for _, tiles in used] == pytest.approx(used[0][1] * np.arange(1, 5), rel=0.2)
    # log-odds twice; of all three, levels and stamps once; everybody's map; half of it is spare
    assert all((memory - before) / tiles < 2 * 1024 * (2 + 3 + 3) for memory, tiles in used)


@pytest.mark.slow
def test_three_robots_that_see_all_of_400_by_400_metres_use_memory_as_they_see_more() -> None:
    side = 14.0 * np.arange(-14, 15)
    places = np.array([(x, y) for x in side for y in side])[:840]
    far = replace(SPEC, range=10.0)
    tracemalloc.start()
    team = [explorer(Lattice.open(0.1), robot, far) for robot in range(3)]
    before = tracemalloc.get_traced_memory()[0]
    used = [memory_and_tiles(team, part, k) for k, part in enumerate(np.split(places, 6))]
    tracemalloc.stop()
    known = team[0].fusion.known
    assert np.count_nonzero(team[0].fusion.classes.window(*known)) * 0.01 > 0.85 * 400.0**2
    tiles = np.array([tiles for _, tiles in used])
    assert (np.diff(tiles) > 0.1 * tiles[-1]).all()
    assert all((memory - before) / seen < 2 * 1024 * (2 + 3 + 3) for memory, seen in used)


def test_a_round_freezes_the_extent_that_its_belief_has() -> None:
    mission = explorer(OPEN)
    look(mission, POSES[0], 0)
    belief = mission.freeze(0.0)
    frame, classes = belief.frame, belief.classes.copy()
    look(mission, POSES[3], 1)
    mission.prepare(belief, POSES[0], [], False, 0.0)
    tour = mission.platform.reply(belief, NOTHING, mission.strategy)
    assert belief.frame == frame
    np.testing.assert_array_equal(belief.classes, classes)
    assert len(tour.views)
    assert frame.holds(tour.views).all()
    assert mission.freeze(1.0).frame.size > frame.size


# -- where there is no room for more cells ---------------------------------------------------------------

END = 8192 * RESOLUTION / 2.0  # of an open lattice about the origin [m]
ROUND = np.radians(np.arange(360.0) + 0.5)


def seen_at(mission: Exploring, x: float, y: float) -> int:
    """Let a robot see nothing within its range from a place; return how many beams had no cell to end in."""
    before = mission.own.beyond
    mission.observe(Scan(ROUND, np.full(360, np.inf)), Pose(x, y, 0.0), [], 0.0)
    mission.publish(0.0)
    return mission.own.beyond - before


def test_what_is_seen_beyond_the_lattice_is_counted_beam_by_beam() -> None:
    mission = explorer(Lattice.open(RESOLUTION))
    assert seen_at(mission, 0.0, 0.0) == 0
    assert seen_at(mission, END - 0.5 * SPEC.range, 0.0) == 120  # those that turn off by less than 60 degrees
    assert seen_at(mission, -END + 0.5 * SPEC.range, END - 0.5 * SPEC.range) == 120 + 120 - 30
    assert seen_at(mission, 0.0, END + 2.0 * SPEC.range) == 360


def test_a_robot_beyond_the_lattice_plans_nothing_and_nothing_breaks() -> None:
    mission, pose = explorer(Lattice.open(RESOLUTION)), Pose(3.0 * END, 0.0, 0.0)
    assert seen_at(mission, pose.x, pose.y) == 360
    belief = mission.freeze(0.0)
    mission.prepare(belief, pose, [], False, 0.0)
    assert mission.goal() is None
    assert mission.ending is Outcome.COMPLETE  # a line on the way has told that there is no room
    seen_at(mission, 0.0, 0.0)
    mission.prepare(mission.freeze(1.0), pose, [], False, 1.0)
    assert mission.nothing_left(0.0, 1.0) or mission.goal() is not None


def test_cells_of_a_robots_own_map_beyond_the_lattice_are_counted_anew_with_each_version() -> None:
    mission, rows, cols = explorer(Lattice.open(RESOLUTION)), 40, 30
    classes = np.full((rows, cols), FREE, np.uint8)
    for x, beyond in ((0.0, 0), (END - 10 * RESOLUTION, 20 * rows), (END + 1.0, rows * cols), (0.0, 0)):
        told = Sensed(OwnMap(classes, RESOLUTION, x, 0.0, 0.0), 0.0)
        mission.observe(told, Pose(0.0, 0.0, 0.0), [], 0.0)
        assert mission.own.beyond == beyond


def test_an_open_lattice_about_a_map_has_room_for_all_that_a_map_may_be() -> None:
    frame = GridFrame(0.05, MAX_SIDE, MAX_SIDE - 1, 448262.5, -19.0)
    lattice = ExploreOptions(unbounded=True).lattice_on(frame)
    corners = frame.centres(np.array([0, frame.cols - 1, frame.size - frame.cols, frame.size - 1]))
    assert lattice.frame.holds(corners).all()
    row, col = lattice.frame.cell(*corners[0].tolist())
    part = lattice.frame.window(slice(row, row + frame.rows), slice(col, col + frame.cols))
    np.testing.assert_allclose(part.extent, frame.extent, atol=1e-6)  # cells lie on cells


def test_on_a_map_or_an_area_nothing_lies_beyond() -> None:
    yard = Area.of([(-3.0, 2.0), (2.0, 2.0), (2.0, 12.0), (-3.0, 12.0)])
    for lattice in (Lattice(FRAME), Lattice.open(RESOLUTION, area=yard)):
        assert seen_at(explorer(lattice), FRAME.origin_x + 1.0, FRAME.origin_y + 1.0) == 0


def test_a_step_costs_what_it_changes_not_what_is_known() -> None:
    angles, peaks = np.radians(np.arange(360.0)), []
    mission = explorer(Lattice.open(0.1))
    for k in range(40):
        tracemalloc.start()
        mission.observe(Scan(angles, np.full(360, np.inf)), Pose(9.6 * k, 0.0, 0.0), [], float(k))
        mission.publish(float(k))
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    assert np.median(peaks[20:]) <= 1.5 * np.median(peaks[5:15])

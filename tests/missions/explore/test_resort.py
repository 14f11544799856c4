"""Where a robot stands is known free, and it looks round and creeps before it concludes anything."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from tests.support.explorers import exchange
from tests.support.small_missions import room_with_a_wall
from vedette.agent.events import Pose, Scan
from vedette.domains.mapping.planners import planner
from vedette.domains.mapping.sightings import BINS, ROWS
from vedette.domains.mapping.stops import Ground
from vedette.fusion import ReplicatedEvidence
from vedette.kernels.distance import distance_field
from vedette.kernels.lidar import cast_rays
from vedette.maps import FREE, UNKNOWN
from vedette.maps.disc import cells_under
from vedette.maps.lattice import Lattice
from vedette.missions.explore.exploring import Exploring
from vedette.missions.explore.looking import Looking
from vedette.missions.explore.resort import CREEP, CREEPS, LastResort
from vedette.team import PlatformSpec

RESOLUTION = 0.05
ROOM = room_with_a_wall(RESOLUTION)
FRAME = ROOM.frame
HERE = Pose(1.925, 3.125, 0.3)
NARROW = PlatformSpec(range=4.0, view=45.0, radius=0.21)  # what it lies on is not all that it needs


def explorer(robot: int, spec: PlatformSpec) -> Exploring:
    """A robot's mission of which nothing is seen yet."""
    fusion = ReplicatedEvidence(robot, 1 + robot, FRAME.shape, ROWS * BINS)
    return Exploring(Lattice(FRAME), spec, planner("tours"), fusion)


def look(mission: Exploring, pose: Pose) -> None:
    """Take one scan from a pose into the map."""
    spec = mission.spec
    angles = pose.heading + np.radians(spec.view) * ((np.arange(spec.beams) + 0.5) / spec.beams - 0.5)
    x, y = pose.x - FRAME.origin_x, pose.y - FRAME.origin_y
    ranges = cast_rays(ROOM.solid, RESOLUTION, x, y, angles, spec.range, np.empty((0, 3)))
    mission.observe(Scan(angles, ranges), pose, [], 0.0)
    mission.publish(0.0)


def decide(mission: Exploring, pose: Pose) -> float:
    """Go through a round alone; return the value of its decision."""
    belief = mission.freeze(0.0)
    mission.prepare(belief, pose, [], False, 0.0)
    mission.strategy = mission.platform.reply(belief, mission.objective.nothing(belief), mission.strategy)
    return mission.objective.value(belief, mission.platform.impact(belief, mission.strategy))


def test_where_a_robot_stands_is_free_to_it_and_to_its_mates_and_what_it_sees_stays_as_seen() -> None:
    mission, mate = explorer(0, NARROW), explorer(1, NARROW)
    look(mission, HERE)
    seen = explorer(2, PlatformSpec(range=4.0, view=45.0, radius=0.02))
    look(seen, HERE)
    exchange(mission, mate)
    under = cells_under(FRAME, HERE.x, HERE.y, NARROW.radius)
    assert (seen.own.log_odds.take(under) == 0).any()
    assert (mate.fusion.classes.take(under) == FREE).all()
    elsewhere = np.setdiff1d(np.arange(FRAME.size), under)
    np.testing.assert_array_equal(mission.own.log_odds.take(elsewhere), seen.own.log_odds.take(elsewhere))
    known = np.flatnonzero(seen.own.log_odds.window())
    np.testing.assert_array_equal(mission.own.log_odds.take(known), seen.own.log_odds.take(known))


def test_a_robot_that_is_told_its_place_inexactly_claims_what_is_under_it_anyway() -> None:
    mission = explorer(0, NARROW)
    look(mission, Pose(HERE.x, HERE.y, HERE.heading, deviation=0.06))
    under = cells_under(FRAME, HERE.x, HERE.y, NARROW.radius)
    sure = cells_under(FRAME, HERE.x, HERE.y, NARROW.radius - 0.12)
    assert (mission.own.log_odds.take(sure) < 0).all()
    assert (mission.own.log_odds.take(under) == 0).any()


def turn_round(mission: Exploring, pose: Pose) -> list[Pose]:
    """Let the robot turn on the spot as it wants to; return its poses."""
    poses = [pose]
    while not mission.reached(poses[-1], [], 0.0):
        route = mission.route(poses[-1], (pose.x, pose.y), [], False, 0.0)
        assert route is not None
        assert route.facing is not None
        assert math.dist(route.path[-1], (pose.x, pose.y)) < RESOLUTION
        poses.append(Pose(pose.x, pose.y, route.facing))
        look(mission, poses[-1])
    return poses


def test_a_robot_that_has_seen_little_finds_a_way_by_turning_on_the_spot() -> None:
    for spec in (NARROW, PlatformSpec(range=4.0, beams=8), PlatformSpec(range=4.0, view=30.0, beams=8)):
        mission, pose, value = explorer(0, spec), HERE, 0.0
        look(mission, pose)
        for _ in range(20):
            value = decide(mission, pose)
            goal = mission.goal()
            assert goal is not None
            if math.dist(goal, (pose.x, pose.y)) > 3.0 * RESOLUTION:
                break
            pose = turn_round(mission, pose)[-1]
        assert value > 0.0
        assert mission.route(pose, goal, [], False, 0.0) is not None


def knowing(classes: NDArray[np.uint8]) -> Exploring:
    """The mission of a robot that knows this much of the room."""
    mission = explorer(0, NARROW)
    mission.own.log_odds.put(np.arange(FRAME.size), np.array([0, -20, 20], np.int8)[classes].ravel())
    mission.fusion.publish(mission.own.log_odds, None, None)
    return mission


def test_a_robot_that_finds_no_stop_looks_all_round_once_before_it_says_so() -> None:
    classes = ROOM.classes()
    classes[30:35, 30:35] = UNKNOWN  # a scrap that no stop is worth
    mission = knowing(classes)
    look(mission, HERE)
    assert decide(mission, HERE) == 0.0
    assert mission.goal() == (HERE.x, HERE.y)
    assert not mission.nothing_left(0.0, 0.0)
    poses = turn_round(mission, HERE)
    assert 360.0 / NARROW.view <= len(poses) <= 360.0 / NARROW.view + 2
    assert decide(mission, poses[-1]) == 0.0
    assert mission.nothing_left(0.0, 0.0)


def test_a_robot_that_knows_all_there_is_looks_no_further() -> None:
    mission = knowing(ROOM.classes())
    look(mission, HERE)
    assert decide(mission, HERE) == 0.0
    assert mission.nothing_left(0.0, 0.0)


def test_a_stop_is_visited_when_the_robot_has_looked_at_it() -> None:
    mission, pose = explorer(0, NARROW), HERE
    for heading in np.arange(0.0, 6.3, 0.7):
        look(mission, Pose(HERE.x, HERE.y, heading))
    decide(mission, pose)
    view, target = mission.strategy.views[0].copy(), mission.strategy.targets[0].copy()
    toward = math.atan2(*(target - view)[::-1])
    away = Pose(*view.tolist(), toward + math.pi)
    mission._looking.add(away, away.heading + np.radians(np.arange(-22.5, 22.5, 0.125)))
    assert not mission.reached(away, [], 0.0)
    route = mission.route(away, tuple(view.tolist()), [], False, 0.0)
    assert route is not None
    assert route.facing is not None
    assert abs(math.remainder(route.facing - toward, math.tau)) < 0.02
    there = Pose(away.x, away.y, route.facing)
    mission._looking.add(there, there.heading + np.radians(np.arange(-22.5, 22.5, 0.125)))
    assert mission.reached(there, [], 0.0)


def ground(side: int) -> Ground:
    """A patch of so many cells a side about ``HERE`` where the robot can drive."""
    passable = np.zeros(FRAME.shape, bool)
    row, col = FRAME.cell(HERE.x, HERE.y)
    half = side // 2
    passable[row - half : row + half + 1, col - half : col + half + 1] = True
    here = FRAME.flat(HERE.x, HERE.y)
    return Ground(passable, here, distance_field(passable, here, RESOLUTION))


def test_a_robot_that_is_hemmed_in_creeps_a_few_times_for_another_look() -> None:
    resort = LastResort(Looking(PlatformSpec(), RESOLUTION))
    pose, places = HERE, []
    for _ in range(3 * CREEPS):
        resort.consider(pose, FRAME, ground(5), frontiers=True)
        if resort.goal is None:
            break
        pose = Pose(*resort.goal, 0.0)
        assert math.dist((HERE.x, HERE.y), resort.goal) <= CREEP
        assert resort.reached(pose)
        places.append((pose.x, pose.y))
    assert 1 <= len(places) <= CREEPS
    assert len(set(places)) == len(places)


def test_a_robot_that_could_drive_off_or_sees_no_frontier_does_not_creep() -> None:
    for side, frontiers in ((25, True), (5, False), (1, True)):
        resort = LastResort(Looking(PlatformSpec(), RESOLUTION))
        resort.consider(HERE, FRAME, ground(side), frontiers)
        assert resort.goal is None, (side, frontiers)

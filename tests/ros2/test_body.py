"""A body behind a door that a test opens: what a robot tells becomes events, routes become goals."""

from __future__ import annotations

from math import pi

import pytest

from tests.support.ros2_doors import FakeDoor, at, scan
from tests.support.ros2_routes import route
from vedette.agent.effects import Drive
from vedette.agent.events import Arrived, Pose, Scan, Stuck
from vedette.ros2.body import Ros2Body
from vedette.ros2.door import Answer, Deviation, GoalStatus, NavigatorGone, Word
from vedette.ros2.goals import ActionStatus
from vedette.ros2.settings import Ros2Settings
from vedette.team import PlatformSpec

START = (10.0, 5.0, 90.0)  # of the robot's map frame in the team's


def body_of(door: FakeDoor, **settings: object) -> Ros2Body:
    return Ros2Body(PlatformSpec(), Ros2Settings(start=START, **settings), door)  # type: ignore[arg-type]


@pytest.mark.parametrize(("namespace", "prefix"), [("", ""), ("robot1", ""), ("/robot1", "robot1/")])
def test_a_scan_comes_with_the_pose_at_its_own_time_before_the_present_one(
    namespace: str, prefix: str
) -> None:
    door = FakeDoor()
    body = body_of(door, namespace=namespace)
    door.told = [*at(1.0, 0.0, prefix=prefix), scan(1.5, prefix)]
    assert [type(event) for event in body.sense(0.0)] == [Pose]  # the scan waits
    door.told = at(2.0, 1.0, prefix=prefix)
    then, seen, now = body.sense(0.1)
    assert isinstance(then, Pose)
    assert isinstance(seen, Scan)
    assert isinstance(now, Pose)
    assert (then.x, then.y, then.heading) == pytest.approx((10.0, 5.5, pi / 2))
    assert (now.x, now.y) == pytest.approx((10.0, 6.0))
    assert seen.offset == pytest.approx((0.0, 0.2))
    assert seen.angles[5] == pytest.approx(pi / 2)
    assert seen.age == pytest.approx(0.5)
    body.carry_out(route((10.0, 6.0), (10.0, 7.0)), 0.2)
    assert door.frame == f"{prefix}map"


def test_nothing_is_told_before_the_robot_has_said_where_it_is() -> None:
    door = FakeDoor([scan(1.0)])
    assert body_of(door).sense(0.0) == []


def test_scans_that_come_faster_than_is_needed_are_left_alone() -> None:
    door = FakeDoor()
    body = body_of(door)
    for k in range(100):
        door.told += [*at(0.025 * k, 0.0), scan(0.025 * k)]
    seen = [event for event in body.sense(0.0) if isinstance(event, Scan)]
    assert len(seen) == pytest.approx(2.5 * 5, abs=1)


def test_a_scan_whose_time_is_forgotten_is_left_out() -> None:
    door = FakeDoor()
    body = body_of(door)
    door.told = [*at(100.0, 0.0), *at(101.0, 0.0), scan(99.0)]
    assert [type(event) for event in body.sense(0.0)] == [Pose]
    assert body.left_out == 1


def test_a_clock_that_begins_anew_does_not_silence_the_lidar() -> None:
    door = FakeDoor()
    body = body_of(door)
    door.told = [*at(1000.0, 0.0), scan(1000.0)]
    assert len(body.sense(0.0)) == 3
    door.told = [*at(1.0, 0.0), *at(2.0, 0.0), scan(1.5)]
    assert len(body.sense(0.1)) == 3


def test_a_lidar_or_a_localiser_that_falls_silent_is_a_worry_until_it_speaks_again() -> None:
    door = FakeDoor()
    body = body_of(door)
    door.told = [*at(1.0, 0.0), scan(1.0)]
    body.sense(0.0)
    assert body.worry == ""
    door.told = at(8.0, 0.0)
    body.sense(7.0)
    assert body.worry == "nothing on scan for 7 s: is the lidar on?"
    door.told = [scan(9.0)]
    body.sense(8.0)
    assert body.worry == "no transform for the scans of the last 8 s: is localisation running?"
    door.told = at(9.0, 0.0)
    body.sense(8.1)
    assert body.worry == ""


def test_the_localisers_deviation_is_the_poses() -> None:
    door = FakeDoor([*at(1.0, 0.0), Deviation(0.05, 0.02)])
    (pose,) = body_of(door).sense(0.0)
    assert isinstance(pose, Pose)
    assert (pose.deviation, pose.heading_deviation) == (0.05, 0.02)


def test_the_way_is_counted_and_jitter_is_not() -> None:
    door = FakeDoor()
    body = body_of(door)
    for k in range(200):
        door.told = at(0.1 * k, 0.02 * k if k < 100 else 2.0 + 0.001 * (k % 2))
        body.sense(0.1 * k)
    assert body.figures.travelled == pytest.approx(2.0, abs=0.03)
    assert body.pose == pytest.approx((10.0, 7.0, pi / 2), abs=2e-3)


def test_a_route_is_a_goal_at_its_end_in_the_robots_own_map() -> None:
    door = FakeDoor(at(1.0, 0.0))
    body = body_of(door)
    body.sense(0.0)
    body.carry_out(route((10.0, 5.0), (10.0, 7.0), (8.0, 7.0)), 0.1)  # 2 m ahead of the start, then 2 m left
    ((goal, place),) = door.asked
    assert place == pytest.approx((2.0, 2.0, pi / 2))
    door.told = [Answer(goal, accepted=True), GoalStatus(goal, ActionStatus.EXECUTING)]
    assert [type(event) for event in body.sense(0.2)] == [Pose]
    door.told = [GoalStatus(goal, ActionStatus.SUCCEEDED)]
    assert [type(event) for event in body.sense(0.3)] == [Pose, Arrived]
    body.carry_out(route((8.0, 7.0), facing=0.0), 0.4)
    assert door.asked[1][1] == pytest.approx((2.0, 2.0, -pi / 2))


def test_a_robot_that_is_to_stand_has_its_goal_cancelled_and_leaving_closes_the_door() -> None:
    door = FakeDoor(at(1.0, 0.0))
    body = body_of(door)
    body.sense(0.0)
    body.carry_out(route((10.0, 5.0), (10.0, 7.0)), 0.1)
    body.carry_out(Drive(None), 0.2)
    assert door.cancelled == [1]
    body.stop(0.3)
    assert door.closed


def test_an_aborted_goal_is_told_as_stuck_and_a_dead_navigator_is_asked_again() -> None:
    door = FakeDoor(at(1.0, 0.0))
    body = body_of(door)
    body.sense(0.0)
    body.carry_out(route((10.0, 5.0), (10.0, 7.0)), 0.1)
    door.told = [Answer(1, accepted=True), NavigatorGone()]
    body.sense(0.2)
    body.sense(5.0)
    assert [goal for goal, _ in door.asked] == [1, 2]
    door.told = [Answer(2, accepted=True), GoalStatus(2, ActionStatus.ABORTED)]
    assert [type(event) for event in body.sense(5.1)] == [Pose, Stuck]


def test_a_paused_robot_stands_whatever_its_agent_wants_and_goes_on_where_that_wants_it_by_then() -> None:
    door = FakeDoor(at(1.0, 0.0))
    body = body_of(door)
    body.sense(0.0)
    body.carry_out(route((10.0, 5.0), (10.0, 7.0)), 0.1)
    door.told = [Answer(1, accepted=True), Word.PAUSE]
    body.sense(0.2)
    assert door.cancelled == [1]
    door.told = [GoalStatus(1, ActionStatus.CANCELED)]
    assert [type(event) for event in body.sense(0.3)] == [Pose]
    body.carry_out(route((10.0, 5.0), (10.0, 6.0)), 0.4)
    assert len(door.asked) == 1
    door.told = [Word.RESUME]
    body.sense(0.5)
    assert door.asked[1][1] == pytest.approx((1.0, 0.0, 0.0))


def test_a_recalled_robot_goes_back_to_where_it_began_and_tells_its_agent_nothing_of_it() -> None:
    door = FakeDoor(at(1.0, 0.0))
    body = body_of(door)
    body.sense(0.0)
    door.told = at(2.0, 3.0)
    body.sense(0.1)
    door.told = [Word.RECALL]
    body.sense(0.2)
    ((goal, place),) = door.asked
    assert place == pytest.approx((0.0, 0.0, 0.0))
    door.told = [Answer(goal, accepted=True), GoalStatus(goal, ActionStatus.SUCCEEDED)]
    assert [type(event) for event in body.sense(0.3)] == [Pose]
    door.told = [Word.RESUME]
    body.sense(0.4)
    assert body.at_work is None

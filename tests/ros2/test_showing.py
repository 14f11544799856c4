"""What an agent shows beside its robot, decoded again by the definitions that ROS 2 has."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from rosbags.typesys import Stores, get_typestore

from tests.support.mapping_scenes import SPEC
from tests.support.ros2_doors import FakeDoor, at
from vedette.agent.events import Pose, Sensed
from vedette.domains.mapping.belief import planning_factor
from vedette.domains.mapping.impact import Impact
from vedette.domains.mapping.objective import MappingObjective
from vedette.fusion.link import Key
from vedette.kernels.coverage import LAYERS
from vedette.kernels.misses import CERTAIN
from vedette.maps import FREE
from vedette.maps.frame import GridFrame
from vedette.maps.lattice import Lattice
from vedette.maps.transform import IDENTITY, Transform
from vedette.missions.explore.assemble import assemble
from vedette.missions.explore.frames.exploring import FramedExploring
from vedette.missions.explore.frames.graph import Placed
from vedette.missions.explore.options import ExploreOptions
from vedette.missions.explore.own_map import OwnMap
from vedette.ros2.body import Ros2Body
from vedette.ros2.door import Word
from vedette.ros2.settings import Ros2Settings
from vedette.ros2.showing import GRID_PERIOD, PERIOD, Showing
from vedette.team import Most

STORE = get_typestore(Stores.ROS2_JAZZY)


def shown(door: FakeDoor) -> dict[str, Any]:
    """Return what was shown since the last call, by topic."""
    told = {each.topic: STORE.deserialize_cdr(each.cdr, each.kind) for each in door.shown}
    door.shown.clear()
    return told


def a_showing(prefix: str = "", **settings: Any) -> tuple[Showing, FakeDoor]:
    lattice = Lattice(GridFrame(0.1, 100, 100, -5.0, -5.0))
    agent = assemble(lattice, SPEC, ExploreOptions(), 0, 1, robots=1, most=Most.of([SPEC]))
    door = FakeDoor(at(12.5, 1.0, prefix=prefix))
    body = Ros2Body(SPEC, Ros2Settings(**settings), door)
    body.sense(0.0)
    own_map = OwnMap(np.full((10, 20), FREE, np.uint8), 0.1, 0.0, 0.0, 0.0)
    agent.mission.observe(Sensed(own_map, 0.0), Pose(1.0, 0.0, 0.0), [], 0.0)
    agent.mission.publish(0.0)
    return Showing(agent, body, "robot-1"), door


def test_the_map_lies_in_the_teams_frame_at_the_robots_own_time() -> None:
    showing, door = a_showing()
    showing(0.0)
    told = shown(door)
    assert set(told) == {"/tf_static", "team_map", "tour", "markers", "/diagnostics"}
    (joint,) = told["/tf_static"].transforms
    assert (joint.header.frame_id, joint.child_frame_id) == ("map", "team")
    grid = told["team_map"]
    assert (grid.header.frame_id, grid.header.stamp.sec, grid.header.stamp.nanosec) == ("team", 12, 500000000)
    rows, cols = np.nonzero(grid.data.reshape(grid.info.height, grid.info.width) == 0)
    corner = grid.info.origin.position
    x, y = corner.x + 0.1 * cols, corner.y + 0.1 * rows  # of cells' corners
    assert (x.min(), x.max(), y.min(), y.max()) == pytest.approx((0.0, 1.9, 0.0, 0.9))
    assert len(x) == 200
    (status,) = told["/diagnostics"].status
    assert (status.level, status.name, status.message) == (0, "robot-1", "ok")


def a_framed_showing(prefix: str = "") -> tuple[Showing, FakeDoor, FramedExploring]:
    """Of robot 2, in a frame of its own."""
    options = ExploreOptions(frames="unknown")
    agent = assemble(options.lattice(0.1), SPEC, options, 1, 7, robots=3, most=Most.of([SPEC]))
    door = FakeDoor(at(12.5, 1.0, prefix=prefix))
    body = Ros2Body(SPEC, Ros2Settings(namespace="r2"), door)
    body.sense(0.0)
    mission = agent.mission
    assert isinstance(mission, FramedExploring)
    own_map = OwnMap(np.full((10, 20), FREE, np.uint8), 0.1, 0.0, 0.0, 0.0)
    mission.observe(Sensed(own_map, 0.0), Pose(1.0, 0.0, 0.0), [], 0.0)
    mission.publish(0.0)
    return Showing(agent, body, "robot-2"), door, mission


THERE = Transform.of(3.0, 1.0, np.pi / 2.0)


def joined_with(*others: tuple[int, int]) -> dict[Key, Placed]:
    """Robot 2, joined with these, in the frame of the lowest."""
    keys = sorted([*others, (1, 7)])
    return {key: Placed(keys[0], THERE if key == (1, 7) else IDENTITY) for key in keys}


@pytest.mark.parametrize(("prefix", "topic", "child"), [("", "/r2/tf", "map"), ("r2/", "/tf", "r2/map")])
def test_a_map_of_an_unknown_frame_lies_in_the_teams_once_it_is_joined_and_while_it_is(
    prefix: str, topic: str, child: str
) -> None:
    showing, door, mission = a_framed_showing(prefix)
    showing(0.0)
    told = shown(door)
    assert not {name for name in told if "tf" in name}  # nothing is known, and nothing told
    assert told["team_map"].header.frame_id == child
    mission.frames.graph = joined_with((0, 3))
    showing(PERIOD)
    (joint,) = shown(door)[topic].transforms
    assert (joint.header.frame_id, joint.child_frame_id) == ("team", child)
    assert joint.header.stamp.sec == 12 + PERIOD  # it holds until the next one
    t, q = joint.transform.translation, joint.transform.rotation
    assert (t.x, t.y) == pytest.approx((3.0, 1.0))
    assert 2.0 * np.arctan2(q.z, q.w) == pytest.approx(np.pi / 2.0, abs=1e-4)
    mission.frames.graph = joined_with()
    showing(2.0 * PERIOD)
    assert topic not in shown(door)


@pytest.mark.parametrize(
    ("graph", "frame"),
    [
        (joined_with((2, 5)), "team_2_7"),
        ({**joined_with((2, 5)), (0, 3): Placed((0, 3), IDENTITY)}, "team_2_7"),
        ({**joined_with((0, 4)), (0, 3): Placed((0, 3), IDENTITY)}, "team_1_4"),
        (joined_with((1, 6)), None),  # it was joined with nobody but itself, before it was started again
    ],
)
def test_components_that_do_not_know_how_they_lie_have_frames_of_different_names(
    graph: dict[Key, Placed], frame: str | None
) -> None:
    showing, door, mission = a_framed_showing()
    mission.frames.graph = graph
    showing(0.0)
    told = shown(door)
    assert (told["/r2/tf"].transforms[0].header.frame_id if frame else "/r2/tf" not in told) == (
        frame or True
    )


def test_what_the_team_will_see_of_the_plane_is_shown_where_the_robots_own_map_has_it() -> None:
    showing, door, mission = a_framed_showing()
    planning = mission.frame.coarse(planning_factor(0.1))
    at_plane = THERE.place(0.65, 0.35)
    cell = planning.flat(*at_plane) * LAYERS
    showing.agent.rounds.impact = Impact(np.array([cell], np.uint32), np.array([CERTAIN], np.uint8))
    showing(0.0)
    assert "impact" not in shown(door)  # the plane of the round does not have this robot's map
    mission.frames.plane = {mission.frames.key: THERE}
    showing.agent.rounds.decisions += 1
    showing(GRID_PERIOD)
    grid = shown(door)["impact"]
    assert grid.header.frame_id == "map"
    (seen,) = np.flatnonzero(grid.data == 100)
    row, col = divmod(int(seen), grid.info.width)
    side, corner = grid.info.resolution, grid.info.origin.position
    x, y = corner.x + (col + 0.5) * side, corner.y + (row + 0.5) * side
    assert (x, y) == pytest.approx((0.65, 0.35), abs=side)


def test_a_map_that_has_not_changed_is_not_shown_again() -> None:
    showing, door = a_showing()
    showing(0.0)
    shown(door)
    showing(PERIOD / 2)
    assert shown(door) == {}
    showing(2.0 * GRID_PERIOD)
    assert set(shown(door)) == {"tour", "markers", "/diagnostics"}


def test_what_the_team_will_see_is_shown_beside_what_the_robot_itself_will() -> None:
    showing, door = a_showing()
    planning = showing.agent.mission.frame.coarse(planning_factor(0.1))
    cells = planning.cell(0.25, 0.25), planning.cell(1.25, 0.25)
    one, other = (
        Impact(np.array([(row * planning.cols + col) * LAYERS], np.uint32), np.array([CERTAIN], np.uint8))
        for row, col in cells
    )
    showing.agent.rounds.impact = one
    showing.agent.rounds.team_impact = MappingObjective().combine(one, other)
    showing(0.0)
    told = shown(door)
    sure = [int(np.count_nonzero(told[topic].data == 100)) for topic in ("impact", "team_impact")]
    assert sure == [1, 2]
    assert told["impact"].info.resolution == pytest.approx(planning.resolution)
    showing.agent.rounds.decisions += 1  # on the same map
    showing(GRID_PERIOD)
    assert {"impact", "team_impact"} <= set(shown(door))


def test_what_keeps_the_robot_from_its_work_is_a_warning() -> None:
    showing, door = a_showing()
    door.told = [Word.PAUSE]
    showing.body.sense(1.0)
    showing(1.0)
    (status,) = shown(door)["/diagnostics"].status
    assert status.level == 1
    assert "paused" in status.message


@pytest.mark.parametrize(
    ("prefix", "topic", "frames"),
    [("", "/r1/tf_static", ("map", "team")), ("r1/", "/tf_static", ("r1/map", "r1/team"))],
)
def test_the_teams_frame_hangs_from_the_robots_map_by_the_names_that_its_tf_has(
    prefix: str, topic: str, frames: tuple[str, str]
) -> None:
    showing, door = a_showing(prefix, namespace="r1", start=(3.0, 1.0, 90.0))
    showing(0.0)
    told = shown(door)
    (joint,) = told[topic].transforms
    assert (joint.header.frame_id, joint.child_frame_id) == frames
    t = joint.transform.translation
    assert (t.x, t.y) == pytest.approx((-1.0, 3.0))  # the team's origin, from 3, 1 and turned by 90 degrees
    assert told["team_map"].header.frame_id == frames[1]

"""run.mcap: what was recorded is what standard readers get back."""

from __future__ import annotations

import math
from collections import defaultdict
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.reader import make_reader
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from tests.support.places import ROOT
from tests.support.record_mission import frames, mission, rooms, scene
from vedette.errors import InputError
from vedette.maps import FREE, OCCUPIED
from vedette.record.explore.log import ExploreSnapshot
from vedette.record.explore.mcap import OF_OPEN, ExploreMcapWriter
from vedette.record.links import Link
from vedette.record.ros import corners, ros_names
from vedette.team import PlatformSpec

SOLID = rooms(80, 120)
NAMES = ["robot-1", "2nd-robot"]
ORIGIN = (-2.0, 1.0)
FRAME, PLANNING = frames(SOLID, 0.1, ORIGIN)
SCENE = scene("rooms", FRAME, PLANNING, NAMES)


@pytest.fixture(scope="module")
def snapshots() -> list[ExploreSnapshot]:
    specs = [PlatformSpec(name=name, range=2.5) for name in NAMES]
    rng = np.random.default_rng(4)
    run = mission(SOLID, specs, rng, (1.0, 4.0), origin=ORIGIN, limit=23.0, kill=(1, 12.0), radio=2.0)
    return [ExploreSnapshot(**(vars(s) | {"classes": s.classes.copy()})) for s in run]


def _write(path: Path, snapshots: list[ExploreSnapshot]) -> Path:
    with ExploreMcapWriter(path, SCENE) as writer:
        for snapshot in snapshots:
            writer.update(snapshot)
    return path


def _read(path: Path) -> dict[str, list[tuple[float, Any]]]:
    """Return (time, message) by topic, decoded with nothing but the definitions in the file."""
    store = get_typestore(Stores.EMPTY)
    topics: dict[str, list[tuple[float, Any]]] = defaultdict(list)
    with path.open("rb") as stream:
        for schema, channel, message in make_reader(stream).iter_messages():
            assert schema is not None
            assert schema.encoding == "ros2msg"
            types = get_types_from_msg(schema.data.decode(), schema.name)
            store.register({name: kind for name, kind in types.items() if name not in store.types})
            topics[channel.topic].append(
                (message.log_time / 1e9, store.deserialize_cdr(message.data, schema.name))
            )
    return topics


@pytest.fixture(scope="module")
def topics(
    tmp_path_factory: pytest.TempPathFactory, snapshots: list[ExploreSnapshot]
) -> dict[str, list[Any]]:
    return _read(_write(tmp_path_factory.mktemp("mcap") / "run.mcap", snapshots))


def test_maps_come_every_five_seconds_and_at_the_end(
    topics: dict[str, list[Any]], snapshots: list[ExploreSnapshot]
) -> None:
    assert [t for t, _ in topics["/map"]] == [0.0, 5.0, 10.0, 15.0, 20.0, 23.0]
    by_time = {s.t: s for s in snapshots}
    for t, grid in topics["/map"]:
        classes = by_time[t].classes
        expected = np.where(classes == OCCUPIED, 100, np.where(classes == FREE, 0, -1))
        np.testing.assert_array_equal(grid.data.reshape(grid.info.height, grid.info.width), expected)
        assert grid.info.resolution == pytest.approx(0.1)
        assert (grid.info.origin.position.x, grid.info.origin.position.y) == ORIGIN
        assert grid.header.frame_id == "map"
        assert grid.header.stamp.sec + grid.header.stamp.nanosec / 1e9 == t


def test_of_ground_that_nobody_knows_the_metrics_are_area_rate_and_frontiers(
    tmp_path: Path, snapshots: list[ExploreSnapshot]
) -> None:
    nobody_knows = {"coverage": None, "known_fraction": None, "entropy": None}
    told = [
        replace(snapshot, **nobody_knows, known_m2=9.0, frontiers=None if snapshot.t < 2.0 else 3)
        for snapshot in snapshots[:5]
    ]
    topics = _read(_write(tmp_path / "run.mcap", told))
    metrics = {
        name: [(t, message.data) for t, message in topics[name]] for name in topics if "metrics" in name
    }
    assert metrics.keys() == {"/metrics/known_m2", "/metrics/rate_m2_s", "/metrics/frontiers"}
    assert metrics["/metrics/known_m2"][-1] == (told[-1].t, 9.0)
    assert metrics["/metrics/rate_m2_s"][-1] == (told[-1].t, 9.0 / told[-1].t)
    assert metrics["/metrics/frontiers"] == [(s.t, 3.0) for s in told if s.t >= 2.0]


def test_the_team_impact_is_in_per_cent_of_planning_cells(
    topics: dict[str, list[Any]], snapshots: list[ExploreSnapshot]
) -> None:
    t, grid = topics["/team_impact"][1]
    impact = next(s.impact for s in snapshots if s.t == t)
    assert impact is not None
    assert (grid.info.height, grid.info.width) == PLANNING.shape
    np.testing.assert_allclose(grid.data / 100, impact.reshape(-1), atol=0.005 + 1e-6)


def test_poses_and_transforms_follow_living_robots(
    topics: dict[str, list[Any]], snapshots: list[ExploreSnapshot]
) -> None:
    poses = topics["/robot_1/pose"]
    assert len(poses) == len(snapshots)
    for (t, message), snapshot in zip(poses, snapshots, strict=True):
        robot = snapshot.robots[0]
        turn = message.pose.orientation
        assert t == snapshot.t
        assert (message.pose.position.x, message.pose.position.y) == (robot.x, robot.y)
        assert math.cos(2 * math.atan2(turn.z, turn.w) - robot.heading) == pytest.approx(1.0)
    assert [t for t, _ in topics["/robot_2nd_robot/pose"]] == [s.t for s in snapshots if s.robots[1].alive]
    assert [len(message.transforms) for _, message in topics["/tf"]] == [
        sum(robot.alive for robot in s.robots) for s in snapshots
    ]
    last = topics["/tf"][-1][1].transforms[0]
    assert (last.header.frame_id, last.child_frame_id) == ("map", "robot_1/base_link")
    assert last.transform.translation.x == snapshots[-1].robots[0].x


def test_plans_and_states_are_written_when_they_change(
    topics: dict[str, list[Any]], snapshots: list[ExploreSnapshot]
) -> None:
    states = [s.robots[1].state for s in snapshots]
    changes = [b for a, b in zip([None, *states], states, strict=False) if a != b]
    assert [message.data for _, message in topics["/robot_2nd_robot/state"]] == changes
    t, path = topics["/robot_1/path"][1]
    expected = next(s.robots[0].path for s in snapshots if s.t == t)
    points = np.array([(p.pose.position.x, p.pose.position.y) for p in path.poses])
    np.testing.assert_array_equal(points, corners(expected))
    _, goal = topics["/robot_1/goal"][0]
    assert (goal.pose.position.x, goal.pose.position.y) == snapshots[0].robots[0].goal


def test_metrics_hold_every_snapshot(topics: dict[str, list[Any]], snapshots: list[ExploreSnapshot]) -> None:
    for name in ("coverage", "known_fraction", "entropy"):
        assert [message.data for _, message in topics[f"/metrics/{name}"]] == [
            getattr(s, name) for s in snapshots
        ]


def test_links_are_lines_between_robots_those_of_the_tree_apart(
    topics: dict[str, list[Any]], snapshots: list[ExploreSnapshot]
) -> None:
    assert [t for t, _ in topics["/links"]] == [s.t for s in snapshots]
    assert 0 < sum(bool(s.links) for s in snapshots) < len(snapshots)
    for (_, message), snapshot in zip(topics["/links"], snapshots, strict=True):
        tree, other = message.markers
        assert (tree.ns, other.ns) == ("tree", "other")
        assert (tree.header.frame_id, tree.type, tree.pose.orientation.w) == ("map", tree.LINE_LIST, 1.0)
        assert tree.action == (tree.ADD if snapshot.links else tree.DELETE)
        assert other.action == other.DELETE
        places = [(robot.x, robot.y) for robot in snapshot.robots] if snapshot.links else []
        assert [(point.x, point.y) for point in tree.points] == places
        assert len(tree.colors) == len(places)


def test_the_more_a_link_loses_the_paler_is_its_line(
    tmp_path: Path, snapshots: list[ExploreSnapshot]
) -> None:
    links = Link(0, 1, True, 0.0), Link(0, 1, False, 0.0), Link(0, 1, False, 1.0)
    linked = ExploreSnapshot(**(vars(snapshots[0]) | {"links": links}))
    _, message = _read(_write(tmp_path / "run.mcap", [linked]))["/links"][0]
    tree, other = message.markers
    alphas = [colour.a for colour in (*tree.colors, *other.colors)]
    assert alphas[::2] == alphas[1::2]
    assert alphas[0] == 1.0 > alphas[2] > alphas[4] > 0.0


def test_an_ideal_network_has_no_links_to_show(tmp_path: Path, snapshots: list[ExploreSnapshot]) -> None:
    ideal = ExploreSnapshot(**(vars(snapshots[0]) | {"links": None}))
    assert "/links" not in _read(_write(tmp_path / "run.mcap", [ideal]))


def test_the_documentation_lists_exactly_the_topics(topics: dict[str, list[Any]]) -> None:
    docs = (ROOT / "docs" / "outputs.md").read_text(encoding="utf-8")
    docs = docs.partition("\n## `run.mcap`")[2].partition("\n## ")[0]
    listed = {line.split("`")[1] for line in docs.splitlines() if line.startswith("| `/")}
    written = {topic.replace("robot_1", "<robot>") for topic in topics if "2nd" not in topic}
    assert listed == written | {f"/metrics/{name}" for name in OF_OPEN}


def test_the_same_mission_gives_the_same_bytes(tmp_path: Path, snapshots: list[ExploreSnapshot]) -> None:
    one, two = (_write(tmp_path / name, snapshots).read_bytes() for name in ("one.mcap", "two.mcap"))
    assert one == two


def test_an_interrupted_mission_leaves_a_valid_file(tmp_path: Path, snapshots: list[ExploreSnapshot]) -> None:
    path = tmp_path / "run.mcap"

    def interrupted() -> None:
        with ExploreMcapWriter(path, SCENE) as writer:
            for snapshot in snapshots:
                assert not path.exists()
                writer.update(snapshot)
                if snapshot.t == 7.0:
                    raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert [t for t, _ in _read(path)["/map"]] == [0.0, 5.0, 7.0]
    assert [entry.name for entry in tmp_path.iterdir()] == ["run.mcap"]


def test_the_last_map_is_the_one_that_was_handed_over(
    tmp_path: Path, snapshots: list[ExploreSnapshot]
) -> None:
    path = tmp_path / "run.mcap"
    writer = ExploreMcapWriter(path, SCENE)
    writer.update(snapshots[0])
    reused = ExploreSnapshot(**(vars(snapshots[1]) | {"classes": snapshots[1].classes.copy()}))
    writer.update(reused)
    reused.classes[:] = OCCUPIED
    writer.close()
    writer.close()
    expected = np.where(snapshots[1].classes == OCCUPIED, 100, np.where(snapshots[1].classes == FREE, 0, -1))
    np.testing.assert_array_equal(_read(path)["/map"][-1][1].data, expected.reshape(-1))


def test_a_folder_that_does_not_exist_is_bad_input(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"cannot write .*run\.mcap"):
        ExploreMcapWriter(tmp_path / "none" / "run.mcap", SCENE)


def test_corners_keep_the_shape_of_a_path() -> None:
    path = np.array([(0, 0), (1, 0), (2, 0), (3, 1), (4, 2), (3, 1), (3, 1)], float)
    np.testing.assert_array_equal(corners(path), [(0, 0), (2, 0), (4, 2), (3, 1), (3, 1)])
    assert corners(np.empty((0, 2))).shape == (0, 2)


def test_ros_names_are_valid_and_distinct() -> None:
    assert ros_names(["robot-1", "robot_1", "3", "é", "a/b"]) == [
        "robot_1",
        "robot_1_2",
        "robot_3",
        "robot",
        "a_b",
    ]

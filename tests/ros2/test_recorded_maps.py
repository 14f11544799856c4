"""Recordings of a robot's own map: each version takes the place of the one before, wherever it lies."""

from __future__ import annotations

import json
from dataclasses import replace
from math import radians
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from tests.support.commands import Command, refused
from tests.support.recordings import carmen_log
from tests.support.ros_recordings import Told, grid, joint, message, patch, tour, write_folder
from vedette.errors import InputError
from vedette.maps import FREE, OCCUPIED, UNKNOWN, GridFrame, read_map
from vedette.maps.laid import laid
from vedette.maps.world import World
from vedette.record.replay.summary import Replayed
from vedette.ros2.bag import read_bag
from vedette.ros2.settings import Ros2Settings
from vedette.sim.replay.run import Replay, ReplaySetup
from vedette.sim.worlds import logged, maze


@pytest.fixture(scope="module")
def building() -> World:
    return maze(np.random.default_rng(4), 11.0, 10.0)


@pytest.fixture
def vedette(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Command:
    monkeypatch.chdir(tmp_path)
    return Command(monkeypatch, capsys)


def growing(world: World, parts: int = 6) -> list[Told]:
    """A map that grows column by column, seen from places on the way, for lack of TF by nobody's."""
    told: list[Told] = []
    for k in range(1, parts + 1):
        classes = world.classes().copy()
        classes[:, world.frame.cols * k // parts :] = UNKNOWN
        told.append((2.0 * k, "/map", grid(2.0 * k, classes, world.frame)))
    return told


def agrees(replayed: Replayed, world: World) -> bool:
    """Tell whether the map is the building's, cell for cell."""
    held = laid(replayed.classes, replayed.frame, world.frame)
    return np.array_equal(held, world.classes())


@pytest.mark.parametrize("robots", [1, 3])
def test_a_map_without_tf_goes_through_one_agent_or_several_and_is_what_the_last_version_was(
    building: World, tmp_path: Path, robots: int
) -> None:
    log = read_bag(write_folder(tmp_path / "slam", growing(building)), Ros2Settings())
    assert (len(log.scans), len(log.maps)) == (0, 6)
    assert log.way == 0.0
    replayed = Replay(log, ReplaySetup(robots)).run()
    assert (replayed.complete, replayed.agreed) == (True, True)
    assert agrees(replayed, building)
    assert not replayed.counts.any()


def test_what_an_older_version_said_is_taken_back(building: World, tmp_path: Path) -> None:
    frame = building.frame
    wrong = replace(frame, origin_x=frame.origin_x + 0.5)
    told: list[Told] = [
        (1.0, "/map", grid(1.0, building.classes(), wrong, radians(5.0))),
        (4.0, "/map", grid(4.0, building.classes(), frame)),
    ]
    log = read_bag(write_folder(tmp_path / "slam", told), Ros2Settings())
    first = Replay(replace(log, maps=log.maps[:1]), ReplaySetup()).run()
    assert not agrees(first, building)
    assert agrees(Replay(log, ReplaySetup()).run(), building)


def test_where_the_last_versions_of_two_robots_differ_what_is_occupied_is_believed(
    building: World, tmp_path: Path
) -> None:
    wrong = building.classes().copy()
    wrong[20:24, 20:24] = np.where(wrong[20:24, 20:24] == FREE, OCCUPIED, FREE)
    told: list[Told] = [
        (1.0, "/map", grid(1.0, wrong, building.frame)),
        (4.0, "/map", grid(4.0, building.classes(), building.frame)),
    ]
    log = read_bag(write_folder(tmp_path / "slam", told), Ros2Settings())
    replayed = Replay(log, ReplaySetup(robots=2)).run()
    held = laid(replayed.classes, replayed.frame, building.frame)
    expected = building.classes().copy()
    expected[20:24, 20:24] = OCCUPIED
    assert replayed.agreed
    np.testing.assert_array_equal(held, expected)


def test_updates_are_cells_of_the_map_before_and_the_last_is_never_left_out(
    building: World, tmp_path: Path
) -> None:
    empty = np.full(building.frame.shape, UNKNOWN, np.uint8)
    told: list[Told] = [(0.0, "/map", grid(0.0, empty, building.frame))]
    for k, row in enumerate(range(0, building.frame.rows, 20)):
        now = 0.2 * (k + 1)  # more often than versions are kept
        told.append((now, "/map_updates", patch(now, building.classes()[row : row + 20], row, 0)))
    log = read_bag(write_folder(tmp_path / "slam", told), Ros2Settings())
    assert len(log.maps) < len(told)
    assert agrees(Replay(log, ReplaySetup()).run(), building)


def test_a_map_lies_where_tf_has_its_frame_and_its_robot_where_tf_has_that(
    building: World, tmp_path: Path
) -> None:
    frame = building.frame
    told: list[Told] = [(0.0, "/tf_static", joint(0.0, "map", "grid", 30.0, -7.0, radians(90.0)))]
    for k in range(3):
        told.append((1.0 + k, "/tf", joint(1.0 + k, "map", "base_link", 3.0 * k, 4.0 * k, 0.3)))
        told.append((1.1 + k, "/robot/map", grid(1.1 + k, building.classes(), frame, name="grid")))
    log = read_bag(write_folder(tmp_path / "slam", told), Ros2Settings(namespace="robot"))
    assert log.way == pytest.approx(10.0)
    assert log.maps[-1].pose == pytest.approx((6.0, 8.0, 0.3))
    replayed = Replay(log, ReplaySetup()).run()
    x, y = 30.0 - frame.origin_y - frame.rows * 0.1, -7.0 + frame.origin_x
    there = GridFrame(0.1, frame.cols, frame.rows, x, y)
    expected = building.classes().T[:, ::-1]  # a quarter of a turn, counter-clockwise
    np.testing.assert_array_equal(laid(replayed.classes, replayed.frame, there), expected)
    way = replayed.ways[0]
    np.testing.assert_allclose(way, [(0.0, 0.0), (3.0, 4.0), (6.0, 8.0)], atol=1e-6)


def test_the_command_leaves_map_picture_and_figures_and_no_measurement_that_nobody_made(
    vedette: Command, building: World, tmp_path: Path
) -> None:
    write_folder(tmp_path / "slam", growing(building))
    ran = vedette("replay", "slam", "--robots", 2, "--out", "out")
    assert ran.status == 0
    assert ran.out.startswith("slam: 6 maps over 0 m, ")
    assert "observation" not in ran.out
    assert {path.name for path in Path("out").iterdir()} == {
        "summary.json", "slam.yaml", "slam.pgm", "slam.png"
    }  # fmt: skip
    (told,) = json.loads(Path("out/summary.json").read_text())["buildings"]
    assert (told["scans"], told["maps"], told["agreed"], told["observation"]) == (0, 6, True, [])
    frame, classes = read_map(Path("out/slam.yaml"))
    np.testing.assert_array_equal(laid(classes, frame, building.frame), building.classes())


def test_the_folder_in_which_one_stands_has_its_name(
    vedette: Command, building: World, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(write_folder(tmp_path / "slam", growing(building)))
    ran = vedette("replay", ".", "--out", "../out")
    assert (ran.status, ran.out[:5]) == (0, "slam:")
    assert (tmp_path / "out" / "slam.yaml").exists()


def test_scans_and_maps_are_replayed_beside_each_other(
    vedette: Command, building: World, tmp_path: Path
) -> None:
    write_folder(tmp_path / "slam", growing(building))
    (tmp_path / "walk.log").write_text(carmen_log(building, 3.0))
    ran = vedette("replay", "slam", "walk.log", "--out", "out")
    assert ran.status == 0
    assert Path("out/observation.png").exists()


def test_a_world_is_made_of_the_last_map(building: World, tmp_path: Path, vedette: Command) -> None:
    log = read_bag(write_folder(tmp_path / "slam", growing(building)), Ros2Settings())
    made = logged(log, 0.1, 20.0, "ignore")
    held = laid((~made.solid).astype(np.uint8), made.frame, building.frame)
    np.testing.assert_array_equal(held == 1, ~building.solid)
    ran = vedette("world", "log", "slam", "--out", "world")
    assert ran.status == 0
    ran = vedette("explore", "world/map.yaml", "--robots", 2, "--max-time", 5, "--json", "--out", "run")
    assert ran.status == 1
    assert json.loads(ran.out)["outcome"] == "time_limit"


def test_a_recording_of_both_is_scans_unless_the_map_is_asked_for(building: World, tmp_path: Path) -> None:
    folder = write_folder(tmp_path / "both", [*tour(building, 2.0), *growing(building)])
    assert not read_bag(folder, Ros2Settings()).maps
    log = read_bag(folder, Ros2Settings(), "map")
    assert not log.scans
    assert len(log.maps) == 6
    assert log.way > 10.0


def told_grid(classes: NDArray[np.uint8], frame: GridFrame, **info: object) -> list[Told]:
    """A map whose message says something else of it."""
    made = grid(1.0, classes, frame)
    for name, value in info.items():
        setattr(made.info, name, value)
    return [(1.0, "/map", made)]


HALL = GridFrame(0.1, 30, 40)
CLASSES = np.full(HALL.shape, FREE, np.uint8)
TF = (0.0, "/tf", joint(0.0, "a", "b", 0.0, 0.0, 0.0))
FAR = message(
    "geometry_msgs/msg/Pose",
    message("geometry_msgs/msg/Point", float("inf"), 0.0, 0.0),
    message("geometry_msgs/msg/Quaternion", 0.0, 0.0, 0.0, 1.0),
)


@pytest.mark.parametrize(
    ("told", "settings", "evidence", "said"),
    [
        ([TF], {}, None, "no topic of sensor_msgs/msg/LaserScan in it"),
        ([TF], {}, "map", "no topic of nav_msgs/msg/OccupancyGrid"),
        ([(1.0, "/map", grid(1.0, CLASSES, HALL))], {}, "scan", "maps are: give --evidence map"),
        ([(1.0, "/slam/map", grid(1.0, CLASSES, HALL))], {}, None, "did you mean '/slam/map'?: give --map"),
        ([(1.0, "/map", grid(1.0, CLASSES, HALL))], {"map_frame": "odo"}, None, "joins no map's frame map"),
        (told_grid(CLASSES, HALL, width=41), {}, None, "no map on map has as many cells as it says"),
        (told_grid(CLASSES, HALL, resolution=float("inf")), {}, None, "no map on map has as many cells as"),
        (told_grid(CLASSES, HALL, origin=FAR), {}, None, "no map on map has as many cells as it says"),
        ([(1.0, "/map_updates", patch(1.0, CLASSES, 0, 0))], {}, "map", "no topic of nav_msgs/msg/Occ"),
    ],
)  # fmt: skip
def test_what_a_map_lacks_is_told_with_its_remedy(
    tmp_path: Path, told: list[Told], settings: dict[str, str], evidence: str | None, said: str
) -> None:
    folder = write_folder(tmp_path / "slam", told)
    with pytest.raises(InputError) as refusal:
        read_bag(folder, Ros2Settings(**settings), evidence)
    assert said in str(refusal.value)
    assert "\n" not in str(refusal.value)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (
            ("replay", "slam", "--fusion", "channel"),
            "--fusion channel cannot take back what an older",
        ),
        (("replay", "slam", "--robots", "7"), "slam has 6 maps, too few for 7 robots"),
        (("replay", "slam", "--evidence", "mop"), "did you mean 'map'?"),
        (("replay", "slam", "--map", "a b"), "--map must be a name as ROS has them"),
        (
            ("replay", "walk.log", "--evidence", "map"),
            "--evidence map is of ROS 2 recordings, and walk",
        ),
        (
            ("replay", "walk.log", "--map-frame", "world"),
            "--map-frame world is of ROS 2 recordings, and walk",
        ),
        (("world", "log", "walk.log", "--scan", "front"), "--scan front is of ROS 2 recordings, and walk"),
        (("replay", "blank"), "blank: nothing of its maps is known"),
        (("world", "log", "blank"), "blank: its map leaves nothing free"),
        (("world", "office", "--evidence", "map"), "--evidence is of recordings; leave it out"),
    ],
)
def test_bad_input_is_told_in_a_line_and_leaves_nothing(
    vedette: Command, building: World, tmp_path: Path, words: tuple[str, ...], said: str
) -> None:
    write_folder(tmp_path / "slam", growing(building))
    nothing = np.full(HALL.shape, UNKNOWN, np.uint8)
    write_folder(tmp_path / "blank", [(1.0, "/map", grid(1.0, nothing, HALL))])
    (tmp_path / "walk.log").write_text("\n".join(carmen_log(building, 4.0).splitlines()[:20]))
    refused(vedette(*words, "--out", "out"), said)
    assert not (tmp_path / "out").exists()

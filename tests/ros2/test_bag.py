"""A recording of ROS 2 is read as the robot's agent would have taken it in."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from rosbags.rosbag2 import StoragePlugin

from tests.support.recordings import places
from tests.support.ros_recordings import tour, write_folder
from vedette.errors import InputError
from vedette.logs import RecordedLog
from vedette.maps.world import World
from vedette.ros2.bag import read_bag
from vedette.ros2.settings import Ros2Settings
from vedette.sim.worlds import logged, maze

Make = Callable[..., Path]


@pytest.fixture(scope="module")
def building() -> World:
    return maze(np.random.default_rng(4), 11.0, 10.0)


@pytest.fixture
def recorded(building: World, tmp_path: Path) -> Make:
    """Writes a recording of a tour, its topics renamed and some left out."""

    def make(storage: StoragePlugin = StoragePlugin.MCAP, rename: str = "", leave_out: str = "none") -> Path:
        told = [(now, rename + topic, each) for now, topic, each in tour(building) if topic != leave_out]
        return write_folder(tmp_path / "walk", told, storage)

    return make


def check_building(log: RecordedLog, building: World) -> None:
    assert log.range == 8.0
    made = logged(log, 0.1, 8.0, "ignore")
    free, true = np.count_nonzero(~made.solid), np.count_nonzero(~building.solid)
    assert 0.95 * true < free < 1.02 * true


@pytest.mark.parametrize("storage", list(StoragePlugin))
def test_a_rosbag_gives_the_building_that_was_recorded(
    recorded: Make, building: World, storage: StoragePlugin
) -> None:
    check_building(read_bag(recorded(storage), Ros2Settings()), building)


def test_an_mcap_file_alone_gives_the_same_scans_as_its_folder(recorded: Make, building: World) -> None:
    folder = recorded()
    (file,) = folder.glob("*.mcap")
    one, other = read_bag(folder, Ros2Settings()), read_bag(file, Ros2Settings())
    assert len(one.scans) == len(other.scans) > 50
    for a, b in zip(one.scans, other.scans, strict=True):
        assert (a.x, a.y, a.heading) == (b.x, b.y, b.heading)
        np.testing.assert_array_equal(a.ranges, b.ranges)


def test_a_scan_is_from_where_the_lidar_was(recorded: Make, building: World) -> None:
    log = read_bag(recorded(), Ros2Settings())
    expected = places(building, 1.0)
    assert len(log.scans) == pytest.approx(len(expected), abs=2)
    for each in log.scans:
        assert np.hypot(*(expected - (each.x, each.y)).T).min() < 1e-6


def test_a_robots_own_topics_are_read_by_its_namespace(recorded: Make, building: World) -> None:
    log = read_bag(recorded(rename="/robot_1"), Ros2Settings(namespace="robot_1"))
    check_building(log, building)


@pytest.mark.parametrize(
    ("recording", "settings", "told"),
    [
        ({"leave_out": "/scan"}, {}, "no topic of sensor_msgs/msg/LaserScan in it"),
        ({}, {"scan": "scann"}, "nothing on scann; did you mean '/scan'\\?: give --scan"),
        ({"leave_out": "/tf"}, {}, "TF joins no scan's frame laser to map; frames told of: base_link, laser"),
        ({}, {"map_frame": "world"}, "TF joins no scan's frame laser to world; .*give --map-frame"),
    ],
)
def test_what_is_missing_is_told_with_its_remedy(
    recorded: Make, recording: dict[str, str], settings: dict[str, str], told: str
) -> None:
    with pytest.raises(InputError, match=told):
        read_bag(recorded(**recording), Ros2Settings(**settings))


def test_what_is_no_recording_is_told_in_a_line(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"no metadata\.yaml in it; give a rosbag2 folder or an MCAP file"):
        read_bag(tmp_path, Ros2Settings())
    (tmp_path / "x.mcap").write_bytes(b"nothing of the kind")
    with pytest.raises(InputError, match=r"cannot read recording .*x\.mcap"):
        read_bag(tmp_path / "x.mcap", Ros2Settings())
    (tmp_path / "metadata.yaml").write_text("rosbag2_bagfile_information: {}")
    with pytest.raises(InputError, match="cannot read recording"):
        read_bag(tmp_path, Ros2Settings())

"""However a recording is stored and compressed, it gives the same; of whatever is broken one line tells."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest
from mcap.writer import CompressionType
from rosbags.rosbag2 import CompressionMode, StoragePlugin

from tests.support.recordings import carmen_log
from tests.support.ros_recordings import Told, joint, scan, tour, write_folder, write_mcap
from vedette.cli.recordings import recording
from vedette.errors import InputError
from vedette.logs import RecordedLog
from vedette.maps.world import World
from vedette.ros2.bag import read_bag
from vedette.ros2.settings import Ros2Settings
from vedette.sim.worlds import maze


@pytest.fixture(scope="module")
def building() -> World:
    return maze(np.random.default_rng(4), 10.0, 10.0)


@pytest.fixture(scope="module")
def told(building: World) -> list[Told]:
    return tour(building, 2.0)


@pytest.fixture(scope="module")
def plain(told: list[Told], tmp_path_factory: pytest.TempPathFactory) -> RecordedLog:
    folder = write_folder(tmp_path_factory.mktemp("bags") / "plain", told)
    return read_bag(folder, Ros2Settings())


def same(one: RecordedLog, other: RecordedLog) -> bool:
    return len(one.scans) == len(other.scans) > 3 and all(
        (a.time, a.x, a.y) == (b.time, b.x, b.y) and np.array_equal(a.ranges, b.ranges, equal_nan=True)
        for a, b in zip(one.scans, other.scans, strict=True)
    )


@pytest.mark.parametrize(
    ("storage", "compressed"),
    [
        (StoragePlugin.SQLITE3, None),
        (StoragePlugin.SQLITE3, CompressionMode.FILE),
        (StoragePlugin.SQLITE3, CompressionMode.MESSAGE),
        (StoragePlugin.MCAP, None),
        (StoragePlugin.MCAP, CompressionMode.FILE),
        (StoragePlugin.MCAP, CompressionMode.MESSAGE),
        (StoragePlugin.MCAP, CompressionMode.STORAGE),
    ],
)
def test_a_folder_gives_the_same_however_it_is_stored(
    told: list[Told],
    plain: RecordedLog,
    tmp_path: Path,
    storage: StoragePlugin,
    compressed: CompressionMode | None,
) -> None:
    assert same(plain, read_bag(write_folder(tmp_path / "bag", told, storage, compressed), Ros2Settings()))


@pytest.mark.parametrize("compression", list(CompressionType))
def test_an_mcap_file_gives_the_same_however_its_chunks_are_compressed(
    told: list[Told], plain: RecordedLog, tmp_path: Path, compression: CompressionType
) -> None:
    assert same(plain, read_bag(write_mcap(tmp_path / "walk.mcap", told, compression), Ros2Settings()))


def read_or_refused(path: Path) -> str | None:
    """Read a recording; None: it gave something, else the one line that was told."""
    try:
        recording(path, "ignore", None)
    except InputError as error:
        said = str(error)
    else:
        return None
    assert "\n" not in said
    assert path.name in said
    return said


@pytest.mark.parametrize("compression", list(CompressionType))
def test_an_mcap_file_that_is_cut_off_anywhere_is_told_in_a_line_or_gives_what_there_is(
    told: list[Told], tmp_path: Path, compression: CompressionType
) -> None:
    whole = write_mcap(tmp_path / "whole.mcap", told, compression).read_bytes()
    said = []
    for length in np.linspace(0, len(whole) - 1, 12).astype(int).tolist():
        (tmp_path / "cut.mcap").write_bytes(whole[:length])
        said.append(read_or_refused(tmp_path / "cut.mcap"))
    assert any("cannot read recording" in (line or "") for line in said)


@pytest.mark.parametrize("storage", list(StoragePlugin))
@pytest.mark.parametrize("compressed", [None, CompressionMode.FILE, CompressionMode.MESSAGE])
def test_damage_is_told_in_a_line(
    told: list[Told], tmp_path: Path, storage: StoragePlugin, compressed: CompressionMode | None
) -> None:
    folder = write_folder(tmp_path / "bag", told, storage, compressed)
    (file,) = (path for path in folder.iterdir() if path.name != "metadata.yaml")
    whole, rng, said = file.read_bytes(), np.random.default_rng(7), []
    for _ in range(12):
        broken = np.frombuffer(whole, np.uint8).copy()
        broken[rng.integers(0, len(broken), 40)] ^= rng.integers(1, 256, 40, dtype=np.uint8)
        file.write_bytes(broken.tobytes())
        said.append(read_or_refused(folder))
    file.write_bytes(whole[: len(whole) // 2])
    said.append(read_or_refused(folder))
    file.unlink()
    assert read_or_refused(folder) is not None
    assert any(said)


@pytest.mark.parametrize(
    ("field", "value", "said"),
    [
        ("ranges", np.zeros(0, np.float32), "/scan: ranges has 0 beams; a lidar has at least 2"),
        ("angle_increment", np.inf, "/scan: angle_increment is inf; it must be a number other than 0"),
        ("angle_increment", 0.0, "/scan: angle_increment is 0; it must be a number other than 0"),
        ("range_max", np.nan, "/scan: range_max is nan m; it must be a number above 0"),
    ],
)
def test_a_scan_that_is_none_is_told_with_its_topic_and_field(
    tmp_path: Path, field: str, value: object, said: str
) -> None:
    made = scan(1.0, np.full(360, 3.0))
    setattr(made, field, value)
    folder = write_folder(tmp_path / "walk", [(1.0, "/scan", made)])
    assert read_or_refused(folder) == f"{folder}: {said}"


@pytest.mark.parametrize("x", [np.nan, np.inf, 1e300])
def test_a_transform_that_leads_nowhere_joins_nothing(tmp_path: Path, x: float) -> None:
    told: list[Told] = [
        (0.0, "/tf_static", joint(0.0, "map", "laser", x, 0.0, 0.0)),
        (1.0, "/scan", scan(1.0, np.full(360, 3.0))),
    ]
    assert "TF joins no scan's frame laser to map" in (
        read_or_refused(write_folder(tmp_path / "walk", told)) or ""
    )


def test_what_is_no_recording_is_called_by_its_name(
    told: list[Told], building: World, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    folder = write_folder(tmp_path / "bag", told, StoragePlugin.SQLITE3)
    (database,) = folder.glob("*.db3")
    (tmp_path / "walk.bag").write_bytes(b"#ROSBAG V2.0\n" + bytes(100))
    (tmp_path / "log.mcap").write_text(carmen_log(building, 5.0))
    shutil.copy(write_mcap(tmp_path / "walk.mcap", told, CompressionType.NONE), tmp_path / "walk.log")
    (tmp_path / "empty.mcap").touch()
    (tmp_path / "empty").mkdir()
    (tmp_path / "wrong").mkdir()
    (tmp_path / "wrong" / "metadata.yaml").write_text("- no\n- metadata: [")
    for path, line in {
        database: "is a file of a rosbag2 folder; give the folder",
        Path("walk.bag"): "is a bag of ROS 1; convert it: rosbags-convert --src walk.bag --dst walk",
        Path("walk.log"): "is an MCAP file; name it walk.mcap",
        Path("log.mcap"): "cannot read recording log.mcap",
        Path("empty.mcap"): "cannot read recording empty.mcap",
        Path("empty"): "empty: no metadata.yaml in it; give a rosbag2 folder or an MCAP file",
        Path("wrong"): "cannot read recording wrong",
        Path("nowhere.mcap"): "cannot read recording nowhere.mcap: No such file",
        Path("nowhere"): "cannot read log nowhere: No such file",
    }.items():
        assert line in (read_or_refused(path) or ""), path

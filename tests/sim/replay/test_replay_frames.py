"""Shares of a log in frames that nobody knows: joined where they have enough in common, else left apart."""

from __future__ import annotations

import json
import math
import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.support.commands import Command, refused
from tests.support.places import ROOT
from tests.support.recordings import carmen_log, flaser, ranges_from
from tests.support.ros_recordings import tour, write_folder
from tests.support.small_missions import small_maze, small_office
from vedette.align import FramePose
from vedette.errors import InputError
from vedette.logs import RecordedLog, RecordedMap, RecordedScan, read_carmen
from vedette.maps import FREE, OCCUPIED, UNKNOWN, read_map
from vedette.maps.laid import laid
from vedette.maps.world import World
from vedette.record.replay.summary import Replayed
from vedette.ros2.bag import read_bag
from vedette.ros2.settings import Ros2Settings
from vedette.sim.replay.field import in_frame
from vedette.sim.replay.run import Replay, ReplaySetup

LOGS = Path(os.environ.get("LOGS", ROOT.parent / "shared" / "logs"))
RIGHT = 0.1, 0.5  # a join of these small buildings is no farther off [m], [deg]


@pytest.fixture
def vedette(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Command:
    monkeypatch.chdir(tmp_path)
    return Command(monkeypatch, capsys)


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> RecordedLog:
    path = tmp_path_factory.mktemp("logs") / "office.log"
    path.write_text(carmen_log(small_office()))
    return read_carmen(path)


@pytest.fixture(scope="module")
def joined(recorded: RecordedLog) -> Replayed:
    """Two shares of an office, joined."""
    return Replay(recorded, ReplaySetup(2, frames="unknown", seed=3)).run()


def wrong(replayed: Replayed, world: World) -> float:
    """Share of the known cells that are others in the building, none of whose neighbours is like them."""
    told, true = laid(replayed.classes, replayed.frame, world.frame), world.classes()
    padded = np.pad(true, 1, mode="edge")
    rows, cols = true.shape
    near = [padded[i : i + rows, j : j + cols] == told for i in range(3) for j in range(3)]
    known = told != UNKNOWN
    return float(np.mean(~np.any(near, axis=0)[known]))


def test_shares_find_each_others_frames_and_draw_the_building(joined: Replayed) -> None:
    found = joined.frames
    assert found is not None
    assert found.components == (("robot-1", "robot-2"),)
    assert found.error_m is not None
    assert found.error_deg is not None
    assert found.error_m <= RIGHT[0]
    assert found.error_deg <= RIGHT[1]
    assert (joined.complete, joined.agreed, joined.unjoined) == (True, True, frozenset())
    assert wrong(joined, small_office()) <= 0.01
    free = np.count_nonzero(joined.classes == FREE)
    assert free > 0.9 * np.count_nonzero(
        ~small_office().solid
    )  # walls lie askew: a cell beside them is theirs


def test_the_same_seed_gives_the_same_bytes_and_another_one_other_frames(
    recorded: RecordedLog, joined: Replayed
) -> None:
    again = Replay(recorded, ReplaySetup(2, frames="unknown", seed=3)).run()
    np.testing.assert_array_equal(again.classes, joined.classes)
    assert again.frames == joined.frames
    one, other = (Replay(recorded, ReplaySetup(2, frames="unknown", seed=seed)).frames for seed in (3, 4))
    assert one is not None
    assert other is not None
    assert all(a != b for a, b in zip(one, other, strict=True))


def test_shares_of_two_buildings_are_left_apart_and_the_map_is_of_one(
    recorded: RecordedLog, tmp_path: Path
) -> None:
    path = tmp_path / "maze.log"
    path.write_text(carmen_log(small_maze()))
    maze = read_carmen(path).scans
    count = min(len(maze), len(recorded.scans))
    there = [in_frame(scan, FramePose(60.0, 0.0, 0.5)) for scan in maze[:count]]
    log = replace(recorded, scans=(*recorded.scans[:count], *there))
    replayed = Replay(log, ReplaySetup(2, frames="unknown")).run()
    assert replayed.frames is not None
    assert replayed.frames.components == (("robot-1",), ("robot-2",))
    assert (replayed.frames.joins, replayed.frames.error_m) == ((), None)
    assert replayed.unjoined == frozenset({"robot-1", "robot-2"}) - {replayed.whose}
    free = np.count_nonzero(replayed.classes == FREE) * 0.01
    assert free < 0.01 * max(np.count_nonzero(~world.solid) for world in (small_office(), small_maze())) + 5.0


def test_what_is_told_in_another_frame_is_of_the_same_places(recorded: RecordedLog) -> None:
    there = FramePose.of(3.0, -7.0, 2.5)
    scan = recorded.scans[5]
    moved = in_frame(scan, there)
    assert isinstance(moved, RecordedScan)
    hit = np.isfinite(scan.ranges)
    ends = [
        np.column_stack(
            (each.x + each.ranges * np.cos(each.angles), each.y + each.ranges * np.sin(each.angles))
        )
        for each in (scan, moved)
    ]
    np.testing.assert_allclose(there.places(ends[0][hit]), ends[1][hit], atol=1e-9)
    own = RecordedMap(0.0, np.full((4, 6), FREE, np.uint8), 0.5, (1.0, 2.0, 0.3))
    laid_elsewhere = in_frame(own, there)
    assert isinstance(laid_elsewhere, RecordedMap)
    np.testing.assert_allclose(there.places(own.corners), laid_elsewhere.corners, atol=1e-9)
    assert laid_elsewhere.pose is None


def test_a_recording_of_ros_2_is_cut_and_joined_as_a_log_is(tmp_path: Path) -> None:
    log = read_bag(write_folder(tmp_path / "walk", tour(small_office())), Ros2Settings(no_return="free"))
    found = Replay(log, ReplaySetup(2, no_return="free", frames="unknown")).run().frames
    assert found is not None
    assert found.components == (("robot-1", "robot-2"),)
    assert found.error_m is not None
    assert found.error_m <= RIGHT[0]


def standing(world: World, count: int, stamp: float | None = None) -> str:
    """A log of a robot that stands, and looks the same way."""
    angles = np.radians(np.arange(-90.0, 90.0, 1.0))
    place = (1.0, 7.0, 0.0)
    ranges = ranges_from(world, *place, angles).tolist()
    return "\n".join(flaser(ranges, *place, float(k) if stamp is None else stamp) for k in range(count))


@pytest.mark.parametrize(
    "told",
    [
        pytest.param(carmen_log(small_office(), 2.0) + standing(small_office(), 60), id="one stands"),
        pytest.param(standing(small_office(), 40, 5.0), id="all stand, with equal stamps"),
        pytest.param(
            "\n".join(flaser([81.91] * 180, 0.1 * k, 0.0, 0.0, float(k)) for k in range(20)),
            id="sees nothing",
        ),
        pytest.param(
            "\n".join(flaser([2.0] * 180, 50.0 * k, 0.0, 0.0, float(k)) for k in range(12)), id="leaps about"
        ),
    ],
)
def test_odd_logs_go_through(tmp_path: Path, told: str) -> None:
    path = tmp_path / "odd.log"
    path.write_text(told)
    replayed = Replay(read_carmen(path), ReplaySetup(2, frames="unknown")).run()
    assert replayed.complete
    assert replayed.frames is not None
    assert replayed.frames.error_m is None or replayed.frames.error_m <= RIGHT[0]


def test_a_share_that_does_not_fit_in_its_frame_is_refused_in_a_line(tmp_path: Path) -> None:
    path = tmp_path / "long.log"
    path.write_text("\n".join(flaser([2.0] * 180, 15.0 * k, 0.0, 0.0, float(k)) for k in range(52)))
    log = read_carmen(path)
    with pytest.raises(InputError, match=r"long: a robot's share is of 7.. x . m, and in a frame of its own"):
        Replay(log, ReplaySetup(1, reach=8.0, frames="unknown"))
    Replay(log, ReplaySetup(2, reach=8.0, frames="unknown"))


def test_the_command_says_who_is_joined_and_how_well(vedette: Command, tmp_path: Path) -> None:
    (tmp_path / "office.log").write_text(carmen_log(small_office()))
    ran = vedette("replay", "office.log", "--robots", 2, "--frames", "unknown", "--seed", 3, "--out", "out")
    assert ran.status == 0, ran.err
    assert "2 robots, all of one map, joined: 1+2, 0.0" in ran.out
    (summary,) = json.loads((tmp_path / "out" / "summary.json").read_text())["buildings"]
    assert summary["frames"]["components"] == [["robot-1", "robot-2"]]
    assert [join["robots"] for join in summary["frames"]["joins"]] == [["robot-1", "robot-2"]]
    assert summary["frames"]["error_m"] <= RIGHT[0]
    _, classes = read_map(tmp_path / "out" / "office.yaml")
    assert np.count_nonzero(classes == OCCUPIED) > 100


def test_what_cannot_be_in_unknown_frames_is_refused(vedette: Command, tmp_path: Path) -> None:
    (tmp_path / "office.log").write_text(standing(small_office(), 9))
    words = "--robots", 2, "--frames", "unknown", "--fusion", "channel", "--out", "out"
    told = "frames unknown: fusion channel cannot move what it has added up into another frame"
    refused(vedette("replay", "office.log", *words), told)


@pytest.mark.slow
@pytest.mark.parametrize("robots", [2, 3])
@pytest.mark.parametrize("name", ["intel", "csail"])
def test_shares_of_real_logs_are_joined_rightly_or_left_apart(name: str, robots: int) -> None:
    path = LOGS / f"{name}.log.gz"
    if not path.exists():
        pytest.skip(f"no {path.name} in {LOGS}")
    found = Replay(read_carmen(path), ReplaySetup(robots, frames="unknown")).run().frames
    assert found is not None
    assert math.isclose(found.undone, 0)
    assert all(join.error_m <= 0.5 and join.error_deg <= 3.0 for join in found.joins)

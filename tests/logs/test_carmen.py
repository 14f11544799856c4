"""Logs in the format of CARMEN: what a line says, what a log leaves open, and what is none."""

from __future__ import annotations

import gzip
import math
from pathlib import Path

import numpy as np
import pytest

from tests.support.recordings import flaser
from vedette.errors import InputError
from vedette.logs import RecordedLog, read_carmen

ROBOTLASER = (
    "ROBOTLASER1 0 -1.570796 3.141593 0.785398 50 0.01 0 5 1 2 3 50 5 2 7 8 "
    "1.5 2.5 0.5 1.4 2.4 0.5 0 0 0.3 0.3 0 12.25 host 12.5"
)


def read(tmp_path: Path, text: str, name: str = "office.log") -> RecordedLog:
    path = tmp_path / name
    path.write_bytes(gzip.compress(text.encode()) if name.endswith(".gz") else text.encode())
    return read_carmen(path)


@pytest.mark.parametrize("name", ["office.log", "office.log.gz"])
def test_a_line_is_a_scan_from_the_pose_of_the_lidar(tmp_path: Path, name: str) -> None:
    text = "\n".join([flaser([1.0, 2.0, 9.0], 3.0, 4.0, math.pi / 2, 5.0), "ODOM 0 0 0", ""])
    log = read(tmp_path, text, name)
    (scan,) = log.scans
    assert (log.name, log.range, scan.time) == ("office", 9.0, 0.0)
    assert (scan.x, scan.y, scan.heading) == pytest.approx((3.0, 4.0, math.pi / 2), abs=1e-5)
    assert scan.angles == pytest.approx([0.0, math.pi / 2, math.pi], abs=1e-5)
    assert scan.ranges.tolist() == [1.0, 2.0, math.inf]  # nothing is farther than the lidar measures


@pytest.mark.parametrize(("readings", "step"), [(180, 1.0), (181, 1.0), (360, 0.5), (361, 0.5)])
def test_half_round_lidars_begin_at_their_right_in_steps_of_a_half_or_a_whole_degree(
    tmp_path: Path, readings: int, step: float
) -> None:
    (scan,) = read(tmp_path, flaser([1.0] * readings, 0.0, 0.0, 0.0, 0.0)).scans
    degrees = np.degrees(scan.angles)
    assert (degrees[0], degrees[1]) == pytest.approx((-90.0, -90.0 + step))
    assert degrees[-1] == pytest.approx(-90.0 + step * (readings - 1))


def test_a_line_that_tells_its_lidar_is_taken_at_its_word(tmp_path: Path) -> None:
    (scan,) = read(tmp_path, ROBOTLASER).scans
    assert (scan.x, scan.y, scan.heading) == (1.5, 2.5, 0.5)
    assert scan.angles - 0.5 == pytest.approx(np.radians([-90.0, -45.0, 0.0, 45.0, 90.0]), abs=1e-5)
    assert scan.ranges.tolist() == [1.0, 2.0, 3.0, math.inf, 5.0]


def test_times_are_the_stamps_that_rise_steadily(tmp_path: Path) -> None:
    lines = [flaser([1.0], 0.0, 0.0, 0.0, stamp) for stamp in (1e9, 1e9 + 0.25, 1e9 + 2.0)]
    assert [scan.time for scan in read(tmp_path, "\n".join(lines)).scans] == [0.0, 0.25, 2.0]


def test_readings_of_nothing_and_stamps_that_are_none_do_no_harm(tmp_path: Path) -> None:
    lines = [flaser([1.0, 0.0, -1.0, 9.0], 0.0, 0.0, 0.0, stamp) for stamp in (math.nan, math.inf, math.nan)]
    log = read(tmp_path, "\n".join(lines))
    np.testing.assert_array_equal(log.scans[0].ranges, [1.0, math.nan, math.nan, math.inf])
    assert [scan.time for scan in log.scans] == pytest.approx([0.0, 0.1, 0.2])


@pytest.mark.parametrize("stamps", [(5.0, 5.0, 5.0), (9.0, 3.0, 4.0), (0.0, 1.0, 1000.0)])
def test_without_such_stamps_the_robot_is_taken_to_drive_half_a_metre_a_second(
    tmp_path: Path, stamps: tuple[float, ...]
) -> None:
    poses = [(0.0, 0.0, 0.0), (3.0, 4.0, 0.0), (3.0, 4.0, 2.0)]
    lines = [flaser([1.0], *pose, stamp) for pose, stamp in zip(poses, stamps, strict=True)]
    times = [scan.time for scan in read(tmp_path, "\n".join(lines)).scans]
    assert times == pytest.approx([0.0, 10.0, 12.0])


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ("FLASER 3 1 2", "line 2: not a FLASER message \\(3 numbers are due, 2 are there\\)"),
        ("FLASER", "line 2: not a FLASER message"),
        ("FLASER 0 0 0 0 0 0 0 0 h 0", "it must have 1 to 20000 readings, not 0"),
        ("FLASER 2 1 nan 0 0 0 0 0 0 0 h 0", "a number of it is not finite"),
        ("FLASER 1 1 1e9 0 0 0 0 0 0 h 0", "its pose is more than 100000 m from the origin"),
        ("FLASER 1 1 0 0 1e300 0 0 0 0 h 0", "its heading is 1e\\+300 rad"),
        ("FLASER 1 one 0 0 0 0 0 0 0 h 0", "could not convert"),
        (ROBOTLASER[:60], "line 2: not a ROBOTLASER1 message"),
    ],
)
def test_a_broken_line_is_named(tmp_path: Path, line: str, told: str) -> None:
    with pytest.raises(InputError, match=told):
        read(tmp_path, flaser([1.0], 0.0, 0.0, 0.0, 0.0) + "\n" + line)


def test_what_is_no_log_is_told_in_one_line(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no scan in it; lines with one begin with FLASER"):
        read(tmp_path, "hello\n")
    with pytest.raises(InputError, match="no message"):
        read(tmp_path, "x" * 2_000_000)
    cut = tmp_path / "cut.log.gz"
    cut.write_bytes(gzip.compress(flaser([1.0], 0.0, 0.0, 0.0, 0.0).encode())[:-12])
    with pytest.raises(InputError, match="it is cut off or damaged"):
        read_carmen(cut)
    with pytest.raises(InputError, match=r"cannot read log .*nowhere: No such file"):
        read_carmen(tmp_path / "nowhere")

"""Logs in the format of CARMEN, as data sets of the field are kept: a message a line, plain or gzipped."""

from __future__ import annotations

import gzip
import math
import zlib
from collections.abc import Iterator
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vedette.errors import InputError
from vedette.input_file import open_input
from vedette.logs.recorded import RecordedLog, RecordedScan, spread, times

SAME = 0.2  # readings so near the longest one say that nothing came back [m]
MOST_READINGS = 20_000  # of a scan
LONGEST_LINE = 1_000_000  # [bytes]
FARTHEST = 1e5  # from the origin, of a pose [m]
MOST_TURNED = 1e4  # by a robot whose heading grows with each turn [rad]
_GZIP = b"\x1f\x8b"


@dataclass(frozen=True, eq=False)
class _Reading:
    """What a line says."""

    pose: tuple[float, float, float]  # of the lidar: x, y, heading [m, m, rad]
    angles: NDArray[np.float64]  # (B,) about the heading [rad]
    ranges: NDArray[np.float64]  # (B,) [m]
    range: float  # from which on nothing has come back, infinite if the line does not say so [m]
    stamp: float  # [s]


def read_carmen(path: Path) -> RecordedLog:
    """Read the front lidar's scans of a CARMEN log: ``FLASER`` and ``ROBOTLASER1``, other messages aside.

    The pose is the lidar's own, corrected by mapping if the log is. A reading as long as the longest of the
    log, or as the lidar's range where the line gives it, is one that did not come back; one of 0 or less is
    none.

    Raises:
        InputError: the file cannot be read, has no scan, or a line that does not fit its own count.
    """
    readings = []
    for number, line in enumerate(_lines(path), start=1):
        kind, _, rest = line.partition(b" ")
        if parse := _PARSERS.get(kind):
            try:
                readings.append(parse(rest.split()))
            except (ValueError, IndexError, OverflowError) as error:
                raise InputError(
                    f"{path}, line {number}: not a {kind.decode()} message ({error}); mend or remove the line"
                ) from error
    if not readings:
        raise InputError(f"{path}: no scan in it; lines with one begin with FLASER or ROBOTLASER1")
    longest = max(float(each.ranges.max()) for each in readings)
    poses = np.array([each.pose for each in readings])
    scans = tuple(
        RecordedScan(
            time,
            *each.pose,
            each.pose[2] + each.angles,
            np.select(
                [each.ranges <= 0.0, each.ranges >= min(longest - SAME, each.range)],
                [np.nan, np.inf],
                each.ranges,
            ),
        )
        for time, each in zip(times([each.stamp for each in readings], poses).tolist(), readings, strict=True)
    )
    return RecordedLog(path.name.strip(".").split(".")[0], scans, longest)


def _lines(path: Path) -> Iterator[bytes]:
    with open_input(path, "log") as file:
        zipped = file.read(len(_GZIP)) == _GZIP
        file.seek(0)
        try:
            with gzip.open(file) if zipped else nullcontext(file) as stream:
                while line := stream.readline(LONGEST_LINE):
                    if len(line) == LONGEST_LINE:
                        raise InputError(f"{path}: a line of {LONGEST_LINE:,} bytes and more is no message")
                    yield line
        except (EOFError, zlib.error, gzip.BadGzipFile, OSError) as error:
            raise InputError(f"cannot read log {path}: {error}; it is cut off or damaged") from error


def _flaser(words: list[bytes]) -> _Reading:
    """``n r_1 .. r_n x y theta odom_x odom_y odom_theta time host time``."""
    count = _count(words[0])
    ranges, rest = _numbers(words[1 : 1 + count], count), words[1 + count :]
    return _Reading(_pose(rest[:3]), spread(count), ranges, math.inf, _stamp(rest[6:]))


def _robotlaser(words: list[bytes]) -> _Reading:
    """``type start fov step range accuracy remissions n r_1 .. r_n m s_1 .. s_m x y theta .. time``."""
    start, _, step, longest = _numbers(words[1:5], 4).tolist()
    count = _count(words[7])
    ranges, rest = _numbers(words[8 : 8 + count], count), words[8 + count :]
    rest = rest[1 + _count(rest[0], least=0) :]
    return _Reading(_pose(rest[:3]), start + step * np.arange(count), ranges, longest, _stamp(rest[11:]))


_PARSERS = {b"FLASER": _flaser, b"ROBOTLASER1": _robotlaser}


def _count(word: bytes, least: int = 1) -> int:
    count = int(word)
    if not least <= count <= MOST_READINGS:
        raise ValueError(f"it must have {least} to {MOST_READINGS} readings, not {count}")
    return count


def _numbers(words: list[bytes], count: int) -> NDArray[np.float64]:
    numbers = np.array([float(word) for word in words])
    if len(numbers) != count:
        raise ValueError(f"{count} numbers are due, {len(numbers)} are there")
    if not np.isfinite(numbers).all():
        raise ValueError("a number of it is not finite")
    return numbers


def _pose(words: list[bytes]) -> tuple[float, float, float]:
    x, y, heading = _numbers(words, 3).tolist()
    if max(abs(x), abs(y)) > FARTHEST:
        raise ValueError(f"its pose is more than {FARTHEST:g} m from the origin")
    if abs(heading) > MOST_TURNED:
        raise ValueError(f"its heading is {heading:g} rad")
    return x, y, heading


def _stamp(words: list[bytes]) -> float:
    """Return the time of ``time host time`` that the logger gave, or the robot's, or none."""
    stamp = next((float(word) for word in (words[2:3] or words[:1])), 0.0)
    return stamp if math.isfinite(stamp) else 0.0

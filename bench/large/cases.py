"""Which missions the table is made of, and how one of them is run: in a process of its own."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Literal, NamedTuple

from bench.large import mission
from bench.large.trees import Version
from vedette.record.summary import SCHEMA_VERSION


class Size(NamedTuple):
    """How large a mission is."""

    width: int  # of the office [m]
    height: int  # [m]
    resolution: float  # [m]
    robots: int

    def __str__(self) -> str:
        """Name it in a table."""
        return f"{self.width}x{self.height} m at {self.resolution:g} m, {self.robots} robots"


@dataclass(frozen=True)
class Large:
    """One mission, run by one version of Vedette."""

    size: Size
    max_time: float  # [s]
    version: Version

    @property
    def key(self) -> tuple[Size, float, str]:
        """What tells it from all others."""
        return self.size, self.max_time, self.version.commit

    def __str__(self) -> str:
        """Name it in a line of progress."""
        return f"{self.size}, {self.version.when}"


@dataclass(frozen=True, kw_only=True)
class LargeResult:
    """What it took; one line of the results file."""

    width: int
    height: int
    resolution: float
    robots: int
    max_time: float
    outcome: str
    coverage: float
    time_s: float
    cpu_s: float
    planning_p50_ms: float | None
    planning_p95_ms: float | None
    peak_bytes: int
    record_bytes: int
    sent_bytes: float  # by a robot, on average
    commit: str
    schema_version: Literal[3] = SCHEMA_VERSION

    @property
    def size(self) -> Size:
        """How large it was."""
        return Size(self.width, self.height, self.resolution, self.robots)

    @property
    def key(self) -> tuple[Size, float, str]:
        """The mission's."""
        return self.size, self.max_time, self.commit

    @property
    def factor(self) -> float:
        """How many seconds were simulated in a second of CPU time."""
        return self.time_s / self.cpu_s


def large_cases(sizes: Sequence[Size], max_time: float, versions: Sequence[Version]) -> list[Large]:
    """Return the missions, those of one size next to each other: before and after in like conditions."""
    return [Large(size, max_time, version) for size in sizes for version in versions]


def run_large(case: Large, commit: str) -> LargeResult:
    """Run one mission by the Python of its version, whatever commit this is.

    Raises:
        CalledProcessError: it broke.
    """
    with TemporaryDirectory() as folder:
        size = (str(each) for each in (*case.size, case.max_time))
        command = (str(case.version.python), "-P", mission.__file__, *size, str(Path(folder) / "record"))
        done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True)
    told = json.loads(done.stdout)
    return LargeResult(**case.size._asdict(), max_time=case.max_time, commit=case.version.commit, **told)

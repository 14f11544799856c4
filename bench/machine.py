"""Where and on what a benchmark ran: a figure without that means nothing."""

from __future__ import annotations

import os
import platform
import subprocess
from importlib.metadata import version
from pathlib import Path

PACKAGES = ("vedette", "numpy")


def describe() -> dict[str, str]:
    """Return machine, Python, versions, commit and its date, as words."""
    return {
        "machine": f"{_processor()}, {os.cpu_count()} cores, {platform.system()} {platform.machine()}",
        "python": platform.python_version(),
        **{package: version(package) for package in PACKAGES},
        "commit": commit(),
        "commit_date": _git("log", "-1", "--format=%cI"),
    }


def commit() -> str:
    """Return the short name of the commit, ``-dirty`` where files differ from it; ``unknown`` without git."""
    return _git("describe", "--always", "--dirty", "--exclude=*")


def stay_on_one_core() -> None:
    """Keep this process on one core, where the system can, so that one core is what is measured."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})


def _processor() -> str:
    try:
        for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    except OSError:
        pass
    return platform.processor() or "unknown processor"


def _git(*arguments: str) -> str:
    try:
        done = subprocess.run(
            ("git", *arguments), cwd=Path(__file__).parent, capture_output=True, text=True, check=True
        )
    except (OSError, subprocess.CalledProcessError):
        return "unknown"
    return done.stdout.strip()

"""Where and on what a benchmark ran: a figure without that means nothing."""

from __future__ import annotations

import os
import platform
from importlib.metadata import version
from pathlib import Path

from vedette.study.provenance import UNKNOWN, commit_of, git, machine

HERE = Path(__file__).parent
PACKAGES = ("vedette", "numpy")


def describe() -> dict[str, str]:
    """Return machine, Python, versions, commit and its date, as words."""
    return {
        "machine": machine(),
        "python": platform.python_version(),
        **{package: version(package) for package in PACKAGES},
        "commit": commit(),
        "commit_date": git(HERE, "log", "-1", "--format=%cI") or UNKNOWN,
    }


def commit() -> str:
    """Return the short name of the commit, ``-dirty`` where files differ from it; ``unknown`` without git."""
    return commit_of(HERE)


def differs(*paths: str) -> bool:
    """Tell whether files at these places, from the project's folder, differ from the commit."""
    return bool(git(HERE.parent, "status", "--porcelain", "--", *paths))


def last_change(*paths: str) -> dict[str, str]:
    """Return the commit that last changed files at these places, and its date."""
    commit, _, date = git(HERE.parent, "log", "-1", "--format=%h %cI", "--", *paths).partition(" ")
    return {"commit": commit or UNKNOWN, "commit_date": date or UNKNOWN}


def stay_on_one_core() -> None:
    """Keep this process on one core, where the system can, so that one core is what is measured."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})

"""What made a result: the code, the machine, the command."""

from __future__ import annotations

import hashlib
import os
import platform
import subprocess
from dataclasses import dataclass
from functools import cache
from importlib.metadata import version
from pathlib import Path

PACKAGE = Path(__file__).parents[1]
UNKNOWN = "unknown"
# Parts of the package that show or arrange missions, and cannot change how one goes.
_WITHOUT_EFFECT = ("cli", "net", "record", "stonesoup", "study")


@dataclass(frozen=True)
class Provenance:
    """Where figures come from, as words."""

    command: str
    made: str  # date and time
    version: str  # of the package, with the commit where it is known
    code: str  # fingerprint of all that decides how a mission goes
    machine: str
    python: str


def provenance(command: str, made: str) -> Provenance:
    """Describe this program on this machine; the command and the time are the caller's."""
    commit = commit_of(PACKAGE)
    release = version("vedette")
    return Provenance(
        command=command,
        made=made,
        version=release if commit == UNKNOWN else f"{release}, commit {commit}",
        code=fingerprint(),
        machine=machine(),
        python=platform.python_version(),
    )


def machine() -> str:
    """Return what this machine is, as words."""
    return f"{_processor()}, {os.cpu_count()} cores, {platform.system()} {platform.machine()}"


def commit_of(folder: Path) -> str:
    """Return the short name of a folder's commit, ``-dirty`` where files differ from it.

    ``unknown`` without git, or where the folder is not part of the repository around it, as a package that is
    installed below somebody's own repository is not.
    """
    if not git(folder, "ls-files", "--", "__init__.py"):
        return UNKNOWN
    return git(folder, "describe", "--always", "--dirty", "--exclude=*") or UNKNOWN


@cache
def fingerprint(package: Path = PACKAGE) -> str:
    """Return 12 hexadecimal digits that change with any code that can change how a mission goes.

    The version alone would let results of yesterday's planner pass for today's.
    """
    digest = hashlib.sha256()
    for path in sorted(path for path in package.rglob("*") if path.suffix in (".py", ".so", ".pyd")):
        name = path.relative_to(package)
        if name.parts[0] not in _WITHOUT_EFFECT:
            digest.update(name.as_posix().encode() + b"\0" + hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()[:12]


def git(folder: Path, *arguments: str) -> str:
    """Return what git says in a folder; nothing where it cannot."""
    try:
        done = subprocess.run(("git", *arguments), cwd=folder, capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        return ""
    return done.stdout.strip()


def _processor() -> str:
    try:
        for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    except OSError:
        pass
    return platform.processor() or "unknown processor"

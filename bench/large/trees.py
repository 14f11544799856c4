"""An older Vedette beside this one: a worktree at its commit, with an environment of its own."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from bench import machine
from vedette.errors import InputError
from vedette.study.provenance import git

ROOT = Path(__file__).parents[2]
DIGITS = 7  # of a commit that name its folder; git itself takes more as a repository grows
BEFORE = ROOT / "build" / "before"  # worktrees, by their commits


@dataclass(frozen=True)
class Version:
    """A Vedette that can run missions."""

    when: str  # "before" or "after"
    commit: str
    python: Path


def present() -> Version:
    """Return the Vedette that runs this."""
    return Version("after", machine.commit(), Path(sys.executable))


def built(ref: str) -> Version:
    """Return the Vedette of a commit, which is checked out and built unless it has been before.

    Raises:
        InputError: there is no such commit, or it cannot be built.
    """
    commit = git(ROOT, "rev-parse", "--verify", "--quiet", f"{ref}^{{commit}}")[:DIGITS]
    if not commit:
        raise InputError(f"--before must be a commit of this repository; got {ref!r}")
    folder = BEFORE / commit
    if not folder.exists():
        _do("git", "worktree", "add", "--detach", str(folder), commit)
    _do("make", "--no-print-directory", "-C", str(folder), "ready")
    return Version("before", commit, folder / ".venv" / "bin" / "python")


def _do(*command: str) -> None:
    """Run a command; what it says comes up only if it fails."""
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    if done.returncode:
        last = (done.stderr.strip() or done.stdout.strip()).splitlines()[-1:]
        raise InputError(f"{' '.join(command[:3])} fails: {' '.join(last)}; see by hand in {ROOT}")

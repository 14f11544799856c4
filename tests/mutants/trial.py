"""Tests run on a worker's copy until one fails: in a process of its own, its time and memory bounded."""

from __future__ import annotations

import json
import os
import resource
import signal
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TextIO

import pytest

QUIET = [
    "-m",
    "not slow",
    "--hypothesis-profile=ci",
    "-p",
    "no:cacheprovider",
    "-p",
    "no:randomly",
    "-p",
    "no:xdist",
]
_LONGER = 5.0  # times what the tests take as things are
_AT_LEAST = 60.0  # of CPU, whatever the tests take [s]
_WALL = 3600.0  # after which a trial tells nothing: it may have had no CPU [s]
_MEMORY = 4 << 30  # [byte]
_SAID = {
    -signal.SIGXCPU: "endless",
    -signal.SIGKILL: "unended",  # by others, for they were short of memory
    -signal.SIGTERM: "unended",
    pytest.ExitCode.NO_TESTS_COLLECTED: "unended",  # they have other names now
}


@dataclass(frozen=True)
class Trial:
    """What came of some tests."""

    verdict: str  # survived, killed, endless or unended
    by: str = ""  # the test that was running when it ended


def run(tree: Path, tests: list[str], seconds: float) -> Trial:
    """Run these tests in this order on a copy, until one fails; in all they take so long as things are."""
    job, started = tree / "trial.json", tree / "trial.txt"
    job.write_text(json.dumps(tests), encoding="utf-8")
    started.write_text("", encoding="utf-8")
    limit = int(_AT_LEAST + _LONGER * seconds)
    env = {**os.environ, "PYTHONPATH": "src:reproduction", "PYTHONDONTWRITEBYTECODE": "1"}
    words = [sys.executable, "-m", "tests.mutants.trial", str(job), str(started)]
    try:
        code = subprocess.run(
            words, cwd=tree, env=env, capture_output=True, timeout=_WALL, preexec_fn=lambda: _bound(limit)
        ).returncode
    except subprocess.TimeoutExpired:
        return Trial("unended")
    by = (started.read_text(encoding="utf-8").splitlines() or ["while tests were collected"])[-1]
    return Trial("survived") if code == pytest.ExitCode.OK else Trial(_SAID.get(code, "killed"), by)


def _bound(seconds: int) -> None:
    """Of the process to be: a group of its own, which Ctrl-C does not reach, and its most time and memory."""
    os.setsid()
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 5))
    resource.setrlimit(resource.RLIMIT_DATA, (_MEMORY, _MEMORY))


class Chosen:
    """A plugin for pytest: runs these tests alone, in this order, and tells which it has begun."""

    def __init__(self, tests: list[str], started: TextIO) -> None:
        self._place = {test: k for k, test in enumerate(tests)}
        self._started = started

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        """Leave out what was not chosen."""
        chosen = [item for item in items if item.nodeid in self._place]
        items[:] = sorted(chosen, key=lambda item: self._place[item.nodeid])

    def pytest_runtest_logstart(self, nodeid: str) -> None:
        """Tell that a test begins."""
        print(nodeid, file=self._started, flush=True)


def main(job: Path, started: Path) -> int:
    """Run the tests of a job; return pytest's status."""
    tests = json.loads(job.read_text(encoding="utf-8"))
    files = list(dict.fromkeys(test.split("::")[0] for test in tests))
    with started.open("w", encoding="utf-8") as told:
        return pytest.main(["-x", "--tb=no", *QUIET, *files], plugins=[Chosen(tests, told)])


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), Path(sys.argv[2])))

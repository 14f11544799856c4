"""A Dask cluster on this host: a scheduler and workers as processes that nobody restarts."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

from tests.support.net_team import wait_until

PATIENCE = 180.0  # for what takes seconds on an idle machine [s]


class Cluster:
    """A scheduler and workers of one thread each, processes of this host without anybody to restart them."""

    def __init__(self, folder: Path) -> None:
        """Start a scheduler that tells its address in a file."""
        self._file, self._folder = folder / "scheduler.json", folder
        self._processes = [self._start("scheduler", "--port", "0", "--host", "127.0.0.1")]
        wait_until(lambda: self._file.exists() and self._file.read_text().endswith("}"), PATIENCE)
        self.address = json.loads(self._file.read_text())["address"]

    def worker(self) -> subprocess.Popen[bytes]:
        """Start a worker."""
        self._processes.append(self._start("worker", "--nthreads", "1", "--no-nanny"))
        return self._processes[-1]

    def end(self) -> None:
        """Kill all that still runs."""
        for process in self._processes:
            process.kill()
            process.wait()

    def _start(self, role: str, *options: str) -> subprocess.Popen[bytes]:
        command = [sys.executable, "-m", f"distributed.cli.dask_{role}", "--scheduler-file", str(self._file)]
        with (self._folder / f"{role}.log").open("ab") as log:
            return subprocess.Popen([*command, "--no-dashboard", *options], stdout=log, stderr=log)

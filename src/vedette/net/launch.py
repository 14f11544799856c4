"""A whole team of agent processes on this host, with keys made for the occasion."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime, timedelta
from pathlib import Path
from types import TracebackType
from typing import Any, Protocol, Self

import msgspec

from vedette.agent.orders import Order
from vedette.net.access import Access
from vedette.net.credentials import credentials
from vedette.net.endpoints import free_port
from vedette.net.keys import issue_team
from vedette.net.names import OPERATOR, robot_name
from vedette.parts import finding_parts
from vedette.record.files import write_text

TEAM = "team"
PATIENCE = 5.0  # for a process that was told to stop; then it is killed [s]
KEY_DAYS = 2
FAULTS = "faults.yaml"
STARTING, STARTING_EACH = 2.0, 1.0  # a team with a shared clock begins so long after it is started [s]


class TeamPlan(Protocol):
    """What is to be started."""

    @property
    def size(self) -> int:
        """Number of robots."""

    @property
    def speed(self) -> float:
        """Of the mission, times real time."""

    @property
    def lease(self) -> float:
        """After which a silent neighbour is given up [s]."""

    @property
    def shared_clock(self) -> bool:
        """Whether all of the team count the mission's time from one moment on."""

    def as_told(self, order: Order) -> Order:
        """Return an order of whoever started the team, its place as the robots reckon."""

    def write(self, folder: Path) -> None:
        """Write the files that the robots share."""

    def config(self, i: int, pose: Sequence[float] | None) -> dict[str, Any]:
        """Return what a robot's file says of its mission; ``pose``: where it is put, None: at its start."""


@dataclass
class TeamProcesses:
    """Starts an agent process for each robot, all linked to all, and stops them on leaving."""

    plan: TeamPlan
    folder: Path  # for keys, the world and the robots' files; private
    logs: Path  # what the processes say
    faults: str | None = None  # the text of a schedule of what befalls links
    environment: Mapping[str, str] = field(default_factory=dict)  # of the processes, beside this one's
    processes: list[subprocess.Popen[bytes]] = field(default_factory=list)
    operator: Access = field(init=False)
    begins: datetime = field(init=False)  # when the time of the mission, or of faults, is 0
    endpoints: list[str] = field(default_factory=list)  # where the operator reaches each robot

    def __enter__(self) -> Self:
        """Write the robots' files and start them.

        Raises:
            InputError: a file cannot be written.
        """
        n = self.plan.size
        issue_team(TEAM, self.folder / "keys", n, datetime.now().astimezone(), KEY_DAYS)
        self.plan.write(self.folder)
        if self.faults is not None:
            write_text(self.folder / FAULTS, self.faults)
        self.endpoints = self._endpoints()
        self.operator = Access(
            TEAM,
            connect=tuple(self.endpoints),
            credentials=credentials(self.folder / "keys" / OPERATOR, datetime.now().astimezone()),
            robots=n,
            lease=self.plan.lease,
        )
        self.logs.mkdir(parents=True, exist_ok=True)
        for old in self.logs.glob("robot-*.log"):  # of a larger team
            old.unlink()
        self.begins = datetime.now(UTC) + timedelta(seconds=STARTING + n * STARTING_EACH)
        for i in range(n):
            self._write(i)
            self.processes.append(self._start(i))
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Stop all processes, the hard way if need be."""
        for process in self.processes:
            if process.poll() is None:
                process.send_signal(signal.SIGCONT)  # one that was stopped could not hear the other
                process.terminate()
        end = time.monotonic() + PATIENCE
        for process in self.processes:
            try:
                process.wait(max(end - time.monotonic(), 0.0))
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()

    @property
    def time(self) -> float:
        """Mission time of a team with a shared clock, and of faults; negative until they begin [s]."""
        return (datetime.now(UTC) - self.begins).total_seconds() * self.plan.speed

    def restart(self, robot: int, pose: Sequence[float] | None = None) -> None:
        """Start a robot again whose process has ended, with empty memory.

        ``pose``: where it is by now, x, y, heading [m, m, rad]; None: where it was first put.
        """
        if pose is not None:
            self._write(robot, pose)
        self.processes[robot] = self._start(robot)

    def signal(self, robot: int, number: signal.Signals) -> None:
        """Send a robot's process a signal, if it still runs."""
        if self.runs(robot):
            self.processes[robot].send_signal(number)

    def runs(self, robot: int) -> bool:
        """Tell whether a robot's process has not ended."""
        return self.processes[robot].poll() is None

    def left(self, robot: int) -> bool:
        """Tell whether a robot's process has ended in good order."""
        return self.processes[robot].poll() == 0

    def failure(self, robot: int) -> str | None:
        """Return what a process that failed said last; None if it runs, was stopped, or was killed."""
        status = self.processes[robot].poll()
        if status is None or status <= 0:
            return None
        try:
            lines = self.log_of(robot).read_text(encoding="utf-8", errors="replace").split("\n")
        except OSError:  # the folder of the logs has vanished
            lines = []
        said = [line.removeprefix("vedette: ") for line in lines if line.strip()]
        return said[-1] if said else f"it ended with status {status}"

    def log_of(self, robot: int) -> Path:
        """Return the file of what a robot's process says."""
        return self.logs / f"{robot_name(robot)}.log"

    def _endpoints(self) -> list[str]:
        """Return where the operator reaches each robot."""
        return [f"tls/127.0.0.1:{port}" for port in _free_ports(self.plan.size)]

    def _file_of(self, i: int) -> Path:
        return self.folder / f"{robot_name(i)}.yaml"

    def _start(self, i: int) -> subprocess.Popen[bytes]:
        # A session of its own: Ctrl-C in the terminal is for whoever started the team.
        threads = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
        with self.log_of(i).open("wb") as log:
            return subprocess.Popen(
                self._command(i),
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=subprocess.STDOUT,
                start_new_session=True,
                env={**os.environ, **threads, **finding_parts(), **self.environment},
            )

    def _command(self, i: int) -> list[str]:
        command = [sys.executable, "-m", "vedette", "agent", str(self._file_of(i))]
        return [*command, "--speed", str(self.plan.speed), "--starter", str(os.getpid())]

    def _links(self, i: int) -> dict[str, Any]:
        """Return where a robot listens, and what it connects to."""
        return {"listen": [self.endpoints[i]], "connect": self.endpoints[:i]}

    def _write(self, i: int, pose: Sequence[float] | None = None) -> None:
        config = {
            "team": TEAM,
            "robot": i + 1,
            "robots": self.plan.size,
            "links": {"keys": f"keys/{robot_name(i)}", "lease": self.plan.lease, **self._links(i)},
            **self.plan.config(i, pose),
        }
        if self.plan.shared_clock or self.faults is not None:
            config["begins"] = self.begins
        if self.faults is not None:
            config["faults"] = FAULTS
        write_text(self._file_of(i), msgspec.yaml.encode(config).decode())


def _free_ports(n: int) -> list[int]:
    ports: set[int] = set()
    while len(ports) < n:
        ports.add(free_port())
    return sorted(ports)

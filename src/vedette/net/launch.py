"""A whole team of agent processes on this host, with keys made for the occasion."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import msgspec
import numpy as np
from numpy.typing import NDArray

from vedette.maps.world import World
from vedette.missions.explore.options import ExploreOptions
from vedette.net.access import Access
from vedette.net.config import OF_BODY
from vedette.net.credentials import credentials
from vedette.net.endpoints import free_port
from vedette.net.keys import issue_team
from vedette.net.names import OPERATOR, robot_name
from vedette.record.files import write_text
from vedette.team import PlatformSpec

TEAM = "team"
PATIENCE = 5.0  # for a process that was told to stop; then it is killed [s]
KEY_DAYS = 2


@dataclass(frozen=True, eq=False)
class TeamPlan:
    """What is to be started."""

    world: World
    specs: Sequence[PlatformSpec]
    starts: NDArray[np.float64]  # (n, 3) x, y, heading [m, m, rad], team frame
    options: ExploreOptions
    seed: int
    speed: float  # times real time
    lease: float = 3.0  # [s]


@dataclass
class TeamProcesses:
    """Starts an agent process for each robot, all linked to all, and stops them on leaving."""

    plan: TeamPlan
    folder: Path  # for keys, the world and the robots' files; private
    logs: Path  # what the processes say
    processes: list[subprocess.Popen[bytes]] = field(default_factory=list)
    operator: Access = field(init=False)

    def __enter__(self) -> Self:
        """Write the robots' files and start them.

        Raises:
            InputError: a file cannot be written.
        """
        n = len(self.plan.specs)
        issue_team(TEAM, self.folder / "keys", n, datetime.now().astimezone(), KEY_DAYS)
        self.plan.world.save(self.folder)
        endpoints = self._endpoints()
        self.operator = Access(
            TEAM,
            connect=tuple(endpoints),
            credentials=credentials(self.folder / "keys" / OPERATOR, datetime.now().astimezone()),
            robots=n,
            lease=self.plan.lease,
        )
        self.logs.mkdir(parents=True, exist_ok=True)
        for old in self.logs.glob("robot-*.log"):  # of a larger team
            old.unlink()
        for i in range(n):
            write_text(self._file_of(i), msgspec.yaml.encode(self._config(i, endpoints)).decode())
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

    def restart(self, robot: int) -> None:
        """Start a robot again whose process has ended: with empty memory, where it was first put."""
        self.processes[robot] = self._start(robot)

    def runs(self, robot: int) -> bool:
        """Tell whether a robot's process has not ended."""
        return self.processes[robot].poll() is None

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
        return [f"tls/127.0.0.1:{port}" for port in _free_ports(len(self.plan.specs))]

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
                env=os.environ | threads,
            )

    def _command(self, i: int) -> list[str]:
        command = [sys.executable, "-m", "vedette", "agent", str(self._file_of(i))]
        return [*command, "--speed", str(self.plan.speed), "--starter", str(os.getpid())]

    def _config(self, i: int, endpoints: Sequence[str]) -> dict[str, Any]:
        plan, spec = self.plan, self.plan.specs[i]
        x, y, heading = plan.starts[i].tolist()
        return {
            "team": TEAM,
            "robot": i + 1,
            "robots": len(plan.specs),
            "best": {
                "range": max(spec.range for spec in plan.specs),
                "speed": max(spec.speed for spec in plan.specs),
            },
            "links": {
                "listen": [endpoints[i]],
                "connect": list(endpoints[:i]),
                "keys": f"keys/{robot_name(i)}",
                "lease": plan.lease,
            },
            "explore": msgspec.to_builtins(plan.options),
            "body": {
                "map": "map.yaml",
                "start": [x, y, float(np.degrees(heading))],
                "seed": plan.seed,
                **{name: getattr(spec, name) for name in OF_BODY},
            },
        }


def _free_ports(n: int) -> list[int]:
    ports: set[int] = set()
    while len(ports) < n:
        ports.add(free_port())
    return sorted(ports)

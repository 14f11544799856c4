"""What tests of real sessions share: keys of a team, access to it over the loopback, and patience."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest

from vedette.net import Access, credentials
from vedette.net.endpoints import free_port
from vedette.net.keys import _issue_one, issue_team, load_authority
from vedette.net.names import robot_name

TEAM = "office"
DAY = timedelta(days=1)

# Real sockets and clocks on a host that other work may keep busy: what fails three times is no accident.
real_time = pytest.mark.flaky(reruns=2, reruns_delay=2)


@dataclass
class Ports:
    """Where each robot of a team listens, and what admits it."""

    keys: Path | None = None  # None: plain TCP
    ports: dict[int, int] = field(default_factory=dict)

    def endpoint(self, robot: int) -> str:
        """Where a robot listens."""
        port = self.ports.setdefault(robot, free_port())
        return f"{'tls' if self.keys else 'tcp'}/127.0.0.1:{port}"

    def access(self, robot: int | None, connect: Sequence[int] = (), lease: float = 3.0) -> Access:
        """Access of a robot, or of the operator if None, to those that it connects to."""
        name = "operator" if robot is None else robot_name(robot)
        return Access(
            TEAM,
            listen=() if robot is None else (self.endpoint(robot),),
            connect=tuple(self.endpoint(other) for other in connect),
            credentials=credentials(self.keys / name, datetime.now(UTC)) if self.keys else None,
            insecure=self.keys is None,
            robots=8,
            lease=lease,
        )


def issue(folder: Path, robots: int = 3) -> Path:
    """Make the keys of a team that are valid today."""
    issue_team(TEAM, folder, robots, datetime.now(UTC))
    return folder


def issue_for(keys: Path, folder: Path, lasts: timedelta, team: str = TEAM) -> Path:
    """Let a team's authority issue a certificate that lasts so long from now, or has expired so long ago."""
    authority = load_authority(keys, team, datetime.now(UTC) - DAY + lasts, 1)
    folder.parent.mkdir(exist_ok=True)
    _issue_one(authority, folder)
    return folder


def wait_until(condition: Callable[[], object], seconds: float = 5.0) -> float:
    """Wait for a condition; return how long it took [s]."""
    begin = time.monotonic()
    while not condition():
        assert time.monotonic() < begin + seconds, f"not so within {seconds} s"
        time.sleep(0.001)
    return time.monotonic() - begin

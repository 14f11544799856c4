"""Hosts as Linux network namespaces, joined by virtual cables that lose what they are told to lose."""

from __future__ import annotations

import fcntl
import os
import shutil
import subprocess
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from itertools import count
from pathlib import Path
from tempfile import gettempdir
from types import TracebackType
from typing import Any, Self

from vedette.net.launch import TeamProcesses

PORT = 7447
Cable = tuple[int, int]


def missing() -> str | None:
    """Say what keeps this machine from having hosts of its own; None: nothing does."""
    for tool, package in (("ip", "iproute2"), ("tc", "iproute2"), ("nft", "nftables")):
        if shutil.which(tool) is None:
            return f"no {tool!r} command; it comes with the package {package}"
    trial = f"vedette-trial-{os.getpid()}"
    try:
        _do("ip", "netns", "add", trial)
        try:
            _do("ip", "netns", "exec", trial, "nft", "add", "table", "netdev", "trial")
        finally:
            _do("ip", "netns", "del", trial)
    except subprocess.CalledProcessError as error:
        return f"not allowed to make network namespaces: {error.stderr.strip().splitlines()[-1:]}"
    return None


_MADE = count()  # names are not used twice: what was taken away may take a while to be gone


@dataclass
class Hosts:
    """So many hosts with cables between some of them, and one from each to this machine for the operator."""

    count: int
    cables: Sequence[Cable]
    tag: str = field(default_factory=lambda: f"v{os.getpid() % 100_000}x{next(_MADE)}")

    def __enter__(self) -> Self:
        """Make them; one such network at a time, since all have the same addresses on this machine."""
        self._turn = (Path(gettempdir()) / "vedette-hosts.lock").open("w")
        fcntl.flock(self._turn, fcntl.LOCK_EX)
        try:
            for host in range(self.count):
                _do("ip", "netns", "add", self.name(host))
                self.inside(host, "ip", "link", "set", "lo", "up")
                self._lay_to_here(host)
            for number, (a, b) in enumerate(self.cables):
                self._lay(number, a, b)
        except BaseException:
            self.__exit__(None, None, None)
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Take them away, with the cables that end there."""
        for host in range(self.count):
            subprocess.run(["ip", "netns", "del", self.name(host)], capture_output=True, check=False)
        self._turn.close()

    def name(self, host: int) -> str:
        """The namespace of a host."""
        return f"{self.tag}h{host}"

    def inside(self, host: int, *command: str, text: str | None = None) -> None:
        """Run a command on a host."""
        _do("ip", "netns", "exec", self.name(host), *command, text=text)

    def address(self, host: int, peer: int | None) -> str:
        """Of a host on its cable to a peer, or to this machine if None."""
        if peer is None:
            return f"198.18.{host}.2"
        number = self._number(host, peer)
        return f"198.19.{number}.{1 if self.cables[number][0] == host else 2}"

    def lose(self, percent: int, cables: Iterable[Cable] | None = None) -> None:
        """Let some cables, or all, lose a share of all packets, both ways: 100 cuts them without a word."""
        for a, b in self.cables if cables is None else cables:
            for host, peer in ((a, b), (b, a)):
                self.deafen(host, peer, percent)

    def deafen(self, host: int, peer: int, percent: int = 100) -> None:
        """Let a host lose a share of what comes from a peer; the way back is as it was."""
        self.inside(host, "nft", "-f", "-", text=_rules(f"c{self._number(host, peer)}", percent))

    def limit(self, kbit: int) -> None:
        """Let every cable carry so much a second, each way, and keep what waits for half a second."""
        for number, ends in enumerate(self.cables):
            for host in ends:
                rate = ("rate", f"{kbit}kbit", "burst", "4kb", "latency", "500ms")
                self.inside(host, "tc", "qdisc", "replace", "dev", f"c{number}", "root", "tbf", *rate)

    def _number(self, a: int, b: int) -> int:
        return next(k for k, cable in enumerate(self.cables) if set(cable) == {a, b})

    def _lay(self, number: int, a: int, b: int) -> None:
        """Both ends have the same name, each on its own host."""
        name, there = f"c{number}", self.name(b)
        self.inside(a, "ip", "link", "add", name, "type", "veth", "peer", "name", name, "netns", there)
        for end, host in enumerate((a, b), start=1):
            self.inside(host, "ip", "addr", "add", f"198.19.{number}.{end}/30", "dev", name)
            self.inside(host, "ip", "link", "set", name, "up")

    def _lay_to_here(self, host: int) -> None:
        here = f"{self.tag}m{host}"
        _do("ip", "link", "add", here, "type", "veth", "peer", "name", "here", "netns", self.name(host))
        _do("ip", "addr", "add", f"198.18.{host}.1/30", "dev", here)
        _do("ip", "link", "set", here, "up")
        self.inside(host, "ip", "addr", "add", f"198.18.{host}.2/30", "dev", "here")
        self.inside(host, "ip", "link", "set", "here", "up")


def _rules(device: str, percent: int) -> str:
    """Rules that take the place of those that the device had."""
    drop = f"numgen random mod 100 < {percent} drop" if percent < 100 else "drop"
    chain = f"type filter hook ingress device {device} priority 0\n    {drop}"
    table = f"table netdev {device}"
    return f"{table}\ndelete {table}\n{table} {{\n  chain arriving {{\n    {chain}\n  }}\n}}\n"


def _do(*command: str, text: str | None = None) -> None:
    subprocess.run(command, input=text, capture_output=True, check=True, text=True)


@dataclass
class HostedTeam(TeamProcesses):
    """A robot on each host, linked along the cables: the higher number connects to the lower."""

    hosts: Hosts = field(kw_only=True)

    def _endpoints(self) -> list[str]:
        return [f"tls/{self.hosts.address(host, None)}:{PORT}" for host in range(self.hosts.count)]

    def _command(self, i: int) -> list[str]:
        return ["ip", "netns", "exec", self.hosts.name(i), *super()._command(i)]

    def _links(self, i: int) -> dict[str, Any]:
        lower = [min(cable) for cable in self.hosts.cables if max(cable) == i]
        connect = [f"tls/{self.hosts.address(peer, i)}:{PORT}" for peer in lower]
        return {"listen": [f"tls/0.0.0.0:{PORT}"], "connect": connect}

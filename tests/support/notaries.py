"""Notaries for tests: real ones by real keys, and one that only hashes, where many teams are played."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from datetime import UTC, datetime
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from vedette.net.credentials import credentials
from vedette.net.keys import issue_team
from vedette.net.notary import CertifiedNotary

MISSION = "test"


@cache
def _keys(robots: int) -> tuple[TemporaryDirectory[str], list[Path]]:
    folder = TemporaryDirectory(prefix="keys-")
    return folder, issue_team("test", Path(folder.name) / "keys", robots, datetime.now(UTC))


def certified(
    robot: int, clock: Callable[[], float], robots: int = 8, mission: str = MISSION
) -> CertifiedNotary:
    """Return a robot's notary, by keys that are made once for all tests."""
    _, folders = _keys(robots)
    return CertifiedNotary(credentials(folders[robot], datetime.now(UTC)), mission, clock)


class PlainNotary:
    """``vedette.fusion.seals.Notary`` that takes nobody's trouble: whoever knows the name can sign by it.

    Programs of tests sign by their own alone; signatures that do not fit are found all the same.
    """

    def __init__(self, robot: int, clock: Callable[[], float]) -> None:
        self.certificate = robot.to_bytes(4, "big")
        self._robot, self._clock = robot, clock
        self._known: set[int] = set()

    def now(self) -> int:
        """Return what the clock shows [0.1 s]."""
        return int(10.0 * self._clock())

    def sign(self, *what: int | bytes | str) -> bytes:
        """Return a hash."""
        return _hash(self._robot, what)

    def admit(self, robot: int, certificate: bytes) -> None:
        """Take the right number alone."""
        if certificate != robot.to_bytes(4, "big"):
            raise ValueError("its certificate is another's")
        self._known.add(robot)

    def certificate_of(self, robot: int) -> bytes:
        """Return its number."""
        return robot.to_bytes(4, "big")

    def knows(self, robot: int) -> bool:
        """Tell whether it has."""
        return robot in self._known

    def check(self, robot: int, signature: bytes, *what: int | bytes | str) -> None:
        """Raise ValueError for another hash."""
        if signature != _hash(robot, what):
            raise ValueError("the signature is not by its key")


def _hash(robot: int, what: tuple[int | bytes | str, ...]) -> bytes:
    return hashlib.blake2b(repr((robot, what)).encode(), digest_size=64).digest()

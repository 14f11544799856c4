"""Signing one's own evidence, and checking everybody's: once a version, however often it comes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from vedette.fusion.link import Key
from vedette.fusion.sealed import SealedSnapshot
from vedette.fusion.seals import EVIDENCE, Notary, Seal
from vedette.fusion.snapshots import Delta

Admit = Callable[[Delta[np.uint8], SealedSnapshot], None]


@dataclass
class SnapshotSealing:
    """``vedette.fusion.contributors.Sealing`` of maps."""

    notary: Notary
    admit: Admit  # ValueError for what the contributor cannot have seen
    complaints: dict[int, str] = field(default_factory=dict)  # by robot: why its word was not taken
    forgers: set[int] = field(default_factory=set)  # neighbours that pass on what they have changed
    doubted: set[Key] = field(default_factory=set)  # contributors whose whole evidence has to come anew
    _certificates: dict[int, bytes] = field(default_factory=dict)  # by robot
    _sealed: int = 0  # version of this robot's own

    def seal(self, key: Key, own: SealedSnapshot) -> None:
        """Sign the root of what this robot has seen, if it has changed."""
        if own.version == self._sealed:
            return
        self._sealed, time = own.version, own.seal.time
        signature = self.notary.sign(EVIDENCE, *key, own.version, time, own.root)
        own.seal = Seal(time, own.root, signature)
        self._certificates[key[0]] = self.notary.certificate

    def with_certificate(self, robot: int, base: int, news: Delta[np.uint8]) -> Delta[np.uint8]:
        """Give the certificate to who holds nothing of this robot's yet."""
        assert news.voucher is not None
        certificate = b"" if base else self._certificates[robot]
        return replace(news, voucher=news.voucher._replace(certificate=certificate))

    def admits(self, neighbour: int, key: Key, held: SealedSnapshot, news: Delta[np.uint8]) -> bool:
        """Check who has signed the news, and that they can be so; else say whose fault it is."""
        if not news.base <= held.version < news.version:
            return True
        assert news.voucher is not None
        robot, certificate, seal = key[0], news.voucher.certificate, news.voucher.seal
        try:
            if certificate:
                self.notary.admit(robot, certificate)
            self.notary.check(robot, seal.signature, EVIDENCE, *key, news.version, seal.time, seal.root)
        except ValueError as error:
            return self._refuse(neighbour, robot, f"{error}")
        if held.root_after(news) != seal.root:
            self.doubted.add(key)  # it may be that what this robot holds is another evidence of one version
            return False if news.base else self._refuse(neighbour, robot, "its root is another")
        self.doubted.discard(key)
        if certificate:
            self._certificates[robot] = certificate
        try:
            self.admit(news, held)
        except ValueError as error:
            self.complaints[robot] = f"its evidence is refused: {error}"
            return False
        return True

    def _refuse(self, neighbour: int, robot: int, why: str) -> bool:
        """Note that a neighbour passes on what it has changed: nobody honest does so without checking it."""
        self.forgers.add(neighbour)
        self.complaints[neighbour] = f"what it passes on of robot-{robot + 1} is not that robot's: {why}"
        return False

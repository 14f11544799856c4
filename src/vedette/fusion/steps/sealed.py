"""A log that its writer signs: every holder can tell that it is the writer's, whoever passed it on."""

from __future__ import annotations

import struct
from bisect import bisect_right
from contextlib import suppress
from typing import NamedTuple

from vedette.fusion.contradictions import Histories
from vedette.fusion.link import MOST_BYTES, Key
from vedette.fusion.merkle import Merkle
from vedette.fusion.sealing import Sealings
from vedette.fusion.seals import MOST_CERTIFICATE, SIGNATURE_BYTES, STEPS, Seal
from vedette.fusion.steps.log import Log
from vedette.fusion.steps.wire import Entries, parts

MOST_ENTRIES = 1 << 24  # in one robot's log
_HEAD = struct.Struct(f"<Q{SIGNATURE_BYTES}sH")  # time, signature, size of the certificate


class SealedEntries(NamedTuple):
    """Entries, and their writer's word for the version that they lead to."""

    base: int
    version: int
    data: bytes
    seal: Seal
    certificate: bytes = b""  # empty for who has it

    @property
    def size(self) -> int:
        """Bytes."""
        return len(self.data)

    def certified(self, certificate: bytes) -> SealedEntries:
        """Return the same with a certificate."""
        return self._replace(certificate=certificate)

    def packed(self) -> Entries:
        """Return them as they travel: the seal ahead of the entries."""
        head = _HEAD.pack(*self.seal, len(self.certificate))
        return Entries(self.base, self.version, head + self.certificate + self.data)

    @classmethod
    def unpacked(cls, entries: Entries) -> SealedEntries:
        """Return what ``packed`` was called of; ValueError if it is malformed."""
        if len(entries.data) < _HEAD.size:
            raise ValueError("step evidence: a seal is truncated")
        time, signature, size = _HEAD.unpack_from(entries.data)
        split = _HEAD.size + size
        if time >= 1 << 62 or size > MOST_CERTIFICATE or split > len(entries.data):
            raise ValueError("step evidence: a seal is out of range")
        certificate = entries.data[_HEAD.size : split]
        seal = Seal(time, signature)
        return cls(entries.base, entries.version, entries.data[split:], seal, certificate)


class SealedLog(Log):
    """The entries are the leaves of a Merkle tree; what is told of it ends where its writer has signed."""

    def __init__(self) -> None:
        super().__init__()
        self.time = 0  # of the writer's latest entry, by its own clock [0.1 s]
        self.root = b""
        self._tree = Merkle(MOST_ENTRIES)
        self._signed: list[int] = []  # versions, increasing
        self._seals: list[Seal] = []  # of these

    @property
    def seal(self) -> Seal:
        """The writer's word for the latest version; of the time alone if that is not signed."""
        is_signed = bool(self._signed) and self._signed[-1] == self.version
        return self._seals[-1] if is_signed else Seal(self.time, b"")

    def put_seal(self, seal: Seal) -> None:
        """Note the writer's word for the latest version."""
        self._signed.append(self.version)
        self._seals.append(seal)

    def append(self, entry: bytes) -> None:
        """Add an entry; ValueError if there are too many."""
        if self.version == MOST_ENTRIES:
            raise ValueError(f"step evidence: more than {MOST_ENTRIES} entries of one robot")
        self.root, nodes = self._tree.with_leaves({self.version: entry})
        self._tree.put(nodes)
        super().append(entry)

    def since(self, base: int) -> SealedEntries:
        """Return the entries from ``base`` to a signed version, as many as a payload takes, or the next."""
        at = bisect_right(self._signed, base)
        while at + 1 < len(self._signed) and self.length(base, self._signed[at + 1]) <= MOST_BYTES:
            at += 1
        version = self._signed[at]
        return SealedEntries(base, version, self.data(base, version), self._seals[at])

    def root_after(self, news: SealedEntries) -> bytes:
        """Return the root that there would be after news that connect; nothing changes."""
        entries = [part.entry for part in parts(news.data)][self.version - news.base :]
        return self._tree.with_leaves(dict(enumerate(entries, self.version)))[0]


class LogSealings(Sealings[SealedLog, SealedEntries]):
    """Of logs, which are only ever added to."""

    kind = STEPS

    def admit(self, news: SealedEntries, held: SealedLog) -> None:
        """Refuse nothing: what evidence of a step may be is checked where it is decoded."""

    def blank(self) -> SealedLog:
        """Return one without entries."""
        return SealedLog()

    def unlike(self, neighbour: int, key: Key, held: SealedLog, news: SealedEntries, why: str) -> bool:
        """Tell apart who has signed two histories, and who has changed one."""
        if news.base == 0 < held.version:
            late = self.word(key, news.version, news.seal, self.blank().root_after(news))
            with suppress(ValueError):
                late.check(self.standing.notary, key[0])
                self.doubted.discard(key)
                early = self.word(key, held.version, held.seal, held.root)
                self.standing.catch(key[0], Histories(early, late, news.data))
                return False
        return super().unlike(neighbour, key, held, news, why)

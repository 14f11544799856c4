"""Fingerprints of evidence: 64 bits that agree iff it does."""

from __future__ import annotations

import hashlib


def fingerprint(data: bytes, part: int) -> int:
    """Return a 64-bit hash of some bytes and the number of the part that they are."""
    salt = part.to_bytes(8, "little")
    return int.from_bytes(hashlib.blake2b(data, digest_size=8, salt=salt).digest(), "little")


class Digest:
    """Exclusive or of the fingerprints of numbered parts: kept up part by part, whatever their order."""

    def __init__(self) -> None:
        self.value = 0  # equal (up to 2^-64) iff all parts are
        self._prints: dict[int, int] = {}

    def put(self, part: int, data: bytes) -> None:
        """Take a part's present bytes; none if it says nothing."""
        fresh = fingerprint(data, part) if data else 0
        self.value ^= self._prints.get(part, 0) ^ fresh
        self._prints[part] = fresh

    def drop(self, before: int) -> None:
        """Leave out the parts of lower numbers."""
        for part in [part for part in self._prints if part < before]:
            self.value ^= self._prints.pop(part)

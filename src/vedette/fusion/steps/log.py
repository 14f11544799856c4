"""One contributor's entries in order, of which only ever more are added."""

from __future__ import annotations

from abc import ABC, abstractmethod
from array import array
from typing import Any

from vedette.fusion.link import MOST_BYTES
from vedette.fusion.steps.wire import Entries


class Log(ABC):
    """One contributor's entries in order; its version is their number, and a holder's copy is a prefix."""

    def __init__(self) -> None:
        self._data = bytearray()
        self._ends = array("q", [0])  # where the first v entries end

    @property
    def version(self) -> int:
        """Number of entries."""
        return len(self._ends) - 1

    def append(self, entry: bytes) -> None:
        """Add an entry."""
        self._data += entry
        self._ends.append(len(self._data))

    @abstractmethod
    def since(self, base: int) -> Any:
        """Return the entries from a version on, or their beginning."""

    def overtake(self, version: int) -> None:
        """Refuse it: entries are only ever added."""
        raise ValueError("fusion payload: claims evidence of this robot that it never published")

    def data(self, base: int, version: int) -> bytes:
        """Return the entries from one version to another."""
        return bytes(self._data[self._ends[base] : self._ends[version]])

    def length(self, base: int, version: int) -> int:
        """Return how many bytes these are."""
        return self._ends[version] - self._ends[base]


class PlainLog(Log):
    """A log that nobody signs."""

    def since(self, base: int) -> Entries:
        """Return the entries from ``base`` on, as many as one payload takes, but at least one."""
        version = self.version
        while version > base + 1 and self.length(base, version) > MOST_BYTES:
            version = (version + base) // 2
        return Entries(base, version, self.data(base, version))

"""Replicated step evidence: everybody's own log, kept apart by contributor, summed step by step."""

from __future__ import annotations

from array import array
from collections.abc import Sequence
from typing import TypeVar

from vedette.fusion.contributors import Contributors
from vedette.fusion.link import MOST_BYTES, RESEND_AFTER, Key
from vedette.fusion.steps.elements import Elements
from vedette.fusion.steps.totals import Totals
from vedette.fusion.steps.wire import Entries, check_step, decode, encode, pack, unpack

E = TypeVar("E")


class Log:
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

    def overtake(self, version: int) -> None:
        """Refuse it: entries are only ever added."""
        raise ValueError("fusion payload: claims evidence of this robot that it never published")

    def since(self, base: int) -> Entries:
        """Return the entries from ``base`` on, as many as one payload takes, but at least one."""
        version = self.version
        while version > base + 1 and self._ends[version] - self._ends[base] > MOST_BYTES:
            version = (version + base) // 2
        return Entries(base, version, bytes(self._data[self._ends[base] : self._ends[version]]))


class ReplicatedSteps(Totals[E]):
    """``total(k) = sum over contributors of what each published for step k``, on any graph.

    Memory is O(contributors x steps). Nothing is forgotten: a robot that joins late needs the old steps, and
    only those who keep them can tell. (Two hours at 1 Hz, 16 robots that see six targets each: 37 MB.)
    """

    def __init__(
        self, robot: int, boot: int, elements: Elements[E], *, resend_after: float = RESEND_AFTER
    ) -> None:
        """Start with nothing known; ``boot < 2**38`` must differ from those of the robot's earlier starts."""
        super().__init__(elements)
        self._contributors: Contributors[Log, Entries] = Contributors(robot, boot, Log, resend_after)

    @property
    def open_from(self) -> int:
        """0: evidence of any step may still come."""
        return 0

    def publish(self, step: int, element: E) -> None:
        """Add the robot's own evidence of a step."""
        check_step(step)
        self._contributors.own.append(pack(step, self._elements.encode(element)))
        self.add(step, element)

    def forget(self, before: int) -> None:
        """Keep everything: no step is closed."""

    def contributors(self) -> int:
        """Return how many robots' evidence this robot holds; each start of a robot counts."""
        return len(self._contributors.known())

    def set_neighbours(self, neighbours: Sequence[int]) -> None:
        """Exchange with exactly these robots from now on; the graph may have cycles."""
        self._contributors.set_neighbours(neighbours)

    def outgoing(self, neighbour: int, now: float) -> bytes | None:
        """Return what the neighbour lacks, and what it waits to see acknowledged; None if nothing."""
        payload = self._contributors.tell(neighbour, now)
        return None if payload is None else encode(payload)

    def receive(self, neighbour: int, payload: bytes, now: float) -> None:
        """Merge a neighbour's payload (ValueError if malformed, and nothing changes)."""
        message = decode(payload)
        new = {key: self._new(key, entries) for key, entries in message.sections}
        for key, _ in self._contributors.hear(neighbour, message, now):
            for step, element, entry in new[key]:
                self._contributors.copies[key].append(entry)
                self.add(step, element)

    def _new(self, key: Key, entries: Entries) -> list[tuple[int, E, bytes]]:
        """Return what some entries add to our copy of their log, decoded; nothing if they do not connect."""
        found = unpack(entries.data, self._elements.most_bytes)
        if entries.base + len(found) != entries.version:
            raise ValueError("step evidence: a section's versions and entries do not agree")
        copy = self._contributors.copies.get(key)
        held = copy.version if copy else 0
        if entries.base > held:
            return []
        more = found[held - entries.base :]
        return [(step, self._elements.decode(data), entry) for step, data, entry in more]

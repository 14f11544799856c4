"""Replicated step evidence: everybody's own log, kept apart by contributor, summed step by step."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Generic, Protocol, TypeVar

from vedette.fusion.contributors import Contributors
from vedette.fusion.link import RESEND_AFTER, Key, News, Payload
from vedette.fusion.steps.elements import Elements
from vedette.fusion.steps.log import Log, PlainLog
from vedette.fusion.steps.totals import Totals
from vedette.fusion.steps.wire import Entries, check_step, decode, encode, pack, unpack

E = TypeVar("E")
LogT = TypeVar("LogT", bound=Log)


class EntriesNews(News, Protocol):
    """Entries as they travel, sealed or not."""

    @property
    def base(self) -> int:
        """The least version that they can be added to."""

    @property
    def data(self) -> bytes:
        """The entries."""


NewsT = TypeVar("NewsT", bound=EntriesNews)


class SharedLogs(Totals[E], ABC, Generic[E, LogT, NewsT]):
    """``total(k) = sum over contributors of what each published for step k``, on any graph.

    Memory is O(contributors x steps). Nothing is forgotten: a robot that joins late needs the old steps, and
    only those who keep them can tell. (Two hours at 1 Hz, 16 robots that see six targets each: 37 MB.)
    """

    def __init__(self, elements: Elements[E], contributors: Contributors[LogT, NewsT]) -> None:
        """Start with nothing known; ``contributors`` are this robot's, who writes its own."""
        super().__init__(elements)
        self._contributors = contributors

    @property
    def open_from(self) -> int:
        """0: evidence of any step may still come."""
        return 0

    def publish(self, step: int, element: E) -> None:
        """Add the robot's own evidence of a step."""
        check_step(step)
        self._contributors.own.append(pack(step, self._elements.encode(element)))
        self._take(self._contributors.key, step, element)

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
        return None if payload is None else self._encode(payload)

    def receive(self, neighbour: int, payload: bytes, now: float) -> None:
        """Merge a neighbour's payload (ValueError if malformed, and nothing changes)."""
        message = self._decode(payload)
        new = {key: self._new(key, entries) for key, entries in message.sections}
        for key, news in self._contributors.hear(neighbour, message, now):
            for step, element, entry in new[key]:
                self._contributors.copies[key].append(entry)
                self._take(key, step, element)
            if new[key]:
                self._taken(key, news)

    def _new(self, key: Key, entries: NewsT) -> list[tuple[int, E, bytes]]:
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

    def _take(self, key: Key, step: int, element: E) -> None:
        """Add what a contributor says of a step."""
        self.add(step, element)

    def _taken(self, key: Key, news: NewsT) -> None:
        """Note that a contributor's copy has come to the version of some news."""

    @abstractmethod
    def _encode(self, payload: Payload[NewsT]) -> bytes:
        """Return a payload's bytes."""

    @abstractmethod
    def _decode(self, data: bytes) -> Payload[NewsT]:
        """Return the payload; ValueError if malformed."""


class ReplicatedSteps(SharedLogs[E, PlainLog, Entries]):
    """Step evidence that nobody signs: whoever passes it on is believed."""

    def __init__(
        self, robot: int, boot: int, elements: Elements[E], *, resend_after: float = RESEND_AFTER
    ) -> None:
        """Start with nothing known; ``boot < 2**38`` must differ from those of the robot's earlier starts."""
        super().__init__(elements, Contributors(robot, boot, PlainLog, resend_after))

    def _encode(self, payload: Payload[Entries]) -> bytes:
        return encode(payload)

    def _decode(self, data: bytes) -> Payload[Entries]:
        return decode(data)

"""Replicated step evidence: everybody's own log, kept apart by contributor, summed step by step."""

from __future__ import annotations

from array import array
from collections.abc import Sequence
from typing import Generic, TypeVar

from vedette.fusion.link import Boots, Key, Link, check_boot
from vedette.fusion.steps.elements import Elements
from vedette.fusion.steps.totals import Totals
from vedette.fusion.steps.wire import (
    Have,
    Payload,
    Section,
    check_step,
    decode,
    encode,
    pack,
    unpack,
)

E = TypeVar("E")

RESEND_AFTER = 2.5  # [s]: more than two of the agents' 1 s rounds, one to send and one to acknowledge
MOST_CONTRIBUTORS = 1024
MOST_BYTES = 1 << 20  # of evidence in a payload, but at least one entry


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

    def since(self, base: int) -> tuple[int, bytes]:
        """Return the entries from ``base`` on, as many as one payload takes, and the version they lead to."""
        version = self.version
        while version > base + 1 and self._ends[version] - self._ends[base] > MOST_BYTES:
            version = (version + base) // 2
        return version, bytes(self._data[self._ends[base] : self._ends[version]])


class ReplicatedSteps(Generic[E]):
    """``total(k) = sum over contributors of what each published for step k``, on any graph.

    A contributor is one start of one robot, ``(robot, boot)``; only it appends to its log, so copies merge
    by "the longer one wins". Loss, repetition, reordering, cycles, partition, re-joining and restarts neither
    lose evidence that any holder lives to tell, nor count any twice; a dead robot's evidence survives.

    Memory is O(contributors x steps). Nothing is forgotten: a robot that joins late needs the old steps, and
    only those who keep them can tell. (Two hours at 1 Hz, 16 robots that see six targets each: 37 MB.)
    """

    def __init__(
        self, robot: int, boot: int, elements: Elements[E], *, resend_after: float = RESEND_AFTER
    ) -> None:
        """Start with nothing known; ``boot < 2**38`` must differ from those of the robot's earlier starts."""
        check_boot(boot)
        self._key: Key = (robot, boot)
        self._elements = elements
        self._totals = Totals(elements)
        self._own = Log()
        self._logs: dict[Key, Log] = {self._key: self._own}
        self._links: dict[int, Link] = {}
        self._boots = Boots()
        self._resend_after = resend_after

    @property
    def digest(self) -> int:
        """64 bits that agree iff the totals do."""
        return self._totals.digest

    @property
    def open_from(self) -> int:
        """0: evidence of any step may still come."""
        return 0

    def publish(self, step: int, element: E) -> None:
        """Add the robot's own evidence of a step."""
        check_step(step)
        self._own.append(pack(step, self._elements.encode(element)))
        self._totals.add(step, element)

    def total(self, step: int) -> E:
        """Return the sum of everybody's known evidence of a step."""
        return self._totals[step]

    def steps(self) -> list[int]:
        """Return the steps with evidence, increasing."""
        return self._totals.steps()

    def take_changed(self) -> int | None:
        """Return the earliest step whose total changed since last asked, or None."""
        return self._totals.take_changed()

    def forget(self, before: int) -> None:
        """Keep everything: no step is closed."""

    def contributors(self) -> int:
        """Return how many robots' evidence this robot holds; each start of a robot counts."""
        return sum(log.version > 0 for log in self._logs.values())

    def set_neighbours(self, neighbours: Sequence[int]) -> None:
        """Exchange with exactly these robots from now on; the graph may have cycles."""
        boot, after = self._key[1], self._resend_after
        self._links = {n: self._links.get(n) or Link(boot, after) for n in neighbours}

    def outgoing(self, neighbour: int, now: float) -> bytes | None:
        """Return what the neighbour lacks, and what it waits to see acknowledged; None if nothing."""
        link = self._links[neighbour]
        greeting = link.greeting(now)
        held = [key for key, log in self._logs.items() if log.version] if greeting else sorted(link.owed)
        have = tuple(Have(*key, self._logs[key].version) for key in held)
        link.owed.clear()
        sections = self._sections(link, now) if link.met else ()
        if greeting is None and not have and not sections:
            return None
        return encode(Payload(link.nonce, greeting, have, sections))

    def receive(self, neighbour: int, payload: bytes, now: float) -> None:
        """Merge a neighbour's payload (ValueError if malformed, and nothing changes)."""
        message = decode(payload)
        news = [(section, self._news(section)) for section in message.sections]
        self._check(message)
        link = self._links.get(neighbour)
        if link is not None:
            if self._boots.is_stale(neighbour, message.nonce):
                link = None  # evidence is evidence, but what that start of the neighbour held is lost
            else:
                link.hear(message.nonce, message.greeting, message.versions, now)
        for section, entries in news:
            key = (section.robot, section.nonce)
            if key == self._key:
                continue
            log = self._logs.setdefault(key, Log())
            for step, element, entry in entries:
                log.append(entry)
                self._totals.add(step, element)
            if link is not None:
                link.owed.add(key)
                link.holds(key, section.version, now)

    def _sections(self, link: Link, now: float) -> tuple[Section, ...]:
        sections: list[Section] = []
        size = 0
        for key, log in self._logs.items():
            base = link.base(key, now)
            if base >= log.version:
                continue
            if size >= MOST_BYTES or len(sections) == MOST_CONTRIBUTORS:
                break  # the rest goes with the next call
            version, entries = log.since(base)
            link.sending(key, base, version, now)
            sections.append(Section(*key, base, version, entries))
            size += len(entries)
        return tuple(sections)

    def _news(self, section: Section) -> list[tuple[int, E, bytes]]:
        """Return what a section adds to our copy of its log, decoded; nothing if it does not connect."""
        entries = unpack(section.entries, self._elements.most_bytes)
        if section.base + len(entries) != section.version:
            raise ValueError("step evidence: a section's versions and entries do not agree")
        log = self._logs.get((section.robot, section.nonce))
        held = log.version if log else 0
        if section.base > held:
            return []
        return [
            (step, self._elements.decode(data), entry) for step, data, entry in entries[held - section.base :]
        ]

    def _check(self, message: Payload) -> None:
        told = [*message.versions.items(), *(((s.robot, s.nonce), s.version) for s in message.sections)]
        if any(key == self._key and version > self._own.version for key, version in told):
            raise ValueError("step evidence: claims evidence of this robot that it never published")
        keys = {(section.robot, section.nonce) for section in message.sections}
        if len(keys) < len(message.sections):
            raise ValueError("step evidence: two sections of one stream")
        if len(self._logs) + len(keys - self._logs.keys()) > MOST_CONTRIBUTORS:
            raise ValueError(f"step evidence: more than {MOST_CONTRIBUTORS} contributors")

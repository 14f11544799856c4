"""What one neighbour is told, and known to hold: versions, acknowledgements, resending, greetings."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Generic, NamedTuple, Protocol, TypeVar

Key = tuple[int, int]  # a stream of versions: (robot, nonce)

RESEND_AFTER = 2.5  # [s]: more than two of the agents' 1 s rounds, one to send and one to acknowledge
MOST_STREAMS = 4096  # that one neighbour is taken to hold
MOST_SECTIONS = 1024  # in a payload
MOST_BYTES = 1 << 20  # of evidence in a payload, from which no further section is begun
BOOT_BITS = 38


class News(Protocol):
    """What turns a version of a stream into a later one."""

    @property
    def version(self) -> int:
        """The later version."""

    @property
    def size(self) -> int:
        """Bytes, about."""


NewsT = TypeVar("NewsT", bound=News)
Stream = tuple[Key, int, Callable[[int], NewsT]]  # its latest version, and what is new since an earlier one


class Greeting(NamedTuple):
    """Marks a payload whose ``have`` lists everything that the sender holds."""

    echo: int  # nonce of the receiver that this answers; -1 before it was heard
    wants: bool  # the receiver's greeting is wanted in turn


@dataclass(frozen=True)
class Payload(Generic[NewsT]):
    """What one robot tells one neighbour."""

    nonce: int  # the sender's side of the link
    greeting: Greeting | None = None
    have: dict[Key, int] = field(default_factory=dict)  # versions that the sender holds
    sections: list[tuple[Key, NewsT]] = field(default_factory=list)

    def told_of(self, key: Key) -> int:
        """Return the latest version of a stream that it tells of; 0: none."""
        told = [*self.have.items(), *((stream, news.version) for stream, news in self.sections)]
        return max((version for stream, version in told if stream == key), default=0)

    def check(self, key: Key, version: int) -> None:
        """Raise ValueError if it tells more of the receiver's own stream than there is."""
        if self.told_of(key) > version:
            raise ValueError("fusion payload: claims evidence of this robot that it never published")


class EvidenceLink(Generic[NewsT]):
    """One robot's book-keeping of one neighbour; versions only, no evidence.

    Optimistic: what was sent counts as held until ``resend_after`` seconds pass without the neighbour's
    acknowledged version moving; then sending starts again from the acknowledged version. So evidence is
    sent once on a good link and arrives in the end on a lossy one.
    """

    def __init__(self, robot: int, nonce: int, resend_after: float) -> None:
        self.key = (robot, nonce)  # our side of the link; the nonce is told in every payload
        self.peer = -1  # the neighbour's side; -1: never heard
        self._met = False  # they have told everything that they hold
        self._owed: set[Key] = set()  # streams to acknowledge
        self._resend_after = resend_after
        self._owes_greeting = False  # they asked what we hold
        self._answered = False  # they have answered our greeting
        self._asked_at = -float("inf")
        self._have: dict[Key, int] = {}
        self._sent: dict[Key, int] = {}
        self._waiting_since: dict[Key, float] = {}

    def hear(self, payload: Payload[NewsT], now: float) -> None:
        """Note what a payload says of its sender's side of the link, and owe an acknowledgement."""
        if payload.nonce != self.peer:
            self._restart(payload.nonce)
        if payload.greeting is not None:
            self._met = True
            self._answered |= payload.greeting.echo == self.key[1]
            self._owes_greeting |= payload.greeting.wants
        for key, version in payload.have.items():
            self._holds(key, version, now)
        for key, news in payload.sections:  # our own among them, where it came to them by another way
            self._owed.add(key)
            self._holds(key, news.version, now)

    def tell(
        self, held: Mapping[Key, int], streams: Iterable[Stream[NewsT]], now: float
    ) -> Payload[NewsT] | None:
        """Return what the neighbour lacks of some streams, and what it waits to see; None if nothing.

        ``held`` are the versions of all streams that come over this link.
        """
        greeting = self.greeting(now)
        have = dict(held) if greeting else {key: held.get(key, 0) for key in sorted(self._owed)}
        self._owed.clear()
        sections = self._sections(streams, now) if self._met else []
        return Payload(self.key[1], greeting, have, sections) if greeting or have or sections else None

    def greeting(self, now: float) -> Greeting | None:
        """Return the greeting due in the next payload: to answer theirs, and until ours is answered."""
        wants = not self._answered and now - self._asked_at >= self._resend_after
        if not wants and not self._owes_greeting:
            return None
        self._owes_greeting = False
        if wants:
            self._asked_at = now
        return Greeting(self.peer, wants)

    def _sections(self, streams: Iterable[Stream[NewsT]], now: float) -> list[tuple[Key, NewsT]]:
        sections: list[tuple[Key, NewsT]] = []
        size = 0
        for key, version, since in streams:
            base = self._base(key, now)
            if base >= version:
                continue
            if size > MOST_BYTES or len(sections) == MOST_SECTIONS:
                break  # the rest goes with the next call
            news = since(base)
            if base == self._have.get(key, 0):
                self._waiting_since[key] = now
            self._sent[key] = news.version
            sections.append((key, news))
            size += news.size
        return sections

    def _holds(self, key: Key, version: int, now: float) -> None:
        """Note that the neighbour holds this version; 0: nothing that it could use, so that all goes anew."""
        if version == 0:
            self._have.pop(key, None)
            self._sent.pop(key, None)
        if version > self._have.get(key, 0) and (key in self._have or len(self._have) < MOST_STREAMS):
            self._have[key] = version
            self._waiting_since[key] = now

    def _base(self, key: Key, now: float) -> int:
        """Return the version from which to send: what the neighbour holds, or soon will."""
        have = self._have.get(key, 0)
        sent = self._sent.get(key, 0)
        overdue = now - self._waiting_since.get(key, now) >= self._resend_after
        return have if sent < have or overdue else sent

    def _restart(self, peer: int) -> None:
        self.peer = peer
        self._met = self._answered = False
        self._owed.clear()
        self._have.clear()
        self._sent.clear()


def check_boot(boot: int) -> None:
    """Raise ValueError unless the number of a robot's start fits a payload."""
    if not 0 <= boot < 1 << BOOT_BITS:
        raise ValueError(f"boot must lie in 0..2**{BOOT_BITS} - 1; got {boot}")


class Boots:
    """Which start of each robot is the latest: a payload of an earlier start, come late, is no news."""

    def __init__(self) -> None:
        self._latest: dict[int, int] = {}

    def is_stale(self, robot: int, boot: int) -> bool:
        """Tell whether a later start of the robot was heard before: boots grow from start to start."""
        latest = self._latest[robot] = max(boot, self._latest.get(robot, boot))
        return boot < latest

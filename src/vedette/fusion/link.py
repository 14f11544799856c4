"""What one neighbour is known to hold: acknowledgements, resending, and the greeting of a new link."""

from __future__ import annotations

from typing import NamedTuple

Key = tuple[int, int]  # a stream of versions: (robot, nonce)

MOST_STREAMS = 4096  # that one neighbour is taken to hold
BOOT_BITS = 38


class Greeting(NamedTuple):
    """Marks a payload whose ``have`` lists everything that the sender holds."""

    echo: int  # nonce of the receiver that this answers; -1 before it was heard
    wants: bool  # the receiver's greeting is wanted in turn


class Link:
    """One robot's book-keeping of one neighbour; versions only, no evidence.

    Optimistic: what was sent counts as held until ``resend_after`` seconds pass without the neighbour's
    acknowledged version moving; then sending starts again from the acknowledged version. So evidence is
    sent once on a good link and arrives in the end on a lossy one.
    """

    def __init__(self, nonce: int, resend_after: float) -> None:
        self.nonce = nonce  # our side of the link, told in every payload
        self.peer = -1  # the neighbour's side; -1: never heard
        self.met = False  # they have told everything that they hold
        self.owed: set[Key] = set()  # streams to acknowledge
        self._resend_after = resend_after
        self._owes_greeting = False  # they asked what we hold
        self._answered = False  # they have answered our greeting
        self._asked_at = -float("inf")
        self._have: dict[Key, int] = {}
        self._sent: dict[Key, int] = {}
        self._waiting_since: dict[Key, float] = {}

    def holds(self, key: Key, version: int, now: float) -> None:
        """Note that the neighbour holds this version."""
        if version > self._have.get(key, 0) and (key in self._have or len(self._have) < MOST_STREAMS):
            self._have[key] = version
            self._waiting_since[key] = now

    def hear(self, nonce: int, greeting: Greeting | None, have: dict[Key, int], now: float) -> None:
        """Note what a payload says of its sender's side of the link."""
        if nonce != self.peer:
            self._restart(nonce)
        if greeting is not None:
            self.met = True
            self._answered |= greeting.echo == self.nonce
            self._owes_greeting |= greeting.wants
        for key, version in have.items():
            self.holds(key, version, now)

    def greeting(self, now: float) -> Greeting | None:
        """Return the greeting due in the next payload: to answer theirs, and until ours is answered."""
        wants = not self._answered and now - self._asked_at >= self._resend_after
        if not wants and not self._owes_greeting:
            return None
        self._owes_greeting = False
        if wants:
            self._asked_at = now
        return Greeting(self.peer, wants)

    def base(self, key: Key, now: float) -> int:
        """Return the version from which to send: what the neighbour holds, or soon will."""
        have = self._have.get(key, 0)
        sent = self._sent.get(key, 0)
        overdue = now - self._waiting_since.get(key, now) >= self._resend_after
        return have if sent < have or overdue else sent

    def sending(self, key: Key, base: int, version: int, now: float) -> None:
        """Note that ``(base, version]`` is on its way."""
        if base == self._have.get(key, 0):
            self._waiting_since[key] = now
        self._sent[key] = version

    def _restart(self, peer: int) -> None:
        self.peer = peer
        self.met = self._answered = False
        self.owed.clear()
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

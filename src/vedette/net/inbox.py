"""Where what arrives waits for the one thread that deals with it."""

from __future__ import annotations

import queue
import threading
from collections import Counter
from dataclasses import dataclass
from typing import TypeGuard

from vedette.agent.networked import BEACON

MOST_EVENTS = 4096
MOST_BYTES = 1 << 26
MOST_OF_ONE = 1024  # datagrams of one neighbour that wait
MUCH = 100  # datagrams beyond a neighbour's share are worth a complaint
MOST_BEACONS = 32  # of these, beacons: the next one is worth more than all before


@dataclass(frozen=True)
class ReceivedDatagram:
    """Bytes from a neighbour."""

    robot: int
    payload: bytes
    time: float  # of arrival [s]


@dataclass(frozen=True)
class PeerSeen:
    """A robot can be sent to."""

    robot: int
    time: float  # [s]


@dataclass(frozen=True)
class PeerGone:
    """A robot that could be sent to has closed its session, died, or been silent for a lease."""

    robot: int
    time: float  # [s]


class Inbox:
    """A queue of bounded size that any thread may put into and one takes from.

    What does not fit is dropped and counted in ``dropped``, as a network would drop it: datagrams when they
    come; anything else makes room for itself by dropping the oldest. Each neighbour has a share, and its
    beacons a small one of that: whoever floods drowns nobody but itself.
    """

    def __init__(self, most_events: int = MOST_EVENTS, most_bytes: int = MOST_BYTES) -> None:
        self._most_events, self._most_bytes = most_events, most_bytes
        self._queue: queue.Queue[object] = queue.Queue()  # a simple one waits for ever where a signal came
        self._lock = threading.Lock()
        self._bytes = 0
        self._waiting: Counter[tuple[int, bool]] = Counter()  # by neighbour, beacons apart
        self._bytes_of: Counter[int] = Counter()
        self._dropped_of: Counter[int] = Counter()  # beyond what a neighbour may say
        self.dropped = 0

    def put(self, event: object) -> None:
        """Add an event, if it fits; never waits."""
        with self._lock:
            if self._is_too_much(event):
                self.dropped += 1
                self._dropped_of[event.robot] += 1
                return
            if self._queue.qsize() >= self._most_events:
                self.dropped += 1
                if isinstance(event, ReceivedDatagram):
                    return
                self._count(self._queue.get(), -1)
            self._count(event, 1)
            self._queue.put(event)

    def get(self, timeout: float | None = None) -> object | None:
        """Return the oldest event; None if none comes within ``timeout`` [s], None being for ever."""
        try:
            event = self._queue.get(timeout=None if timeout is None else max(timeout, 0.0))
        except queue.Empty:
            return None
        with self._lock:
            self._count(event, -1)
        return event

    @property
    def drowning(self) -> frozenset[int]:
        """Neighbours of whose datagrams many did not fit."""
        with self._lock:
            return frozenset(robot for robot, count in self._dropped_of.items() if count >= MUCH)

    def _is_too_much(self, event: object) -> TypeGuard[ReceivedDatagram]:
        """Tell whether a datagram is beyond what there is room for, or beyond its neighbour's share."""
        if not isinstance(event, ReceivedDatagram):
            return False
        robot, size, is_beacon = event.robot, len(event.payload), event.payload.startswith(BEACON)
        most = MOST_BEACONS if is_beacon else MOST_OF_ONE
        return (
            self._waiting[robot, is_beacon] >= most
            or (self._bytes_of[robot] > 0 and self._bytes_of[robot] + size > self._most_bytes // 2)
            or self._bytes + size > self._most_bytes
        )

    def _count(self, event: object, sign: int) -> None:
        if isinstance(event, ReceivedDatagram):
            self._bytes += sign * len(event.payload)
            self._bytes_of[event.robot] += sign * len(event.payload)
            self._waiting[event.robot, event.payload.startswith(BEACON)] += sign

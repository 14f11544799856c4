"""Where what arrives waits for the one thread that deals with it."""

from __future__ import annotations

import queue
import threading
from dataclasses import dataclass

MOST_EVENTS = 4096
MOST_BYTES = 1 << 26


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
    come; anything else makes room for itself by dropping the oldest.
    """

    def __init__(self, most_events: int = MOST_EVENTS, most_bytes: int = MOST_BYTES) -> None:
        self._most_events, self._most_bytes = most_events, most_bytes
        self._queue: queue.SimpleQueue[object] = queue.SimpleQueue()
        self._lock = threading.Lock()
        self._bytes = 0
        self.dropped = 0

    def put(self, event: object) -> None:
        """Add an event, if it fits; never waits."""
        size = _size(event)
        with self._lock:
            if size and self._bytes + size > self._most_bytes:
                self.dropped += 1
                return
            if self._queue.qsize() >= self._most_events:
                self.dropped += 1
                if isinstance(event, ReceivedDatagram):
                    return
                self._bytes -= _size(self._queue.get())
            self._bytes += size
            self._queue.put(event)

    def get(self, timeout: float | None = None) -> object | None:
        """Return the oldest event; None if none comes within ``timeout`` [s], None being for ever."""
        try:
            event = self._queue.get(timeout=None if timeout is None else max(timeout, 0.0))
        except queue.Empty:
            return None
        with self._lock:
            self._bytes -= _size(event)
        return event


def _size(event: object) -> int:
    return len(event.payload) if isinstance(event, ReceivedDatagram) else 0

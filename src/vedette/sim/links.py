"""The ideal links of a planted tree: every message arrives, in order, after a delay."""

from __future__ import annotations

import heapq
from collections import defaultdict
from dataclasses import dataclass, field

from vedette.agent.effects import Send, TrafficKind


@dataclass
class Wires:
    """Links with a delay, and a count of what was sent over them."""

    robots: int
    delay: float  # one way [s]
    messages_sent: dict[TrafficKind, list[int]] = field(init=False)  # by kind and robot
    bytes_sent: dict[TrafficKind, list[int]] = field(init=False)
    _queue: list[tuple[float, int, int, int, bytes]] = field(default_factory=list)
    _sent: int = 0
    _last: defaultdict[tuple[int, int], float] = field(default_factory=lambda: defaultdict(float))

    def __post_init__(self) -> None:
        self.messages_sent = {kind: [0] * self.robots for kind in TrafficKind}
        self.bytes_sent = {kind: [0] * self.robots for kind in TrafficKind}

    def send(self, sender: int, send: Send, now: float) -> None:
        """Put a message on its link."""
        self.messages_sent[send.traffic][sender] += 1
        self.bytes_sent[send.traffic][sender] += len(send.payload)
        link = sender, send.to
        self._last[link] = max(self._last[link], now + self.delay)
        self._sent += 1
        heapq.heappush(self._queue, (self._last[link], self._sent, sender, send.to, send.payload))

    def next_arrival(self) -> float:
        """Return when the next message arrives [s]; inf if none is under way."""
        return self._queue[0][0] if self._queue else float("inf")

    def arrive(self) -> tuple[float, int, int, bytes]:
        """Take the next message: time, sender, receiver, payload."""
        time, _, sender, receiver, payload = heapq.heappop(self._queue)
        return time, sender, receiver, payload

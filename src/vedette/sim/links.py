"""The ideal links of a planted tree: every message arrives, in order, after a delay."""

from __future__ import annotations

import heapq
import itertools
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field

from vedette.agent.effects import Send, TrafficKind
from vedette.agent.events import Message


@dataclass
class Wires:
    """Links with a delay, and a count of what was sent over them."""

    robots: int
    delay: float  # one way [s]
    messages_sent: dict[TrafficKind, list[int]] = field(init=False)  # by kind and robot
    bytes_sent: dict[TrafficKind, list[int]] = field(init=False)
    _queue: list[tuple[float, int, int, list[Message]]] = field(default_factory=list)  # time, number, to
    _beacons: dict[int, tuple[float, list[Message]]] = field(default_factory=dict)  # last batch by receiver
    _count: Iterator[int] = field(default_factory=itertools.count)
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
        arrival, message = self._last[link], Message(sender, send.payload)
        time, batch = self._beacons.get(send.to, (-1.0, []))
        if send.traffic is TrafficKind.BEACONS and time == arrival:
            batch.append(message)
            return
        heapq.heappush(self._queue, (arrival, next(self._count), send.to, batch := [message]))
        if send.traffic is TrafficKind.BEACONS:
            self._beacons[send.to] = arrival, batch

    def next_arrival(self) -> float:
        """Return when the next messages arrive [s]; inf if none are under way."""
        return self._queue[0][0] if self._queue else float("inf")

    def arrive(self) -> tuple[float, int, list[Message]]:
        """Take what arrives next: time, receiver, and a message, or all beacons that it gets then."""
        time, _, receiver, batch = heapq.heappop(self._queue)
        if receiver in self._beacons and self._beacons[receiver][1] is batch:
            del self._beacons[receiver]
        return time, receiver, batch

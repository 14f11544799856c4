"""Faults of links done to a real network: each robot's process loses, delays and doubles what it sends."""

from __future__ import annotations

import heapq
import itertools
from collections.abc import Iterator

import numpy as np

from vedette.sim.faults.timeline import Timeline


class StagedLinks:
    """What one robot's datagrams go through before they are sent; times are the schedule's [s]."""

    def __init__(self, timeline: Timeline, robot: int, rng: np.random.Generator) -> None:
        """Stage the links of robot ``robot``, by index."""
        self._timeline, self._robot, self._rng = timeline, robot, rng
        self._queue: list[tuple[float, int, int, bytes]] = []  # when to send, number, to whom, what
        self._count = itertools.count()

    def put(self, to: int, payload: bytes, now: float) -> None:
        """Take a datagram, and lose it if that is its fate."""
        self._timeline.advance(now)
        weather = self._timeline.weather
        blocked = weather.blocked is not None and bool(weather.blocked[self._robot, to])
        if blocked or self._rng.random() < weather.loss:
            return
        low, high = weather.delay or (0.0, 0.0)
        for _ in range(1 + (self._rng.random() < weather.repeat)):
            due = now + low + (high - low) * self._rng.random()
            heapq.heappush(self._queue, (due, next(self._count), to, payload))

    def take(self, now: float) -> Iterator[tuple[int, bytes]]:
        """Yield what is to be sent by now: to whom, and the datagram."""
        while self._queue and self._queue[0][0] <= now:
            _, _, to, payload = heapq.heappop(self._queue)
            yield to, payload

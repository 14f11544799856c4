"""The simulated datagram network: what is sent arrives late, twice, out of order or not at all."""

from __future__ import annotations

import heapq
import itertools
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

_DRAWS = 1024  # random numbers made at once


@dataclass(frozen=True, eq=False)
class Weather:
    """What faults do to all links for now."""

    loss: float = 0.0  # share of datagrams lost, beside what the links lose
    repeat: float = 0.0  # share of datagrams that arrive twice
    delay: tuple[float, float] | None = None  # shortest and longest [s]; None: the network's own
    blocked: NDArray[np.bool_] | None = None  # (n, n) [sender, receiver]: nothing gets through; None: nowhere


class Datagrams:
    """Datagrams between robots, by index. Equal arguments and calls give equal arrivals."""

    def __init__(
        self, robots: int, rng: np.random.Generator, delay: tuple[float, float] = (0.02, 0.02)
    ) -> None:
        """Link everybody to everybody, without loss; ``delay``: shortest and longest [s]; unequal reorder."""
        self.datagrams_sent = [0] * robots  # by sender, those that get lost included
        self.bytes_sent = [0] * robots
        self.lost = 0  # datagrams of all
        self._rng, self._delay = rng, delay
        self._draws: list[float] = []
        self._queue: list[tuple[float, int, int, int, bytes]] = []  # time, count, sender, receiver, payload
        self._count = itertools.count()
        self._links = np.eye(robots)
        self._peers: dict[int, tuple[int, ...]] = {}  # of the present links, as they were asked for
        self._weather = Weather()
        self._settle()

    def set_links(self, loss: NDArray[np.float64]) -> None:
        """Let ``loss[sender, receiver]``, ``(n, n)``, be the share of datagrams lost; 1: there is no link."""
        if loss.shape != self._links.shape:
            raise ValueError(f"loss must have shape {self._links.shape}; got {loss.shape}")
        self._links = loss.astype(np.float64)
        self._peers.clear()
        self._settle()

    def set_weather(self, weather: Weather) -> None:
        """Let faults be these and no others, from the next datagram on."""
        if weather is not self._weather:
            self._weather = weather
            self._settle()

    def reachable(self, robot: int) -> tuple[int, ...]:
        """Return the robots that one has links to, ascending; faults may keep it from them all the same."""
        if robot not in self._peers:
            linked_to = np.flatnonzero(self._links[robot] < 1.0).tolist()
            self._peers[robot] = tuple(peer for peer in linked_to if peer != robot)
        return self._peers[robot]

    def send(self, sender: int, to: int, payload: bytes, now: float) -> None:
        """Put a datagram under way, or lose it."""
        self.datagrams_sent[sender] += 1
        self.bytes_sent[sender] += len(payload)
        if self._chance() < self._loss[sender, to]:
            self.lost += 1
            return
        low, high = self._weather.delay or self._delay
        for _ in range(1 + (self._chance() < self._weather.repeat)):
            arrival = now + low + (high - low) * self._chance()
            heapq.heappush(self._queue, (arrival, next(self._count), sender, to, payload))

    def next_arrival(self) -> float:
        """Return when the next datagram arrives [s]; inf if none is under way."""
        return self._queue[0][0] if self._queue else float("inf")

    def arrive(self) -> tuple[float, int, int, bytes]:
        """Take the next datagram: time, sender, receiver, payload; of one time, the first sent."""
        time, _, sender, receiver, payload = heapq.heappop(self._queue)
        return time, sender, receiver, payload

    def _settle(self) -> None:
        """Make one table of all that loses datagrams, for ``send`` to look up."""
        loss = 1.0 - (1.0 - self._links) * (1.0 - self._weather.loss)
        if self._weather.blocked is not None:
            loss[self._weather.blocked] = 1.0
        self._loss = loss.data  # its items are plain floats, found faster than an array's

    def _chance(self) -> float:
        if not self._draws:
            self._draws = self._rng.random(_DRAWS).tolist()
        return self._draws.pop()


def linked(robots: int, edges: Iterable[tuple[int, int]]) -> NDArray[np.float64]:
    """Return the ``(n, n)`` loss of lossless two-way links along ``edges``, for `Datagrams.set_links`."""
    loss = np.ones((robots, robots))
    for a, b in edges:
        loss[a, b] = loss[b, a] = 0.0
    return loss

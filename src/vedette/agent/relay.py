"""Beacons on their way through the team: one batch a link, and those of robots far away less often.

Right of way, and telling mates from walls, need the places of robots nearby as fresh as they come. What lies
behind a link may be far from a robot: then one beacon in a while is enough there, so that it does not count
as silent. None waits for others: each hop would make it older. What comes together goes on together.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from math import inf

import numpy as np

from vedette.agent.effects import Send, TrafficKind
from vedette.agent.intents import HORIZON
from vedette.agent.mates import Mate
from vedette.agent.messages import MOST_TOLD, Beacons, encode

AFAR = 1.0  # beacons of robots that nobody behind a link is near go on over it this often [s]
EARLY = 0.15  # so much sooner as well, lest one robot after another waits for the next [s]
LOOK = 1.0  # who is near whom is found out this often [s]
STALE = AFAR + LOOK + 0.5  # so old a place may be when it matters [s]
BODY = 1.0  # a mate's rim, and what is left out around it, are no farther from its centre [m]


def nearby(sight: float, speed: float) -> float:
    """Return how near [m] robots that see so far [m] and are so fast [m/s] need the newest beacons."""
    return max(sight, 2.0 * HORIZON) + BODY + 2.0 * speed * STALE


@dataclass
class Relay:
    """Decides which mates' beacons go on over which links, and when."""

    near: float = inf  # from a robot, within which its beacons go on at once [m]
    _came_by: dict[int, int] = field(default_factory=dict)  # the link that a mate's latest beacon came over
    _afar: dict[int, frozenset[int]] = field(default_factory=dict)  # by link, robots far from all behind it
    _looked: float = -inf  # when that was found out [s]
    _links: tuple[int, ...] = ()  # as of then
    _next: dict[tuple[int, int], float] = field(default_factory=dict)  # by link and robot far away [s]
    _going: defaultdict[int, list[bytes]] = field(default_factory=lambda: defaultdict(list))  # by link

    def hear(
        self, robot: int, told: bytes, sender: int, links: Iterable[int], now: float, *, proves: bool = False
    ) -> None:
        """Take in a mate's beacon, as it came, that is news; it goes on over all other links.

        ``proves``: it is signed; of these there are few, and others are believed by them: all go on.
        """
        self._came_by[robot] = sender
        for link in links:
            if link == sender:
                continue
            if robot in self._afar.get(link, ()):
                if not proves and now < self._next.get((link, robot), -inf) - EARLY:
                    continue
                self._next[link, robot] = now + AFAR
            self._going[link].append(told)

    def pass_on(self) -> list[Send]:
        """Return what has come since the last call, as it goes on."""
        if not self._going:
            return []
        sends = [
            Send(link, TrafficKind.BEACONS, payload)
            for link, told in self._going.items()
            for payload in _payloads(told)
        ]
        self._going.clear()
        return sends

    def look(self, mates: Sequence[Mate], links: tuple[int, ...], now: float) -> None:
        """Find out who is far from all robots behind a link, if it is time for it."""
        if self.near == inf or (now < self._looked + LOOK and links == self._links):
            return
        if links != self._links:
            self._next.clear()
        self._looked, self._links = now, links
        self._afar.clear()
        if not mates:
            return
        robots = np.array([mate.robot for mate in mates])
        places = np.array([(mate.x, mate.y) for mate in mates])
        away = np.hypot(*(places[:, None] - places).transpose(2, 0, 1))
        came_by = np.array([self._came_by.get(mate.robot, -1) for mate in mates])
        for link in links:
            behind = came_by == link
            if behind.any():
                far = away[:, behind].min(axis=1) > self.near
                self._afar[link] = frozenset(robots[far & ~behind].tolist())


def _payloads(told: list[bytes]) -> Iterator[bytes]:
    """Yield beacons as messages: one as it is, many together."""
    for first in range(0, len(told), MOST_TOLD):
        batch = tuple(told[first : first + MOST_TOLD])
        yield encode(Beacons(batch)) if len(batch) > 1 else batch[0]

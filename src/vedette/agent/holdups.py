"""How long mates have been held up, as they say in their beacons and as their places show."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field
from math import hypot

from vedette.agent.rightofway import SLOWED

STILL = 0.3  # who has moved less stands [m]


@dataclass
class _Spans:
    """How long something has been so, by number; what overlaps counts once."""

    _seconds: defaultdict[int, float] = field(default_factory=lambda: defaultdict(float))
    _counted: dict[int, float] = field(default_factory=dict)  # until when [s]

    def add(self, number: int, since: float, now: float) -> None:
        counted = self._counted.setdefault(number, now)
        if since < now:
            self._seconds[number] += now - max(since, counted)
            self._counted[number] = now

    def of(self, number: int) -> float:
        return self._seconds.get(number, 0.0)


@dataclass
class HoldUps:
    """Seconds that robots have been held up, each and behind each link, since they were first heard.

    It is what they say themselves: whoever counts on it does so within bounds.
    """

    _stands: dict[int, tuple[float, float, float]] = field(default_factory=dict)  # x, y [m], since when [s]
    _robots: _Spans = field(default_factory=_Spans)
    _links: _Spans = field(default_factory=_Spans)

    def note(self, robot: int, x: float, y: float, slowed: float, link: int, now: float) -> None:
        """Take in a beacon: where a robot is [m], how long it says to be without progress [s]."""
        left, low, came = self._stands.get(robot, (x, y, now))
        if hypot(x - left, y - low) >= STILL:
            left, low, came = x, y, now
        self._stands[robot] = left, low, came
        since = min(came, now - slowed)
        if now - since < SLOWED:
            since = now
        self._robots.add(robot, since, now)
        self._links.add(link, since, now)

    def of(self, robot: int) -> float:
        """Return how long a robot has been held up, all in all [s]."""
        return self._robots.of(robot)

    def behind(self, link: int) -> float:
        """Return for how long somebody has been whose beacons come over a link [s]."""
        return self._links.of(link)

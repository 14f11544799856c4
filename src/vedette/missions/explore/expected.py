"""When an exploration will have known 90 % of its ground, and ended: what is expected of it as it goes on.

``ln(T / t) = b . (1, ln(1 + F), h, ln(1 + s), ln A, ln n)`` with *t* the time by now, *F* the frontiers, *A*
the known area [m^2], *h* the share of it that was known at half the time, *s* the mean way that a robot has
come [m], and *n* robots; *b* are regressed quantiles: four ends in five lie between the lowest and the
highest.  docs/mapping.md (V150)
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable
from dataclasses import dataclass, field
from math import exp, log, log1p
from typing import Annotated, NamedTuple

from msgspec import Meta

EARLIEST = 6.0  # before that nothing is expected [s]
MOST = 4096  # moments that are remembered
FARTHEST = 1e9  # [s]
Instant = Annotated[float, Meta(ge=0.0, le=FARTHEST)]

Weights = tuple[float, float, float, float, float, float]
KNOWN: tuple[Weights, Weights, Weights] = (  # ``python -m bench.forecast`` fits these
    (2.9203, 0.6704, -3.6480, 0.0504, -0.5731, 0.0945),
    (3.6795, 0.3945, -2.5783, 0.0504, -0.5731, 0.0945),
    (3.2751, 0.5105, -1.2166, 0.0504, -0.5731, 0.0945),
)
ENDED: tuple[Weights, Weights, Weights] = (
    (2.0531, 0.3555, -0.5319, -0.4134, -0.1261, -0.1552),
    (2.6233, 0.3244, -0.7308, -0.4134, -0.1261, -0.1552),
    (3.1230, 0.3626, -0.8145, -0.4134, -0.1261, -0.1552),
)


@dataclass(frozen=True)
class Span:
    """A time since the beginning: four in five lie from ``low`` to ``high``, half before ``middle``."""

    low: Instant  # [s]
    middle: Instant
    high: Instant

    @classmethod
    def of(cls, times: Iterable[float]) -> Span:
        """Put three times in order."""
        return cls(*sorted(min(each, FARTHEST) for each in times))


@dataclass(frozen=True)
class Expected:
    """What is expected of an exploration."""

    known: Span  # when 90 % of the ground is known; it may have been already
    ended: Span  # when the mission ends; not before now


class Progress(NamedTuple):
    """How far an exploration has come, as a team knows it itself."""

    t: float  # since its beginning [s]
    known_m2: float
    frontiers: int | None  # None: there has been no round
    way: float  # that a robot has come, in the mean [m]
    robots: int  # that take part


@dataclass
class Forecaster:
    """Expects by what it has been told up to now; the same always the same."""

    expected: Expected | None = None  # None: it is too early to say
    _times: list[float] = field(default_factory=list)  # [s]
    _areas: list[float] = field(default_factory=list)  # [m^2]

    def add(self, now: Progress) -> Expected | None:
        """Take how far the mission has come, later than before, and return what is expected of it."""
        if not self._times or now.t > self._times[-1]:
            self._times.append(now.t)
            self._areas.append(now.known_m2)
        if len(self._times) > MOST:
            del self._times[1::2], self._areas[1::2]
        self.expected = self._expect(now)
        return self.expected

    def features(self, now: Progress) -> Weights | None:
        """Return what the expectation is a function of; None: it is too early."""
        if now.t < EARLIEST or now.frontiers is None or now.known_m2 <= 0.0 or now.robots < 1:
            return None
        half = bisect_right(self._times, now.t / 2.0) - 1
        before = self._areas[half] if half >= 0 else 0.0
        share = before / now.known_m2
        return (1.0, log1p(now.frontiers), share, log1p(now.way), log(now.known_m2), log(now.robots))

    def _expect(self, now: Progress) -> Expected | None:
        told = self.features(now)
        if told is None:
            return None
        known = (now.t * exp(_dot(weights, told)) for weights in KNOWN)
        ended = (max(now.t * exp(_dot(weights, told)), now.t) for weights in ENDED)
        return Expected(Span.of(known), Span.of(ended))


def _dot(weights: Weights, features: Weights) -> float:
    return sum(weight * each for weight, each in zip(weights, features, strict=True))

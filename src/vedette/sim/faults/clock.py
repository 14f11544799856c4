"""A robot's own clock, which need not show the time."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class SkewedClock:
    """``reading + rate (time - since)``: what a clock shows, from the true time ``since`` on. Units: s."""

    since: float = 0.0
    reading: float = 0.0  # at ``since``
    rate: float = 1.0

    def shows(self, time: float) -> float:
        """Return what the clock shows at a true time."""
        return self.reading + self.rate * (time - self.since)

    def when(self, shown: float) -> float:
        """Return the true time at which the clock shows this."""
        return self.since + (shown - self.reading) / self.rate

    def skewed(self, now: float, s: float, ppm: float) -> SkewedClock:
        """Return the clock set ahead by ``s`` now and ``ppm`` faster than true from now on."""
        return SkewedClock(now, self.shows(now) + s, 1.0 + 1e-6 * ppm)

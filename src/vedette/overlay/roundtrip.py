"""How long to wait for an acknowledgement, from the round trips measured."""

from __future__ import annotations

from dataclasses import dataclass

FIRST, LEAST, MOST = 0.25, 0.05, 0.4  # [s]; MOST but for links with a longer round trip than that


@dataclass
class RoundTrip:
    """Jacobson's estimator (RFC 6298): smoothed round trip + 4 * its mean deviation."""

    smoothed: float | None = None  # [s]
    deviation: float = 0.0  # [s]

    def take(self, sample: float) -> None:
        """Take in the round trip [s] of a message that was sent once."""
        if self.smoothed is None:
            self.smoothed, self.deviation = sample, sample / 2
            return
        self.deviation += (abs(sample - self.smoothed) - self.deviation) / 4
        self.smoothed += (sample - self.smoothed) / 8

    @property
    def reordering(self) -> float:
        """By how much a message may be overtaken without being taken for lost [s]."""
        return 0.01 if self.smoothed is None else self.smoothed / 4

    def timeout(self, tries: int) -> float:
        """Return after how long a message sent so many times is sent again [s]."""
        base = FIRST if self.smoothed is None else max(self.smoothed + 4 * self.deviation, LEAST)
        return float(min(base * 1.5 ** (tries - 1), max(base, MOST)))

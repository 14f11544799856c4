"""A neighbour's clock against ours, from the times that hellos took there and back."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field

SAMPLES = 8


@dataclass
class ClockFilter:
    """NTP's filter: of the latest samples, the one with the shortest round trip (RFC 5905, section 10)."""

    _samples: deque[tuple[float, float]] = field(default_factory=lambda: deque(maxlen=SAMPLES))

    def take(self, sent: float, arrived: float, left: float, back: float) -> None:
        """Take a hello's way: sent and back on our clock [s], arrived and left on theirs."""
        round_trip = (back - sent) - (left - arrived)
        offset = ((arrived - sent) + (left - back)) / 2
        self._samples.append((max(round_trip, 0.0), offset))

    @property
    def offset(self) -> float | None:
        """Return their clock minus ours [s], at most half the round trip off; None: not known yet."""
        return min(self._samples)[1] if self._samples else None

    @property
    def round_trip(self) -> float | None:
        """Return the shortest of the latest round trips [s]."""
        return min(self._samples)[0] if self._samples else None

"""How often a team's rounds begin."""

from __future__ import annotations

from dataclasses import dataclass
from math import floor

from vedette.errors import InputError

_ROUNDING = 1e-9


@dataclass(frozen=True)
class Pace:
    """When the root begins a round: by the end of the last one, or on the beats of its clock.

    Raises:
        InputError: a time is negative or not finite.
    """

    interval: float = 1.0  # least time between a round's end and the next one's beginning [s]
    period: float = 4.0  # a round begins at most so long after the last one's end [s]
    beat: float = 0.0  # rounds begin on its multiples, at most one on each [s]; 0: at any time

    def __post_init__(self) -> None:
        for name in ("interval", "period", "beat"):
            if not 0.0 <= getattr(self, name) < float("inf"):
                raise InputError(f"pace: {name} must be at least 0 s and finite; got {getattr(self, name)}")

    @classmethod
    def each(cls, seconds: float) -> Pace:
        """Return the pace of a team that plans anew on every multiple of so many seconds, if it can."""
        return cls(interval=0.0, period=0.0, beat=seconds)

    @property
    def overdue(self) -> float:
        """A robot that has not seen a round begin for so long calls for one [s]."""
        return 2.0 * max(self.period, self.beat)

    def on_beat(self, last: float, now: float) -> bool:
        """Tell whether a beat came after ``last``, and by now [s]."""
        if self.beat == 0.0:
            return True
        return floor(now / self.beat + _ROUNDING) > floor(last / self.beat + _ROUNDING)

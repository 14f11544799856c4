"""What one robot takes the team's choice to be worth: what is told of it, or what it sees itself."""

from __future__ import annotations

from dataclasses import dataclass

DOUBTS, ROUNDING = 3, 1e-9  # rounds in a row that are told to be worth more, and by what share at least


@dataclass
class Opinion:
    """One robot's, over the rounds that it decided in."""

    _doubted: int = 0  # rounds in a row that were told to be worth more than is seen here

    def of(self, told: float, seen: float | None) -> float:
        """Return the worth: the more, of what is told and what is seen here (None: not all of it).

        A round may stop before its last change has come round; one robot's view that is below what is told
        round after round is right all the same.
        """
        if seen is None:
            return told
        self._doubted = self._doubted + 1 if told > seen + ROUNDING * max(abs(seen), 1.0) else 0
        return seen if self._doubted >= DOUBTS else max(told, seen)

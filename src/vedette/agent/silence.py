"""Who keeps its team waiting, by how long its agent says nothing while a round goes on.

An agent that is not at work says where it is four times a second, whatever its team does meanwhile: so
silence tells who is slow, not who waits for somebody that is.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection
from dataclasses import dataclass, field
from math import inf

LONG = 0.5  # of silence in a round, beside what this robot's own preparation takes [s of the transport]
OFTEN = 3  # rounds in a row in which somebody is silent for long


@dataclass
class Silences:
    """How long each neighbour was silent in one round, from its freezing on."""

    _since: float = inf  # the belief was frozen [s]
    _spoke: dict[int, float] = field(default_factory=dict)  # when each was heard last [s]
    _longest: dict[int, float] = field(default_factory=dict)  # [s]

    def begin(self, now: float) -> None:
        """Note that the belief has been frozen: from now on everybody is at work."""
        self._since = now

    def heard(self, neighbour: int, now: float) -> None:
        """Note that a neighbour's agent has said something, whatever it is."""
        if now >= self._since:
            self._longest[neighbour] = self.longest(neighbour, now)
            self._spoke[neighbour] = now

    def longest(self, neighbour: int, now: float) -> float:
        """Return for how long it was silent at a stretch [s]; 0 before the freezing."""
        return max(self._longest.get(neighbour, 0.0), self._lasts(neighbour, now))

    def _lasts(self, neighbour: int, now: float) -> float:
        return max(now - max(self._spoke.get(neighbour, 0.0), self._since), 0.0)


@dataclass
class Slowness:
    """Which neighbours are silent for long in round after round."""

    _rounds: Counter[int] = field(default_factory=Counter)  # in a row, by neighbour

    def note(self, silences: Silences, neighbours: Collection[int], bears: float, now: float) -> None:
        """Take in a round that has ended; ``bears``: what silence is no wonder [s]."""
        for k in neighbours:
            self._rounds[k] = self._rounds[k] + 1 if silences.longest(k, now) > bears else 0

    @property
    def slow(self) -> frozenset[int]:
        """The neighbours that have been silent for long lately."""
        return frozenset(k for k, rounds in self._rounds.items() if rounds >= OFTEN)

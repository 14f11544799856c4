"""How a mission ends: one word for files, an exit status for programs, a sentence for people."""

from __future__ import annotations

from collections.abc import Iterable
from enum import StrEnum
from math import inf
from typing import Self

NO_PROGRESS = 300.0  # a team without a new route for so long has come to its end [s]
AGREEING = 20.0  # for which robots that are done may hold different maps [s]


class Outcome(StrEnum):
    """Why a mission ended; ``docs/outputs.md`` lists the words."""

    status: int  # that the command exits with
    meaning: str

    def __new__(cls, word: str, status: int, meaning: str) -> Self:
        """Make a member of its word, with all that goes with it."""
        member = str.__new__(cls, word)
        member._value_, member.status, member.meaning = word, status, meaning
        return member

    COMPLETE = "complete", 0, "all that the team could do is done"
    FOUND = "found", 0, "a vehicle declared the target, and it is there"
    MISSED = "missed", 1, "all that can be reached was searched, and nobody was found"
    MISTAKEN = "mistaken", 1, "a vehicle declared the target, and it is elsewhere"
    UNREACHED = "unreached", 1, "work is left that was given up, since nobody could reach it"
    ENCLOSED = "enclosed", 1, "work is left, but nobody who lives can move"
    NO_PROGRESS = "no_progress", 1, f"work is left, but for {NO_PROGRESS:.0f} s nobody got a new route"
    TIME_LIMIT = "time_limit", 1, "--max-time, or the time of the scenario, is over"
    TEAM_LOST = "team_lost", 1, "none of the team is alive"
    MAPS_DIFFER = "maps_differ", 1, "all are done, but they hold different maps"
    UNHEARD = "unheard", 1, "all who are heard are done, but others that run are not heard any more"
    UNJOINED = (
        "unjoined",
        1,
        "all are done whose maps are joined, but work is left on maps that nothing joins",
    )
    SPENT = "spent", 1, "work is left, but all who could do it turned back while they could come home"
    ORDERED = "ordered", 0, "the operator ordered the end"
    INTERRUPTED = "interrupted", 130, "it was interrupted; the files hold what was done until then"

    @classmethod
    def of(cls, word: str) -> Self:
        """Return the outcome of that word, which is one."""
        return next(outcome for outcome in cls if outcome.value == word)

    @property
    def completed(self) -> bool:
        """Whether the team did what it was to do."""
        return self in (Outcome.COMPLETE, Outcome.FOUND)

    @property
    def said(self) -> str:
        """The word as people write it."""
        return self.value.replace("_", " ")


def together(endings: Iterable[str]) -> Outcome:
    """Return how a mission ends for a team of which all who live are done, each with its own ending.

    What one could not get to is left, whatever the others did; who cannot move keeps nobody from it, nor does
    whom the operator has called off, or who has turned back for want of energy.
    """
    said = set(endings)
    if said == {Outcome.ORDERED}:
        return Outcome.ORDERED
    said.discard(Outcome.ORDERED)
    if said == {Outcome.SPENT}:
        return Outcome.SPENT
    said.discard(Outcome.SPENT)
    if said == {Outcome.ENCLOSED}:
        return Outcome.ENCLOSED
    return next((each for each in (Outcome.UNREACHED, Outcome.UNJOINED) if each in said), Outcome.COMPLETE)


class Agreement:
    """Waits, once all who live are done, until they hold one map: they have a while to tell each other."""

    def __init__(self) -> None:
        """Nobody is done yet."""
        self._since = inf  # when all first were [s]

    def off(self) -> None:
        """Note that somebody is not done, or not any more."""
        self._since = inf

    def reached(self, held: Iterable[int], endings: Iterable[str], now: float) -> Outcome | None:
        """Return how it ends for those who are done, by the digests of what they hold; None: not yet."""
        self._since, endings = min(self._since, now), list(endings)
        if set(endings) == {Outcome.ORDERED}:
            return Outcome.ORDERED
        if len(set(held)) <= 1:
            return together(endings)
        return Outcome.MAPS_DIFFER if now > self._since + AGREEING else None

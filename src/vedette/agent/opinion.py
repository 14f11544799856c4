"""What one robot takes the team's choice to be worth: what is told of it, or what it sees itself."""

from __future__ import annotations

from dataclasses import dataclass
from functools import reduce
from math import inf
from typing import Any

from vedette.agent.mission import Framing, Mission
from vedette.agent.participant import RoundParticipant
from vedette.agent.round import Round
from vedette.agent.scrutiny import Scrutiny
from vedette.negotiation import RoundOutcome

DOUBTS, ROUNDING = 3, 1e-9  # rounds in a row that are told to be worth more, and by what share at least
Own = RoundParticipant[Any, Any, Any]


@dataclass
class Opinion:
    """One robot's, over the rounds that it decided in; prices are not taken off."""

    mission: Mission[Any, Any, Any]
    scrutiny: Scrutiny
    _doubted: int = 0  # rounds in a row that were told to be worth more than is seen here

    def of(self, round_: Round, outcome: RoundOutcome, team: Any) -> tuple[float, bool]:
        """Return what the team's choice is worth to who is joined, and whether it is to anybody else.

        ``team``: its impact; None: not all of it is held here. On a map that nothing joins with this robot's,
        who is there can claim what it likes, and nobody else can do anything about it: that keeps nobody at
        work.
        """
        own = round_.participant
        assert own is not None
        value = self._more(_told(outcome, own, team), self._seen(round_, own, team))
        ground = self.mission.ground() if isinstance(self.mission, Framing) else None
        if ground is None:
            return value, False
        if team is None:
            team = reduce(own.combine, round_.claims.values(), own.impact)
        here = own.gross(own.clip(team, ground))
        return here, own.gross(team) > here

    def _seen(self, round_: Round, own: Own, team: Any) -> float | None:
        """Return what this robot sees the team's choice to be worth: nothing, where nobody goes."""
        if team is not None:
            return own.gross(team)
        return 0.0 if self.scrutiny.nobody_goes(round_.belief, own.impact) else None

    def _more(self, told: float, seen: float | None) -> float:
        """Return the more, of what is told and what is seen here (None: not all of it).

        A round may stop before its last change has come round; one robot's view that is below what is told
        round after round is right all the same.
        """
        if seen is None:
            return told
        self._doubted = self._doubted + 1 if told > seen + ROUNDING * max(abs(seen), 1.0) else 0
        return seen if self._doubted >= DOUBTS else max(told, seen)


def _told(outcome: RoundOutcome, own: Own, team: Any) -> float:
    """Return what the team's choice is told to be worth, which is with prices taken off.

    Where not all of the team is held here, no less than what this robot shows itself; and anything where not
    all are content.
    """
    if team is not None:
        return outcome.value
    return max(outcome.value, own.gross(own.impact)) if outcome.converged else inf

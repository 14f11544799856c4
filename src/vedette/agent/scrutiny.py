"""Whom a robot plans without: what its neighbours claim is held against what comes of it.

Where something is wrong, everybody signs what it has claimed (``vedette.agent.audit``).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from vedette.agent.account import Claimed, Stamp
from vedette.agent.audit import Auditor
from vedette.agent.effects import Effect
from vedette.agent.mission import Mission
from vedette.agent.promises import Suspicion
from vedette.agent.round import Round
from vedette.fusion.standing import signed_by

IDLE_ROUNDS = 3  # in a row in which nobody goes, though somebody might, call for an audit


@dataclass
class Scrutiny:
    """What one robot makes of the claims that it hears."""

    mission: Mission[Any, Any, Any]
    anybody_moves: Callable[[], bool] = lambda: True  # of the mates
    suspicion: Suspicion = field(default_factory=Suspicion)  # of neighbours, by what their claims come to
    auditor: Auditor | None = None  # where claims can be signed
    _idle: int = 0  # rounds in a row in which nobody goes

    def distrusted(self, now: float) -> frozenset[int]:
        """Return the robots without which this one plans, for their word is not believed."""
        signed = signed_by(self.mission.fusion)
        if signed is None or self.auditor is None:
            return self.suspicion.nothing(now)
        return signed.out | self.auditor.left_out(now)

    def tick(self, now: float) -> None:
        """Judge the accounts that have been waited for long enough."""
        if self.auditor is not None:
            self.auditor.tick(now)

    def decided(
        self, round_: Round, stamp: Stamp, impact: Any, neighbours: tuple[int, ...], now: float
    ) -> list[Effect]:
        """Find out whose claims come true; where something is wrong, have everybody sign theirs.

        ``impact``: what this robot itself has claimed in the round.
        """
        claims, belief = round_.claims, round_.belief
        halvings = {k: self.suspicion.halvings(k) for k in claims}
        lost = self.suspicion.note(self.mission, belief, claims, now)
        if self.auditor is None:
            return []
        if lost or self._stands_about(belief, impact, claims):
            self.auditor.want(now)
        return self.auditor.decided(
            Claimed(stamp, belief, impact, claims, round_.told, halvings, round_.goes_back), neighbours, now
        )

    def nobody_goes(self, belief: Any, impact: Any) -> bool:
        """Tell whether this robot has nothing to do, by its own impact, and no mate is on its way."""
        return self.mission.objective.gross(belief, impact) <= 0.0 and not self.anybody_moves()

    def _stands_about(self, belief: Any, impact: Any, claims: dict[int, Any]) -> bool:
        """Tell whether nobody goes, round after round, though this robot would if one link said nothing."""
        own, objective = self.mission.strategy, self.mission.objective
        self._idle = self._idle + 1 if self.nobody_goes(belief, impact) else 0
        if self._idle < IDLE_ROUNDS:
            return False
        for silent in claims:
            rest = objective.nothing(belief)
            for k in claims.keys() - {silent}:
                rest = objective.combine(rest, claims[k])
            if self.mission.platform.reply(belief, rest, own) != own:
                return True
        return False

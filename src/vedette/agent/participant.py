"""A robot's mission as a participant of one negotiation round, on a frozen belief."""

from __future__ import annotations

from collections.abc import Hashable
from typing import Generic, cast

from vedette.agent.mission import BeliefT, ImpactT, Mission, StrategyT
from vedette.problem import Clippable, Reach


class RoundParticipant(Generic[BeliefT, StrategyT, ImpactT]):
    """Holds the robot's strategy and impact while a round lasts; ``vedette.negotiation.Participant``."""

    def __init__(self, mission: Mission[BeliefT, StrategyT, ImpactT], belief: BeliefT) -> None:
        self._platform, self._objective = mission.platform, mission.objective
        self._belief = belief
        self._take(mission.strategy)

    @property
    def impact(self) -> ImpactT:
        """Own impact of the present strategy."""
        return self._impact

    @property
    def strategy(self) -> StrategyT:
        """Present strategy."""
        return self._strategy

    def adopt(self, strategy: Hashable) -> None:
        """Take up a strategy that the robot had before in this round."""
        self._take(cast(StrategyT, strategy))

    def reply(self, others: ImpactT) -> bool:
        """Take up the best strategy against the rest of the team, if that is another; tell if so."""
        best = self._platform.reply(self._belief, others, self._strategy)
        if best == self._strategy:
            return False
        self._take(best)
        return True

    def _take(self, strategy: StrategyT) -> None:
        self._strategy = strategy
        self._impact = self._platform.impact(self._belief, strategy)

    def nothing(self) -> ImpactT:
        """Identity of ``*``."""
        return self._objective.nothing(self._belief)

    def combine(self, a: ImpactT, b: ImpactT) -> ImpactT:
        """``a * b``."""
        return self._objective.combine(a, b)

    def value(self, team: ImpactT) -> float:
        """``psi(team)``."""
        return self._objective.value(self._belief, team)

    def price(self, impact: ImpactT) -> float:
        """Return what of an impact's value is a price, taken off."""
        return self._objective.price(impact)

    def gross(self, team: ImpactT) -> float:
        """``psi(team)``, with no price taken off."""
        return self.value(team) + self.price(team)

    def slack(self, base: ImpactT) -> float:
        """Most that any strategy of this robot would add to ``base``."""
        return self._platform.slack(self._belief, base)

    def clip(self, impact: ImpactT, reach: Reach) -> ImpactT:
        """Return what of an impact can matter within ``reach``; all of it if the objective cannot tell."""
        if not isinstance(self._objective, Clippable):
            return impact
        clipped: ImpactT = self._objective.clip(self._belief, impact, reach)
        return clipped

"""A robot's mission as a participant of one negotiation round, on a frozen belief."""

from __future__ import annotations

from collections.abc import Hashable
from typing import Any

from vedette.agent.mission import Mission
from vedette.problem import Reach


class RoundParticipant:
    """Holds the robot's strategy and impact while a round lasts; ``vedette.negotiation.Participant``."""

    def __init__(self, mission: Mission, belief: Any) -> None:
        self._mission = mission
        self._belief = belief
        self._chosen = mission.strategy
        self._had: dict[Hashable, Any] = {mission.key(self._chosen): self._chosen}
        self._impact = mission.impact(belief, self._chosen)

    @property
    def chosen(self) -> Any:
        """The strategy itself."""
        return self._chosen

    @property
    def impact(self) -> Any:
        """Own impact of the present strategy."""
        return self._impact

    @property
    def strategy(self) -> Hashable:
        """A name of the present strategy."""
        return self._mission.key(self._chosen)

    def adopt(self, strategy: Hashable) -> None:
        """Take up a strategy that the robot had before in this round."""
        self._take(self._had[strategy])

    def reply(self, others: Any) -> bool:
        """Take up the best strategy against the rest of the team, if that is another; tell if so."""
        best = self._mission.reply(self._belief, others, self._chosen)
        if self._mission.key(best) == self.strategy:
            return False
        self._take(best)
        return True

    def _take(self, strategy: Any) -> None:
        self._chosen = strategy
        self._had[self._mission.key(strategy)] = strategy
        self._impact = self._mission.impact(self._belief, strategy)

    def nothing(self) -> Any:
        """Identity of ``*``."""
        return self._mission.nothing(self._belief)

    def combine(self, a: Any, b: Any) -> Any:
        """``a * b``."""
        return self._mission.combine(a, b)

    def value(self, team: Any) -> float:
        """``psi(team)``."""
        return self._mission.value(self._belief, team)

    def slack(self, base: Any) -> float:
        """Most that any strategy of this robot would add to ``base``."""
        return self._mission.slack(self._belief, base)

    def clip(self, impact: Any, reach: Reach) -> Any:
        """Return what of an impact can matter within ``reach``."""
        return self._mission.clip(self._belief, impact, reach)

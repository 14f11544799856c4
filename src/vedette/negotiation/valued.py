"""A team's objective on a belief that is held still: what every participant that is given one has alike."""

from __future__ import annotations

from typing import Generic

from vedette.problem.checked import number_of, value_of
from vedette.problem.objective import BeliefT, ImpactT, Objective
from vedette.problem.reach import Clippable, Reach


class Valued(Generic[BeliefT, ImpactT]):
    """``*`` and ``psi`` on one belief."""

    def __init__(self, objective: Objective[BeliefT, ImpactT], belief: BeliefT, base: float) -> None:
        """Take the objective, the belief, and what nothing is worth: values are gains over it."""
        self._objective, self._belief, self._base = objective, belief, base
        self._nothing = objective.nothing(belief)

    def nothing(self) -> ImpactT:
        """Identity of ``*``."""
        return self._nothing

    def combine(self, a: ImpactT, b: ImpactT) -> ImpactT:
        """``a * b``."""
        return self._objective.combine(a, b)

    def value(self, team: ImpactT) -> float:
        """``psi(team)``."""
        return value_of(self._objective, self._belief, team) - self._base

    def price(self, impact: ImpactT) -> float:
        """Return what of an impact's value is a price, taken off."""
        return number_of(self._objective.price(impact), f"{type(self._objective).__name__}.price")

    def clip(self, impact: ImpactT, reach: Reach) -> ImpactT:
        """Return what of an impact can matter within ``reach``; all of it if the objective cannot tell."""
        if not isinstance(self._objective, Clippable):
            return impact
        clipped: ImpactT = self._objective.clip(self._belief, impact, reach)
        return clipped

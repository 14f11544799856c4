"""What a vehicle has to spend, and what is left of it."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf

from vedette.domains.monitoring.scenario import Budget


@dataclass(eq=False)
class Purse:
    """A budget of way, or of energy for way and time."""

    budget: Budget
    gone: float = 0.0  # way so far [m]

    def reach(self, speed: float) -> float:
        """Return the way that it allows for in all, without a rest, at so many m/s [m]."""
        budget = self.budget
        if budget.energy is not None:
            spent = budget.per_metre + budget.per_second / speed
            return budget.energy / spent if spent > 0.0 else inf
        return inf if budget.path is None else budget.path

    def awake(self, now: float) -> float:
        """Return how long a vehicle that stays where it is can measure yet [s]."""
        budget, left = self.budget, self._energy(now)
        if left <= 0.0:
            return 0.0
        return left / budget.per_second if budget.per_second > 0.0 else inf

    def left(self, now: float, horizon: float) -> float:
        """Return the way that it may go within a horizon from now on [m], measuring as long as it can."""
        budget, left = self.budget, self._energy(now)
        if budget.energy is None:
            return inf if budget.path is None else max(0.0, budget.path - self.gone)
        if budget.per_metre == 0.0:
            return inf if left > 0.0 else 0.0
        return max(0.0, left - budget.per_second * min(self.awake(now), horizon)) / budget.per_metre

    def _energy(self, now: float) -> float:
        """Return what is left of the energy [J]; without any to spend, no end of it."""
        budget = self.budget
        if budget.energy is None:
            return inf
        return budget.energy - budget.per_metre * self.gone - budget.per_second * now

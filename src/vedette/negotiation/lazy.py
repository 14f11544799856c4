"""Values of a platform's candidates, worked out only where they can matter."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Generic

import numpy as np
from numpy.typing import NDArray

from vedette.problem.checked import value_of, values_of
from vedette.problem.objective import BeliefT, ImpactT, Objective

FIRST = 4  # candidates asked for at once at first; then twice as many as before
ROUNDING = 1e-9  # of values, by which sums of the same may differ

Values = NDArray[np.float64]


class Base(Generic[ImpactT]):
    """What candidates are added to: ``psi(base * own_k)`` where it is worked out, and bounds for the rest."""

    def __init__(self, impact: ImpactT, worth: float, bounds: Values) -> None:
        """Know bounds (K,) of what each candidate adds; infinite where nothing is known."""
        self.impact, self.worth = impact, worth
        self.larger: list[ImpactT] = []  # what it was combined into
        self.values = np.full(len(bounds), -math.inf)  # (K,) of base and candidate, where known
        self.best = -math.inf  # of them
        self._bounds, self._known = bounds, np.zeros(len(bounds), np.bool_)

    @property
    def bounds(self) -> Values:
        """The most that each candidate (K,) adds to this base, or to one with more in it."""
        return np.where(self._known, self.values - self.worth, self._bounds)

    def learn(self, which: Sequence[int] | NDArray[np.intp], values: Values) -> None:
        """Take in the values of some candidates."""
        self.values[which], self._known[which] = values, True
        self.best = max(self.best, float(values.max()))

    def unknown(self) -> NDArray[np.intp]:
        """Return the candidates that are not worked out, those with the highest bounds first."""
        order = np.argsort(-self._bounds, kind="stable")
        return order[~self._known[order]]

    def may_be_best(self, k: int) -> bool:
        """Tell whether a candidate can be as good as the best known, sums being rounded."""
        slip = ROUNDING * (abs(self.worth) + abs(self.best)) if self.best > -math.inf else 0.0
        return bool(self.worth + self._bounds[k] + slip >= self.best)


class LazyValues(Generic[BeliefT, ImpactT]):
    """The best of a platform's candidates over one base after another, by few evaluations.

    Returns diminish: what a candidate adds to a base is no more than what it adds to nothing, or to any part
    of that base. Once no bound is above the best value known, the best of all is found: to the bit, and the
    lowest of equal ones. An objective that promises nothing is asked for all.
    Source: docs/theory.md, section 3.
    """

    def __init__(
        self,
        objective: Objective[BeliefT, ImpactT],
        belief: BeliefT,
        own: Sequence[ImpactT],
        nothing: ImpactT,
    ) -> None:
        """Know nothing yet; ``nothing`` is the object that bases without anybody are."""
        self._objective, self._belief, self._own, self._nothing = objective, belief, own, nothing
        self._lazy = objective.monotone and objective.submodular
        self._alone = np.full(len(own), math.inf)  # (K,) what each adds to nothing, at most
        self._last: Base[ImpactT] | None = None

    def combined(self, a: ImpactT, result: ImpactT) -> None:
        """Hear what ``a`` was combined into."""
        if self._last is not None and a is self._last.impact:
            self._last.larger.append(result)

    def best(self, base: ImpactT, present: int | None) -> tuple[int, Values]:
        """Return the best candidate with a base, and values (K,), of it and the present one at least."""
        over = self._last
        if over is None or base is not over.impact:
            over = self._last = self._over(base, self._alone)
        if present is not None:
            self._ask(over, [present])
        self._settle(over)
        return int(np.argmax(over.values)), over.values

    def most(self, base: ImpactT) -> float:
        """Return the most that any candidate adds to a base."""
        if base is self._nothing:
            over = self._last = self._over(base, self._alone)
            self._ask(over, range(len(self._own)))
            self._alone = over.bounds
        else:
            over = self._over(base, self._bounds_of_a_part(base))
            self._settle(over)
        return over.best - over.worth

    def _bounds_of_a_part(self, base: ImpactT) -> Values:
        if self._last is not None and any(base is larger for larger in self._last.larger):
            return self._last.bounds
        return self._alone

    def _over(self, base: ImpactT, bounds: Values) -> Base[ImpactT]:
        return Base(base, value_of(self._objective, self._belief, base), bounds)

    def _settle(self, over: Base[ImpactT]) -> None:
        """Work out values until nobody left can be the best."""
        left, count = over.unknown().tolist(), FIRST if self._lazy else len(self._own)
        while left and over.may_be_best(left[0]):
            now = [k for k in left[:count] if over.may_be_best(k)]
            self._ask(over, sorted(now))
            left, count = left[len(now) :], 2 * count

    def _ask(self, over: Base[ImpactT], which: Sequence[int]) -> None:
        own = [self._own[k] for k in which]
        over.learn(which, values_of(self._objective, self._belief, over.impact, own))

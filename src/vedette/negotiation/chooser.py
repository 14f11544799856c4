"""A platform that chooses from a list of candidate impacts."""

from __future__ import annotations

import math
from collections.abc import Hashable, Sequence

from vedette.negotiation.lazy import LazyValues
from vedette.negotiation.valued import Valued
from vedette.problem.bound import attains
from vedette.problem.objective import BeliefT, ImpactT, Objective


class Chooser(Valued[BeliefT, ImpactT]):
    """``v_i = argmax_k psi(own_k * a_{-i})``, kept unless another is better by more than the share epsilon.

    A strategy is an index; without one the impact is nothing, and the first reply takes the best candidate
    even at no gain. Equal candidates: the lowest index. Source: docs/theory.md (V9).
    """

    def __init__(
        self,
        objective: Objective[BeliefT, ImpactT],
        belief: BeliefT,
        candidates: Sequence[ImpactT],
        *,
        start: int | None = None,
        epsilon: float = 1e-9,
        base: float = 0.0,
    ) -> None:
        """Sit down with at least one candidate.

        Args:
            objective: the team's ``*`` and ``psi``.
            belief: what the value depends on.
            candidates: own impacts.
            start: index of the first candidate; without it none.
            epsilon: a share of the team's present value.
            base: ``psi`` of nothing, if that is not 0; values are gains over it.
        """
        super().__init__(objective, belief, base)
        self.index = start
        self._candidates = candidates
        self._epsilon = epsilon
        self._values = LazyValues(objective, belief, candidates, self.nothing())

    @property
    def strategy(self) -> int | None:
        """Index of the present candidate, ``None`` while there is none."""
        return self.index

    @property
    def impact(self) -> ImpactT:
        """Impact of the present candidate."""
        return self.nothing() if self.index is None else self._candidates[self.index]

    def adopt(self, strategy: Hashable) -> None:
        """Take up a strategy that this platform had before."""
        assert strategy is None or isinstance(strategy, int)
        self.index = strategy

    def reply(self, others: ImpactT) -> bool:
        """Take up the best candidate against the rest of the team if it is strictly better; tell if so."""
        best, values = self._values.best(others, self.index)
        values = values - self._base
        if self.index is not None and attains(values[self.index], values[best], self._epsilon):
            return False
        self.index = best
        return True

    def combine(self, a: ImpactT, b: ImpactT) -> ImpactT:
        """``a * b``."""
        result = super().combine(a, b)
        self._values.combined(a, result)
        return result

    def slack(self, base: ImpactT) -> float:
        """Most that any candidate would add to ``base``; infinite unless monotone and submodular."""
        if not (self._objective.monotone and self._objective.submodular):
            return math.inf
        return max(self._values.most(base), 0.0)  # below 0 only by rounding

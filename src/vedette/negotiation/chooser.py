"""A platform that chooses from a list of candidate impacts."""

from __future__ import annotations

from collections.abc import Hashable, Sequence

import numpy as np

from vedette.negotiation.valued import Valued
from vedette.problem.bound import attains, slack_of
from vedette.problem.checked import values_of
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
        values = values_of(self._objective, self._belief, others, self._candidates) - self._base
        best = int(np.argmax(values))
        if self.index is not None and attains(values[self.index], values[best], self._epsilon):
            return False
        self.index = best
        return True

    def slack(self, base: ImpactT) -> float:
        """Most that any candidate would add to ``base``; infinite unless monotone and submodular."""
        return slack_of(self._objective, self._belief, base, self._candidates)

"""The potential of non-oblivious local search: what a team is worth of which some are missing."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from vedette.errors import InputError, brief
from vedette.number import is_whole
from vedette.problem.objective import BeliefT, ImpactT, Objective
from vedette.problem.reach import Clippable, Reach

Float = NDArray[np.float64]


@runtime_checkable
class Thinnable(Protocol[ImpactT]):
    """An objective in which a platform that is there only perhaps has an impact of its own."""

    def thin(self, impact: ImpactT, chance: float) -> ImpactT:
        """Return the impact for which ``psi`` is the mean over whether the platform is there."""


class Thinned(Objective[BeliefT, tuple[ImpactT, ...]]):
    """``Phi(a) = sum_j c_j psi(a^j)``: the mean value of a team each of whom is there with chance ``j / K``.

    ``c_j = (K / j) (1 + 1/K)^j``, and ``*`` goes copy by copy; the last copy is the team as it is. At an
    equilibrium of Phi the team is worth at least ``1 - (K / (K + 1))^K`` of the optimum: 1/2 for one copy,
    0.578 for three, towards 1 - 1/e; at one of psi, 1/2. Messages are K times as long.
    Source: Filmus and Ward, SIAM J. Comput. 43 (2014), for functions of sets; docs/theory.md (V162), (V163).
    """

    def __init__(self, objective: Objective[BeliefT, ImpactT], copies: int) -> None:
        """Take the team's objective, and how many chances are looked at.

        Raises:
            InputError: no whole number of at least one copy, or an objective that is not monotone and
                submodular, or cannot thin its impacts.
        """
        if not is_whole(copies) or copies < 1:
            raise InputError(f"copies must be a whole number >= 1; got {brief(copies)}")
        name = type(objective).__name__
        if not isinstance(objective, Thinnable):
            raise InputError(f"Thinned needs {name}.thin(impact, chance)")
        if not (objective.monotone and objective.submodular):
            raise InputError(f"Thinned promises something for monotone, submodular objectives; {name} is not")
        self.monotone = self.submodular = True
        self._one, self._thin = objective, objective.thin
        self._chances = np.arange(1, int(copies) + 1) / copies
        self._weights = (1.0 + 1.0 / copies) ** np.arange(1, int(copies) + 1) / self._chances

    @property
    def guarantee(self) -> float:
        """Share of the optimum that an equilibrium is worth at least."""
        copies = len(self._chances)
        return 1.0 - (copies / (copies + 1.0)) ** copies

    def copies(self, impact: ImpactT) -> tuple[ImpactT, ...]:
        """Return a platform's impact as this objective takes it."""
        return (*(self._thin(impact, float(chance)) for chance in self._chances[:-1]), impact)

    def nothing(self, belief: BeliefT) -> tuple[ImpactT, ...]:
        """Return nothing in every copy."""
        return (self._one.nothing(belief),) * len(self._chances)

    def combine(self, a: tuple[ImpactT, ...], b: tuple[ImpactT, ...]) -> tuple[ImpactT, ...]:
        """``a^j * b^j`` for every j."""
        return tuple(self._one.combine(*pair) for pair in zip(a, b, strict=True))

    def value(self, belief: BeliefT, impact: tuple[ImpactT, ...]) -> float:
        """Return the potential."""
        return float(self._weights @ [self._one.value(belief, each) for each in impact])

    def price(self, impact: tuple[ImpactT, ...]) -> float:
        """Return what of the potential is a price."""
        return float(self._weights @ [self._one.price(each) for each in impact])

    def values(
        self, belief: BeliefT, others: tuple[ImpactT, ...], own: Sequence[tuple[ImpactT, ...]]
    ) -> Float:
        """Return the potential of others and each candidate."""
        drawn = zip(others, *own, strict=True)
        return np.asarray(
            self._weights @ np.array([self._one.values(belief, rest, each) for rest, *each in drawn])
        )

    def clip(self, belief: BeliefT, impact: tuple[ImpactT, ...], reach: Reach) -> tuple[ImpactT, ...]:
        """Return what can matter within a reach, copy by copy; (V14)."""
        if not isinstance(self._one, Clippable):
            return impact
        return tuple(self._one.clip(belief, each, reach) for each in impact)

    def wrong_belief(self, belief: BeliefT) -> str | None:
        """As the objective beneath."""
        return self._one.wrong_belief(belief)

    def wrong_impact(self, belief: BeliefT, own: Sequence[tuple[ImpactT, ...]]) -> tuple[int, str] | None:
        """An impact is a tuple of as many as there are copies."""
        count = len(self._chances)
        for k, each in enumerate(own):
            if not isinstance(each, tuple) or len(each) != count:
                return k, f"an impact must be a tuple of {count} copies; got {brief(each)}"
            if (wrong := self._one.wrong_impact(belief, each)) is not None:
                return k, f"copy {wrong[0] + 1}: {wrong[1]}"
        return None

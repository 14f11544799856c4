"""What a node holds of a child's part of the tree where changes are offered, and taken or refused."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import Generic

from vedette.negotiation.messages import Joined, Offer
from vedette.negotiation.node import Participant
from vedette.problem.bound import attains
from vedette.problem.objective import ImpactT

_ROUNDING = 1e-12  # of a value, as a share


@dataclass(frozen=True, eq=False)
class Branch(Generic[ImpactT]):
    """A part of the tree, as it is."""

    mu: ImpactT
    size: int
    ceiling: float
    value: float  # by itself
    shown: float  # psi(mu): what of that its mu shows

    @classmethod
    def of(
        cls, own: Participant[ImpactT], mu: ImpactT, size: int, ceiling: float, value: float
    ) -> Branch[ImpactT]:
        """Return a part that says so much of itself."""
        return cls(mu, size, ceiling, value, own.value(mu))

    def after(self, own: Participant[ImpactT], joined: Joined[ImpactT] | Offer[ImpactT]) -> Branch[ImpactT]:
        """Return the part as it says that it would be."""
        if joined.mu is None:
            return Branch(self.mu, joined.size, joined.ceiling, joined.value, self.shown)
        return Branch.of(own, joined.mu, joined.size, joined.ceiling, joined.value)

    def worth_with(self, rest: ImpactT, own: Participant[ImpactT]) -> float:
        """``V + psi(rest * mu) - psi(mu)``: the team's value but for what all the rest are by themselves.

        So values add up although messages leave out what interacts with nobody here; docs/theory.md (V15).
        """
        return self.value + own.value(own.combine(rest, self.mu)) - self.shown

    def is_raised_by(self, new: Branch[ImpactT], rest: ImpactT, own: Participant[ImpactT]) -> bool:
        """Whether the team is worth no less with the new part in the place of this one."""
        now, then = self.worth_with(rest, own), new.worth_with(rest, own)
        return attains(then, now, _ROUNDING)


def value_alone(own: Participant[ImpactT], together: ImpactT, branches: Collection[Branch[ImpactT]]) -> float:
    """Return what a platform and the branches below it are worth, all impacts combined; docs/theory.md (V15).

    Without a strategy it is worth nothing alone.
    """
    if own.strategy is None and not branches:
        return 0.0
    return own.value(together) + sum(branch.value - branch.shown for branch in branches)

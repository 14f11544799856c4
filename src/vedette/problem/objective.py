"""The team's objective and what a platform adds to it: the method's four roles."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Generic, Protocol, TypeVar, runtime_checkable

import numpy as np
from numpy.typing import NDArray

BeliefT = TypeVar("BeliefT")
BeliefT_contra = TypeVar("BeliefT_contra", contravariant=True)
StrategyT = TypeVar("StrategyT")
ImpactT = TypeVar("ImpactT")


class Objective(ABC, Generic[BeliefT, ImpactT]):
    """``J(v) = psi(Y_1(v_1) * ... * Y_n(v_n))``: the team's ``*`` (combine) and ``psi`` (value).

    A subclass states three laws-abiding functions; ``vedette.testing.check_objective`` checks the laws.
    Impacts are values: no function may change its arguments. The flags declare what ``gross``, the value
    with prices not taken off, promises for any impacts a platform may have; with both, a negotiation reports
    a bound on the optimum. Source: paper, eq. (15); docs/theory.md (V1), (V190).
    """

    monotone: bool = False  # gross(a * x) >= gross(a)
    submodular: bool = False  # gross(a * x) - gross(a) >= gross(a * b * x) - gross(a * b)

    @abstractmethod
    def nothing(self, belief: BeliefT) -> ImpactT:
        """Return the identity of ``*``: the impact of a platform that observes nothing."""

    @abstractmethod
    def combine(self, a: ImpactT, b: ImpactT) -> ImpactT:
        """Return ``a * b``: what two platforms achieve in sum; commutative and associative."""

    @abstractmethod
    def value(self, belief: BeliefT, impact: ImpactT) -> float:
        """Return ``psi(impact)``, the gain over doing nothing: ``value(belief, nothing(belief)) == 0``."""

    def price(self, impact: ImpactT) -> float:
        """Return what of ``value`` is a price, taken off: ``price(a * b) = price(a) + price(b) >= 0``."""
        return 0.0

    def gross(self, belief: BeliefT, impact: ImpactT) -> float:
        """Return what an impact is worth with its price not taken off."""
        return self.value(belief, impact) + self.price(impact)

    def values(self, belief: BeliefT, others: ImpactT, own: Sequence[ImpactT]) -> NDArray[np.float64]:
        """Return ``value(others * own[k])`` for every k, shape (K,); override where one pass can do all."""
        return np.array([self.value(belief, self.combine(others, k)) for k in own], dtype=np.float64)

    def wrong_belief(self, belief: BeliefT) -> str | None:
        """Return what is wrong with a belief that ``value`` is not made for; asked once a negotiation."""
        return None

    def wrong_impact(self, belief: BeliefT, own: Sequence[ImpactT]) -> tuple[int, str] | None:
        """Return the first k for which ``own[k]`` is no impact, and why; asked once for each platform."""
        return None


@runtime_checkable
class Invertible(Protocol[ImpactT]):
    """An objective whose ``*`` has a group inverse; only the paper's own sweep needs it."""

    def remove(self, total: ImpactT, own: ImpactT) -> ImpactT:
        """Return ``total * own^-1``, so that ``remove(combine(a, b), b) == a`` (paper, eq. (31))."""


class Platform(Protocol[BeliefT_contra, StrategyT, ImpactT]):
    """One platform's own ``Y_i`` and what it can do; nobody else needs to know it."""

    def prepare(self, belief: BeliefT_contra) -> None:
        """Do the slow part before a round: list the strategies and what each would observe."""

    def impact(self, belief: BeliefT_contra, strategy: StrategyT) -> ImpactT:
        """Return ``Y_i(strategy)`` (paper, eq. (13))."""

    def reply(self, belief: BeliefT_contra, others: ImpactT, current: StrategyT) -> StrategyT:
        """Return the best strategy against the rest of the team, ``current`` if none is better; fast."""


class Codec(Protocol[ImpactT]):
    """How impacts travel on a network."""

    def encode(self, impact: ImpactT) -> bytes:
        """Return the impact as bytes."""

    def decode(self, data: bytes) -> ImpactT:
        """Return the impact that ``encode`` was given; ``ValueError`` if malformed or out of range."""

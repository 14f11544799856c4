"""What a platform holds of its children's offers, and of its own while the parent has not answered."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Generic

from vedette.negotiation.branch import Branch
from vedette.negotiation.messages import Offer
from vedette.problem.objective import ImpactT


@dataclass(eq=False)
class Child(Generic[ImpactT]):
    """A child, as it counts and as it talks."""

    branch: Branch[ImpactT] | None = None  # None: it has not been heard of
    offer: Offer[ImpactT] | None = None  # that has been neither passed on nor refused
    offers: int = 0  # that it has made
    answered: int = 0  # serial of its last offer that was taken or refused
    taken: bool = True
    told: int = 0  # serial of the last news to it
    heard: int = 0  # of those that it has answered
    due: bool = False  # there are news for it
    urgent: bool = False  # with an answer to its offer
    quiet: bool = False  # its whole part is content with the last news
    slack: float = math.inf
    changes: int = 0
    capped: bool = False

    def answer(self, serial: int, *, taken: bool) -> None:
        """Note what is to be told of its offer."""
        self.answered, self.taken = serial, taken
        self.due, self.urgent, self.quiet = True, True, False


@dataclass(eq=False)
class Pending(Generic[ImpactT]):
    """Changes that are offered together."""

    own: bool  # own strategy is one
    fact: bool = False  # they are so already
    offers: dict[int, Offer[ImpactT]] = field(default_factory=dict)  # of children
    branches: dict[int, Branch[ImpactT]] = field(default_factory=dict)  # what all children would be
    gone: frozenset[int] = frozenset()  # children without which that is

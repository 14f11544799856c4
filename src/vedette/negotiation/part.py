"""What a child's part of the tree adds to the token's tally, so that it can be taken off again."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Generic

from vedette.negotiation.messages import Tally
from vedette.negotiation.node import Participant
from vedette.problem.objective import ImpactT


@dataclass(eq=False)
class Part(Generic[ImpactT]):
    """A child's part of the tree, as it gathered and as it changed while it had the token."""

    size: int
    ceiling: float
    value: float  # when it gathered, by itself
    told: ImpactT  # the rest of the team, as it was last told
    changes: list[tuple[float, ImpactT, ImpactT, ImpactT]] = field(default_factory=list)
    """Gain by what the part did, the rest of the team then, and the part's mu before and after."""

    def note(self, handed: Tally, back: Tally, before: ImpactT, after: ImpactT | None) -> None:
        """Note what the part became while it had the token: platforms may have been cut from it."""
        self.size -= handed.size - back.size
        self.ceiling = less(back.ceiling, less(handed.ceiling, self.ceiling))
        if after is not None:
            self.changes.append((back.value - handed.value, self.told, before, after))

    def taken_off(self, tally: Tally, own: Participant[ImpactT], shown: float) -> Tally:
        """Return the tally of all the others, who are then asked anew.

        ``shown``: what the part's mu adds to the value of the team, as far as messages show it here.
        """
        return Tally(
            turns=0,
            quiet=0,
            value=tally.value - self._hidden(own) - shown,
            slack=0.0,
            size=tally.size - self.size,
            ceiling=less(tally.ceiling, self.ceiling),
        )

    def _hidden(self, own: Participant[ImpactT]) -> float:
        """``sum of gain - [psi(rest * after) - psi(rest * before)]``: the part's value that its mu hides.

        Clipped messages leave out what interacts with nobody here; if none are, this is 0 but for rounding.
        docs/theory.md (V15)
        """
        return sum(
            gain - (own.value(own.combine(rest, after)) - own.value(own.combine(rest, before)))
            for gain, rest, before, after in self.changes
        )


def less(total: float, part: float) -> float:
    """``total - part``; infinite where the part is, for what is left of the total is not known then."""
    return total - part if math.isfinite(part) else math.inf

"""One after the other, each knowing what those before it chose: one pass, from nothing."""

from __future__ import annotations

from dataclasses import dataclass, field

from vedette.domains.mapping.belief import MapBelief
from vedette.domains.mapping.impact import Impact
from vedette.domains.mapping.platform import MappingPlatform
from vedette.domains.mapping.tour import STAY, Tour


@dataclass(eq=False)
class GreedyPlatform(MappingPlatform):
    """Replies once a round, to those before it in the token's order (Fisher, Nemhauser & Wolsey 1978).

    Nobody holds a strategy when the round begins, so what a robot replies to is what those before it chose.
    """

    _present: Tour = field(init=False, default=STAY)  # over this round's stops
    _replied: bool = field(init=False, default=False)

    def carry_over(self, strategy: Tour) -> Tour:
        """Begin from nothing, but remember the present tour, for hysteresis; a lost round keeps it."""
        lost = not self._replied and not len(strategy)
        self._present = super().carry_over(self._present if lost else strategy)
        self._replied = False
        return STAY

    def reply(self, belief: MapBelief, others: Impact, current: Tour) -> Tour:
        """Return the best tour against those before, the present one unless it is clearly better; once."""
        if self._replied:
            return current
        self._replied = True
        return super().reply(belief, others, self._present)

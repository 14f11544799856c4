"""What missions of vehicles have in common, and the classic team that shares beliefs but no plans."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Generic

from vedette.agent.messages import Note
from vedette.agent.mission import BeliefT, ImpactT, RoundPlatform, StrategyT
from vedette.problem import Objective, Reach


class FlyingMission:
    """Tells nothing beside the evidence, and has no end of its own: the world says when it is over."""

    def notes(self) -> list[Note]:
        """Tell nothing beside the evidence."""
        return []

    def hear_notes(self, notes: Sequence[Note]) -> None:
        """Hear nothing beside the evidence."""

    def nothing_left(self, value: float, now: float) -> bool:
        """There is always something to gain: targets move on, and a search ends when somebody declares."""
        return False


@dataclass(frozen=True, eq=False)
class SharedBelief(Generic[BeliefT, StrategyT, ImpactT]):
    """A platform that tells what it has seen, but nothing of what it will do: the classic "coordinated" team.

    Everybody plans alone on the common belief. So an impact is nothing, to others and to the team's value.
    """

    platform: RoundPlatform[BeliefT, StrategyT, ImpactT]
    objective: Objective[BeliefT, ImpactT]

    def impact(self, belief: BeliefT, strategy: StrategyT) -> ImpactT:
        """Tell nothing."""
        return self.objective.nothing(belief)

    def reply(self, belief: BeliefT, others: ImpactT, current: StrategyT) -> StrategyT:
        """Return the best strategy as if nobody else were there."""
        return self.platform.reply(belief, self.objective.nothing(belief), current)

    def slack(self, belief: BeliefT, base: ImpactT) -> float:
        """Promise nothing of what the team could gain."""
        return math.inf


_SWEEPS = 3  # of the token that a round mostly takes, at most
_MARGIN = 0.1  # [s]


@dataclass(frozen=True)
class RoundTimes:
    """What a team's rounds take, as far as it is known beforehand."""

    link_delay: float  # one way [s]
    preparing: float  # a robot's, between freezing and negotiating [s]

    def lead(self, vehicles: int) -> float:
        """Return how long a round takes from freezing to its end, on a balanced tree [s].

        Freeze, Gather and Stop each go from end to end of the tree, and the token round it in every sweep.
        """
        depth = math.ceil(math.log2(vehicles + 1)) - 1
        hops = 3 * depth + 2 * (vehicles - 1) * _SWEEPS
        return self.preparing + _MARGIN + self.link_delay * hops


def box_around(x: float, y: float, most: float) -> Reach:
    """Return the square of all places that are at most so far away in x and in y [m]."""
    return ((x - most, y - most, x + most, y + most),)

"""What missions of vehicles have in common, and the classic team that shares beliefs but no plans."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Generic

import numpy as np
from numpy.typing import NDArray

from vedette.agent.messages import Note
from vedette.agent.mission import BeliefT, ImpactT, Place, RoundPlatform, StrategyT
from vedette.agent.orders import OrderBook
from vedette.forbidden import NOWHERE, Forbidden
from vedette.maps.area import Area
from vedette.missions.ordered import no_go_areas, priority_areas
from vedette.problem import Objective, Reach


@dataclass(frozen=True, eq=False)
class Held(Generic[BeliefT, StrategyT, ImpactT]):
    """A platform that does nothing, whatever the others do: orders keep it from work."""

    objective: Objective[BeliefT, ImpactT]

    def impact(self, belief: BeliefT, strategy: StrategyT) -> ImpactT:
        """Promise nothing."""
        return self.objective.nothing(belief)

    def reply(self, belief: BeliefT, others: ImpactT, current: StrategyT) -> StrategyT:
        """Go on."""
        return current

    def slack(self, belief: BeliefT, base: ImpactT) -> float:
        """Nothing can be gained."""
        return 0.0


class FlyingMission(ABC, Generic[BeliefT, StrategyT, ImpactT]):
    """Tells nothing beside the evidence, and has no end of its own: the world says when it is over.

    It heeds orders: no-go areas bind its plans, and priorities what they are worth.
    """

    working: RoundPlatform[BeliefT, StrategyT, ImpactT]  # what it plans with
    held = False  # orders keep it from work, as of the last round
    forbidden = NOWHERE  # where nobody may be
    priorities: Sequence[tuple[Area, float]] = ()  # areas, and how many times as much all in them is worth

    @property
    @abstractmethod
    def objective(self) -> Objective[BeliefT, ImpactT]:
        """What the team gains."""

    @property
    def platform(self) -> RoundPlatform[BeliefT, StrategyT, ImpactT]:
        """What it plans with, if nothing keeps it from work."""
        return Held(self.objective) if self.held else self.working

    def heed(self, book: OrderBook) -> None:
        """Plan by these orders from now on."""
        self.forbidden = Forbidden(no_go_areas(book))
        self.priorities = priority_areas(book)

    def route(self, here: Place, there: Place, room: float) -> list[Place]:
        """Return the corners of a way from place to place [m]; none: there is no way."""
        corners = self.forbidden.round(np.array(here), np.array(there), room)
        return [(float(x), float(y)) for x, y in corners]

    def passes(self, places: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Tell at which places ``(..., 2)`` [m] its vehicle can be."""
        return np.ones(places.shape[:-1], np.bool_)

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

    def lead(self, vehicles: int, scheme: str) -> float:
        """Return how long a round takes from freezing to its end, on a balanced tree [s].

        Freeze, Gather and Stop each go from end to end of the tree, and the token round it in every sweep;
        ``multistart`` does all of that but Freeze twice. Other schemes are no slower than the token.
        """
        depth = math.ceil(math.log2(vehicles + 1)) - 1
        rounds = 2 if scheme == "multistart" else 1
        hops = depth + rounds * (2 * depth + 2 * (vehicles - 1) * _SWEEPS)
        return self.preparing + _MARGIN + self.link_delay * hops


def box_around(x: float, y: float, most: float) -> Reach:
    """Return the square of all places that are at most so far away in x and in y [m]."""
    return ((x - most, y - most, x + most, y + most),)

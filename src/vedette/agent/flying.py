"""What a vehicle does with its strategy: it flies it, and circles when it has none, or stands if it may.

Vehicles keep altitudes of their own, so that nobody makes room for anybody, and none gets stuck. Orders go
before strategies; no-go areas before both.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vedette.agent.effects import Effect, Fly
from vedette.agent.events import Arrived, Pose, Scan, Sensed, Stuck
from vedette.agent.flight import AnyPlan, Itinerary
from vedette.agent.getting import Getting
from vedette.agent.mission import FlightMission, Place
from vedette.agent.orders import Given, LookThere, Pause, Recall
from vedette.agent.state import Agent, State
from vedette.forbidden import NOWHERE, Forbidden
from vedette.outcome import Outcome

ON_THE_WAY = (State.RETURNING, State.LOOKING)  # to a place that the operator wants it at
MOST_TRIES = 5  # then it stays where it is


@dataclass
class FlightBehaviour:
    """Flies the turn rates or velocities of the latest decision; ``vedette.agent.state.Behaviour``.

    A plan holds from its start until the next decision's: rounds that fail cost nothing as long as it lasts.
    When it has run out, and before the first one, the vehicle circles at its greatest turn rate, or stands.
    """

    mission: FlightMission[Any, Any, Any]
    speed: float  # [m/s]
    turn_rate: float | None  # greatest [rad/s]; None: it turns at once, and may stand
    state: State = State.WAITING
    flight: Itinerary = field(init=False)
    home: Place | None = None  # where it started
    obeyed: Given | None = None  # the order that keeps it from work
    called: Place | None = None  # where that wants it
    tries: int = 0  # to get there
    minded: Forbidden = NOWHERE  # the no-go areas that its flight keeps out of

    def __post_init__(self) -> None:
        self.flight = Itinerary(self.turn_rate)
        self._getting = Getting(self.speed, self.turn_rate)

    @property
    def ending(self) -> Outcome:
        """A vehicle leaves nothing that it could have done, unless the operator has called it off."""
        return Outcome.COMPLETE if self.obeyed is None else Outcome.ORDERED

    def wake(self, agent: Agent, pose: Pose, now: float) -> bool:
        """Take part in rounds from the first pose on."""
        self.home = self.home or (pose.x, pose.y)
        return True

    def sense(self, agent: Agent, seen: Scan | Sensed, now: float) -> None:
        """Hand on what the vehicle sees."""
        if agent.pose is not None:
            self.mission.observe(seen, agent.pose, agent.mates.all(), now)

    def follow(self, agent: Agent, pose: Pose, now: float, news: bool) -> list[Effect]:
        """Do as orders say, leave what is forbidden, or take up a new decision's plan at its start."""
        given = agent.orders.in_force(agent.robot)
        if given != self.obeyed:
            return self._obey(agent, pose, given, now)
        if self.mission.forbidden != self.minded and (out := self._mind(agent, pose, now)):
            return out
        if self.obeyed is not None:
            return self._go_on(agent, pose, now)
        if self.state is State.LEAVING and self.flight.planned(now):
            return []
        plan = self.mission.plan() if news and not agent.finished else None
        if plan is not None and not self._keeps_out(self.flight.joined(plan, now), pose, now):
            plan = None
        if plan is not None:
            self.flight = self.flight.joined(plan, now)
        if agent.finished:
            self.state = State.DONE
        elif self.flight.planned(now):
            self.state = State.FLYING if self.turn_rate is not None else State.DRIVING
        elif self.flight.plans:
            self.state = self._at_rest
        return [] if plan is None else [Fly(plan)]

    # -- orders ---------------------------------------------------------------------------------------

    def _obey(self, agent: Agent, pose: Pose, given: Given | None, now: float) -> list[Effect]:
        """Give the work back and do as the operator says; without an order, ask for work."""
        self.obeyed, self.tries = given, 0
        self.mission.stand_by()
        agent.rounds.want()
        match None if given is None else given.order:
            case None:
                self.state = self._at_rest
            case Pause():
                self.state = State.PAUSED
            case Recall(to=place) | LookThere(at=place):
                self.called = place or self.home
                return self._head_for(pose, now)
            case _:
                self.state = State.DONE
        return self._hold(pose, now)

    def _go_on(self, agent: Agent, pose: Pose, now: float) -> list[Effect]:
        """Note that the vehicle is where the operator wants it, or try again to get there."""
        if self.state not in ON_THE_WAY or self.flight.planned(now):
            return []
        if self.called is not None and not self._getting.is_at(pose, self.called) and self.tries < MOST_TRIES:
            return self._head_for(pose, now)
        if self.state is State.LOOKING:
            agent.orders.fulfil(agent.robot)
        self.state = State.DONE
        return []

    def _head_for(self, pose: Pose, now: float) -> list[Effect]:
        """Fly to where the operator wants the vehicle, there to circle or stand; if there is no way, here."""
        looks = self.obeyed is not None and isinstance(self.obeyed.order, LookThere)
        self.state, self.tries = State.LOOKING if looks else State.RETURNING, self.tries + 1
        plan = None if self.called is None else self._getting.to(self.mission, pose, self.called, now)
        return self._hold(pose, now) if plan is None else self._fly(plan, now)

    def _hold(self, pose: Pose, now: float) -> list[Effect]:
        """Circle, or stand, from now on, if that keeps out of what is forbidden."""
        rest = self._getting.nowhere(now)
        if self._keeps_out(self.flight.joined(rest, now), pose, now):
            return self._fly(rest, now)
        return self._fly(self._getting.out(self.mission, pose, now) or rest, now)

    # -- no-go areas ----------------------------------------------------------------------------------

    def _mind(self, agent: Agent, pose: Pose, now: float) -> list[Effect]:
        """Leave areas that have come to be forbidden, or turn away from them; go round them on an own way."""
        self.minded = self.mission.forbidden
        if self._keeps_out(self.flight, pose, now):
            return []
        if self.obeyed is not None and isinstance(self.obeyed.order, Recall | LookThere):
            return self._head_for(pose, now)
        if self.obeyed is not None and self.turn_rate is None:
            return []  # it stands by order
        agent.rounds.want()
        plan = self._getting.out(self.mission, pose, now) or self._getting.nowhere(now)
        if self.obeyed is None:
            self.state = State.LEAVING
        return self._fly(plan, now)

    def _keeps_out(self, flight: Itinerary, pose: Pose, now: float) -> bool:
        """Tell whether a flight, and the circle after it, keeps out of what is forbidden."""
        if not self.mission.forbidden:
            return True
        return self._getting.keeps_out(self.mission.forbidden, flight, pose, now)

    def _fly(self, plan: AnyPlan, now: float) -> list[Effect]:
        self.flight = self.flight.joined(plan, now)
        return [Fly(plan)]

    @property
    def _at_rest(self) -> State:
        return State.CIRCLING if self.turn_rate is not None else State.IDLE

    # -- what others ask ------------------------------------------------------------------------------

    def look_out(self, agent: Agent, pose: Pose, now: float) -> list[Effect]:
        """Look out for nobody."""
        return []

    def moved(self, agent: Agent, event: Arrived | Stuck, now: float) -> list[Effect]:
        """Arrive nowhere."""
        return []

    def ahead(self, pose: Pose) -> NDArray[np.float64]:
        """Beacon no path: nobody has to make room."""
        return np.empty((0, 2))

    def departure(self, agent: Agent, pose: Pose, belief: object) -> Pose:
        """Return where the present flight takes the vehicle by the time strategies on this belief start."""
        start = self.mission.start(belief)
        x, y, heading = self.flight.fly((pose.x, pose.y, pose.heading), self.speed, agent.posed, start)
        works = pose.at_work and self.obeyed is None
        return replace(Pose(float(x), float(y), float(heading)), at_work=works)

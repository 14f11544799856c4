"""What a vehicle does with its strategy: it flies it, and circles when it has none, or stands if it may.

Vehicles keep altitudes of their own, so that nobody makes room for anybody, and none gets stuck.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vedette.agent.effects import Effect, Fly
from vedette.agent.events import Arrived, Pose, Scan, Sensed, Stuck
from vedette.agent.flight import Itinerary
from vedette.agent.mission import FlightMission
from vedette.agent.state import Agent, State
from vedette.outcome import Outcome


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

    def __post_init__(self) -> None:
        self.flight = Itinerary(self.turn_rate)

    @property
    def ending(self) -> Outcome:
        """A vehicle leaves nothing that it could have done."""
        return Outcome.COMPLETE

    def wake(self, agent: Agent, pose: Pose, now: float) -> bool:
        """Take part in rounds from the first pose on."""
        return True

    def sense(self, agent: Agent, seen: Scan | Sensed, now: float) -> None:
        """Hand on what the vehicle sees."""
        if agent.pose is not None:
            self.mission.observe(seen, agent.pose, agent.mates.all(), now)

    def follow(self, agent: Agent, pose: Pose, now: float, news: bool) -> list[Effect]:
        """Take up a new decision's plan at its start."""
        plan = self.mission.plan() if news and not agent.finished else None
        if plan is not None:
            self.flight = self.flight.joined(plan, now)
        if agent.finished:
            self.state = State.DONE
        elif self.flight.planned(now):
            self.state = State.FLYING if self.turn_rate is not None else State.DRIVING
        elif self.flight.plans:
            self.state = State.CIRCLING if self.turn_rate is not None else State.IDLE
        return [] if plan is None else [Fly(plan)]

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
        return Pose(float(x), float(y), float(heading))

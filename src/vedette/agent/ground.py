"""What a robot on the ground does with its strategy: drives, arrives, gets stuck, makes room, goes home."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import hypot
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vedette.agent.driving import YIELD_LIMIT, Driver
from vedette.agent.effects import Drive, Effect
from vedette.agent.events import Arrived, Pose, Scan, Sensed, Stuck
from vedette.agent.mission import Enduring, GroundMission, Leaving
from vedette.agent.orders import End, Given, LookThere, Pause, Recall, Stay
from vedette.agent.state import Agent, State
from vedette.outcome import Outcome

HOME = 0.3  # from its start a robot is at home [m]
HOME_AGAIN = 3.0  # a robot whose way home is blocked tries again after so long [s]
HOME_TRIES = 10  # then it stays where it is
LOOK_TRIES = 3  # where it cannot look, it works on
ON_THE_WAY = (State.RETURNING, State.LOOKING)  # to a place of its own
LISTEN = 3.0  # a robot waits at most so long for its mates' first beacons before it maps [s]
GATHER = 120.0  # and so long for mates that it was told to expect [s]
LOOK_OUT_PERIOD = 0.5  # [s]
CHECK_PERIOD = 1.0  # of the present goal's point [s]


@dataclass
class GroundBehaviour:
    """Drives from goal to goal of the latest decision; ``vedette.agent.state.Behaviour``."""

    mission: GroundMission[Any, Any, Any]
    driver: Driver
    return_home: bool = False
    expected: int = 1  # robots, itself included, that it waits for before it begins
    state: State = State.WAITING
    home: tuple[float, float] | None = None
    home_tries: int = 0  # ways home that were blocked
    listening: bool = True  # until all mates have been heard, or for a while: they are not to be mapped
    held: Scan | Sensed | None = None  # the latest while listening
    obeyed: Given | None = None  # the order that keeps it from work
    called: tuple[float, float] | None = None  # where that wants it [m]; None: home
    spent: bool = False  # it has turned back, lest it does not come home

    @property
    def ending(self) -> Outcome:
        """The mission's own word; or that the operator has called the robot off, or it has turned back."""
        if self.obeyed is not None:
            return Outcome.ORDERED
        return Outcome.SPENT if self.spent else self.mission.ending

    def wake(self, agent: Agent, pose: Pose, now: float) -> bool:
        """Begin to map once the mates' places are known, so that they are not taken for obstacles."""
        self.home = self.home or (pose.x, pose.y)
        if not self.listening:
            return True
        until = agent.due.setdefault("listen", now + (GATHER if self.expected > 1 else LISTEN))
        tree = agent.rounds.tree
        alone = tree.epoch == 0  # no tree yet
        missing = len(agent.mates.heard) < max(tree.size, self.expected) - 1
        if (alone or missing) and now < until:
            return False
        self.listening = False
        if self.held is not None:
            self.mission.observe(self.held, pose, agent.mates.all(), now)
            self.held = None
        return True

    def sense(self, agent: Agent, seen: Scan | Sensed, now: float) -> None:
        """Map what the robot sees."""
        if self.listening:
            self.held = seen
        elif agent.pose is not None:
            self.mission.observe(seen, agent.pose, agent.mates.all(), now)

    def departure(self, agent: Agent, pose: Pose, belief: object) -> Pose:
        """Return the pose itself: tours begin where the robot is."""
        works = self.obeyed is None and not self.spent
        return pose if works else replace(pose, at_work=False)

    def ahead(self, pose: Pose) -> NDArray[np.float64]:
        """Return the next few metres that the robot will really drive, ``(L, 2)`` [m], team frame."""
        return self.driver.beaconed(pose)

    # -- driving ------------------------------------------------------------------------------------

    def follow(self, agent: Agent, pose: Pose, now: float, news: bool) -> list[Effect]:
        """Drive where orders or the latest decision want the robot; after the last one, home or nowhere."""
        given = agent.ordered
        if given != self.obeyed:
            return self._obey(agent, pose, given, now)
        if (out := self._leave(agent, pose, now)) is not None:
            return out
        if self.obeyed is not None:
            return self._go_on_home(agent, pose, now)
        if self._has_to_turn_back(agent, pose, now):
            self.spent, self.home_tries = True, 0
            self.mission.stand_by()
            agent.rounds.want()
            return self._go_home(agent, pose, now, blocked=False)
        if self.spent:
            return self._go_on_home(agent, pose, now)
        if not pose.at_work or self.state is State.PAUSED:
            return self._pause(agent, pose)
        effects = self._follow_decision(agent, pose, now) if news else []
        return [*effects, *self._go_on_home(agent, pose, now)]

    def _go_on_home(self, agent: Agent, pose: Pose, now: float) -> list[Effect]:
        """Try again where the way home was taken."""
        waiting = self.state in ON_THE_WAY and self.driver.standing
        if waiting and agent.is_due("home", HOME_AGAIN, now):
            return self._go_home(agent, pose, now, blocked=False)
        return []

    def _has_to_turn_back(self, agent: Agent, pose: Pose, now: float) -> bool:
        """Tell whether it is time to go home, lest the robot does not come there."""
        works = not self.spent and self.state not in (State.DONE, State.WAITING) and pose.at_work
        if not works or not agent.is_due("turn", CHECK_PERIOD, now):
            return False
        return isinstance(self.mission, Enduring) and self.mission.turns_back(pose)

    # -- orders -------------------------------------------------------------------------------------

    def _obey(self, agent: Agent, pose: Pose, given: Given | None, now: float) -> list[Effect]:
        """Give the work back and do as the operator says; without an order, ask for work."""
        self.obeyed, self.called, self.home_tries = given, None, 0
        self.mission.stand_by()
        agent.rounds.want()
        agent.quiet = 0
        order = None if given is None else agent.in_own(given.order)
        match order:
            case None:
                self.state = State.IDLE
            case Pause():
                self.state = State.PAUSED
            case Recall(to=place) | LookThere(at=place):
                self.called = place
                self.state = State.LOOKING if isinstance(order, LookThere) else State.RETURNING
                return self._go_home(agent, pose, now, blocked=False)
            case _:
                self.state = State.DONE
        return [self.driver.go(None)]

    def _leave(self, agent: Agent, pose: Pose, now: float) -> list[Effect] | None:
        """Leave a no-go area that the robot finds itself in; None: it is in none, or is held where it is."""
        if self.state in (State.PAUSED, State.DONE) or not pose.at_work:
            return None
        if self.state is State.LEAVING and not self.driver.standing:
            return []
        if not agent.orders.any_no_go or not agent.is_due("leave", CHECK_PERIOD, now):
            return None
        route = self.mission.way_out(pose) if isinstance(self.mission, Leaving) else None
        if route is None:
            return None
        self.mission.stand_by()
        self.state = State.LEAVING
        return [self.driver.go(route)]

    def _looked(self, agent: Agent) -> list[Effect]:
        """Work on: the robot has looked where it was to look, or cannot get there."""
        agent.orders.fulfil(agent.robot)
        return [self.driver.go(None)]

    def _pause(self, agent: Agent, pose: Pose) -> list[Effect]:
        """Give the work back while somebody keeps the robot from it; ask for some when that is over."""
        if pose.at_work:
            self.state = State.IDLE
            agent.rounds.want()
        elif self.state not in (State.PAUSED, State.RETURNING, State.DONE):
            self.state = State.PAUSED
            self.mission.stand_by()
            agent.rounds.want()
            return [self.driver.go(None)]
        return []

    def _follow_decision(self, agent: Agent, pose: Pose, now: float) -> list[Effect]:
        if not agent.finished:
            return self._drive_on(agent, pose, now)
        if self.state in (State.DONE, State.RETURNING):
            return []
        if not self.return_home or self.home is None:
            self.state = State.DONE
            return [self.driver.go(None)]
        return self._go_home(agent, pose, now, blocked=False)

    def _drive_on(self, agent: Agent, pose: Pose, now: float) -> list[Effect]:
        """Drive to the strategy's next goal; with none, stand by."""
        goal = self.mission.goal()
        if goal is None:
            self.state = State.IDLE
            return [self.driver.go(None)]
        if self.driver.yielding:
            return []
        route = self.mission.route(pose, goal, agent.mates.all(), self.state is State.STUCK, now)
        if route is None:
            self.mission.release(now)
            agent.rounds.want()
            self.state = State.IDLE
        else:
            self.state = State.DRIVING
        return [self.driver.go(route)]

    def moved(self, agent: Agent, event: Arrived | Stuck, now: float) -> list[Effect]:
        """Take up what has become of the robot's way."""
        if agent.pose is None:
            return []
        arrived = isinstance(event, Arrived)
        return self._arrived(agent, agent.pose, now) if arrived else self._stuck(agent, agent.pose, now)

    def _arrived(self, agent: Agent, pose: Pose, now: float) -> list[Effect]:
        """Go on to the next stop; at home, be done."""
        if self.driver.yielding or self.driver.wanted is None:
            return []
        if self.state is State.LEAVING:
            self.state = State.IDLE
            self.driver.go(None)
            agent.rounds.want()
            self.obeyed = None  # what was ordered is taken up again
            return [self.driver.go(None)]
        if self.state in ON_THE_WAY:
            if not self._at_home(pose):
                return self._wait_for_home(agent, now)
            if self.state is State.LOOKING:
                return self._looked(agent)
            self.state = State.DONE
            return [self.driver.go(None)]
        if self.state is not State.DRIVING:
            return []
        if self.mission.reached(pose, agent.mates.all(), now):
            agent.rounds.want()
        return self._drive_on(agent, pose, now)

    def _stuck(self, agent: Agent, pose: Pose, now: float) -> list[Effect]:
        """Release the work at once, so that others can take it, and plan round what is in the way."""
        if self.state in ON_THE_WAY:
            return self._go_home(agent, pose, now, blocked=True)
        if self.state is State.LEAVING:
            return [self.driver.go(None)]
        if self.state is State.DONE:
            return [self.driver.go(None)]
        if self.state is not State.DRIVING and not self.driver.yielding:
            return []
        self.mission.release(now)
        self.state = State.STUCK
        agent.rounds.blocked = True
        agent.rounds.want()
        return [self.driver.go(None)]

    # -- mates and time -----------------------------------------------------------------------------

    def look_out(self, agent: Agent, pose: Pose, now: float) -> list[Effect]:
        """Make room for mates, and ask for a round when the present goal has lost its point."""
        if not pose.at_work or self.state in (State.PAUSED, State.LEAVING) or self._is_to_stay:
            return []
        effects = self._make_room(agent, pose, now) if agent.is_due("look out", LOOK_OUT_PERIOD, now) else []
        checks = agent.is_due("check", CHECK_PERIOD, now)
        if checks and self.state is State.DRIVING and self.mission.served():
            agent.rounds.want()
        return effects

    def _make_room(self, agent: Agent, pose: Pose, now: float) -> list[Effect]:
        """Make room for a mate that has the right of way, and go on when it has passed."""
        mates = agent.mates.all()
        if not mates:
            return []
        if self.driver.yielding and now > self.driver.yielding_since + YIELD_LIMIT:
            return self._stuck(agent, pose, now)
        standing = self.driver.wanted or self.mission.route(pose, (pose.x, pose.y), mates, False, now)
        if standing is None:
            return []
        drive: Drive | None = self.driver.look_out(pose, mates, standing, now)
        if self.driver.yielding and self.state is State.DRIVING:
            self.state = State.YIELDING
        elif not self.driver.yielding and self.state is State.YIELDING:
            return self._drive_on(agent, pose, now)
        elif self.state is State.DONE and self.driver.standing and self._strayed(pose):
            return self._go_home(agent, pose, now, blocked=False)
        return [] if drive is None else [drive]

    # -- the way home -------------------------------------------------------------------------------

    def _go_home(self, agent: Agent, pose: Pose, now: float, *, blocked: bool) -> list[Effect]:
        """Drive to where the robot started, or where the operator wants it."""
        place = self.called or self.home
        assert place
        route = self.mission.route(pose, place, agent.mates.all(), blocked, now)
        if route is None:
            return self._wait_for_home(agent, now)
        if self.state is not State.LOOKING:
            self.state = State.RETURNING
        return [self.driver.go(route)]

    def _wait_for_home(self, agent: Agent, now: float) -> list[Effect]:
        """Stand for a while where the way home, or home itself, is taken; in the end stay here."""
        self.home_tries += 1
        agent.due["home"] = now + HOME_AGAIN
        if self.state is State.LOOKING:
            return self._looked(agent) if self.home_tries > LOOK_TRIES else [self.driver.go(None)]
        self.state = State.RETURNING if self.home_tries <= HOME_TRIES else State.DONE
        return [self.driver.go(None)]

    def _at_home(self, pose: Pose) -> bool:
        place = self.called or self.home
        return place is None or hypot(pose.x - place[0], pose.y - place[1]) <= HOME

    @property
    def _is_to_stay(self) -> bool:
        """Tell whether the operator wants the robot to stand where it is."""
        return self.obeyed is not None and isinstance(self.obeyed.order, Stay | End)

    def _strayed(self, pose: Pose) -> bool:
        """Tell whether the robot, done, had to make room and could go home again."""
        homing = self.return_home or self.obeyed is not None or self.spent
        return homing and self.home_tries <= HOME_TRIES and not self._at_home(pose)

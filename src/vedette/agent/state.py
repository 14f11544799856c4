"""A robot's whole state, as its agent keeps it, and what a behaviour does with it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from enum import Enum
from math import inf
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from vedette.agent.audit import Auditor
from vedette.agent.body import Hull
from vedette.agent.effects import Effect
from vedette.agent.events import Arrived, Pose, Scan, Sensed, Stuck
from vedette.agent.mates import Mates
from vedette.agent.mission import Framing, Mission
from vedette.agent.orders import Given, OrderBook, OrderT, moved
from vedette.agent.pace import Pace
from vedette.agent.proofs import Proofs
from vedette.agent.relay import Relay
from vedette.agent.rounds import Decision, Rounds
from vedette.fusion.standing import Signed, signed_by
from vedette.outcome import Outcome

QUIET_ROUNDS = 2  # so many rounds in a row with nothing to gain for anybody end the mission


class State(Enum):
    """What a robot is doing, as people are shown it."""

    WAITING = "waiting"  # for its first plan
    DRIVING = "driving"
    YIELDING = "making room"
    STUCK = "stuck"
    PAUSED = "paused"  # by somebody beside the robot
    IDLE = "idle"  # nothing it can do is worth doing
    RETURNING = "returning"
    LOOKING = "looking where it was told"
    LEAVING = "leaving a no-go area"
    FLYING = "flying"
    CIRCLING = "circling"  # its plan has run out
    DONE = "done"


class Behaviour(Protocol):
    """What one kind of robot does with its strategy: the part of an agent between decisions and motion."""

    @property
    def mission(self) -> Mission[Any, Any, Any]:
        """The robot's share of the mission."""

    @property
    def state(self) -> State:
        """What the robot is doing."""

    @property
    def ending(self) -> Outcome:
        """How the mission ends for this robot, asked when it is done."""

    def wake(self, agent: Agent, pose: Pose, now: float) -> bool:
        """Tell whether the robot takes part in rounds yet; called first, whenever time has gone on."""

    def sense(self, agent: Agent, seen: Scan | Sensed, now: float) -> None:
        """Take in what the robot's sensor saw."""

    def moved(self, agent: Agent, event: Arrived | Stuck, now: float) -> list[Effect]:
        """Take up what has become of the robot's way."""

    def follow(self, agent: Agent, pose: Pose, now: float, news: bool) -> list[Effect]:
        """Carry out the strategy; ``news``: a round has just ended with a decision."""

    def look_out(self, agent: Agent, pose: Pose, now: float) -> list[Effect]:
        """Mind the mates, and whether the strategy still has a point."""

    def ahead(self, pose: Pose) -> NDArray[np.float64]:
        """Return the next few metres of the robot's path, ``(L, 2)`` [m], team frame, for its beacon."""

    def departure(self, agent: Agent, pose: Pose, belief: object) -> Pose:
        """Return where the robot will be when a strategy planned on this belief starts."""


@dataclass
class Agent:
    """One robot's whole state."""

    robot: int
    boot: int
    hull: Hull
    behaviour: Behaviour
    scheme: str = "token"
    pace: Pace = field(default_factory=Pace)  # of rounds
    forks: bool = False  # the token may fork in a large team
    pose: Pose | None = None
    posed: float = 0.0  # when that came [s]
    awake: bool = False  # it takes part in rounds
    dropped: int = 0  # messages that did not make sense
    dropped_of: Counter[int] = field(default_factory=Counter)  # the same by neighbour
    mates: Mates = field(default_factory=Mates)
    relay: Relay = field(default_factory=Relay)  # of their beacons
    rounds: Rounds = field(init=False)
    proofs: Proofs | None = field(default=None, init=False)  # of lies, where robots sign
    framing: Framing | None = field(default=None, init=False)  # where robots share no frame
    quiet: int = 0  # rounds in a row with nothing to gain for anybody
    elsewhere: bool = False  # there is, for who is on maps that nothing joins with this robot's
    beacons: int = 0  # sent
    due: dict[str, float] = field(default_factory=dict)  # when what is to be done next [s]
    news: bool = False  # a new decision waits to be carried out
    orders: OrderBook = field(default_factory=OrderBook)  # of the operator
    check_order: Callable[[Given], None] = lambda given: (
        None
    )  # raises ValueError for one that is not in order

    def __post_init__(self) -> None:
        self.rounds = Rounds(self.mission, self.scheme, self._decided, self.pace, forks=self.forks)
        self.rounds.scrutiny.anybody_moves = self.mates.anybody_moves
        self.rounds.scrutiny.suspicion.held_up = self.mates.holdups.behind
        self.rounds.mandate = lambda: self.orders.digest
        if isinstance(self.mission, Framing):
            self.framing = self.mission
            self.mates.framed = self.mission.in_own
        if self.signed is not None:
            auditor = Auditor(self.robot, self.boot, self.mission, self.signed.standing)
            auditor.promises.held_up = self.mates.holdups.of
            self.rounds.scrutiny.auditor = auditor
            self.proofs = Proofs(self.mission, self.signed)

    @property
    def mission(self) -> Mission[Any, Any, Any]:
        """The robot's share of the mission."""
        return self.behaviour.mission

    @property
    def signed(self) -> Signed | None:
        """The team's evidence, where it is signed."""
        return signed_by(self.mission.fusion)

    @property
    def complaints(self) -> dict[int, str]:
        """What is wrong with whom, by robot."""
        absent = dict.fromkeys(self.rounds.absent, "rounds go on without it: it does not answer")
        slow = dict.fromkeys(self.rounds.slow, "it is slow: rounds wait for it")
        signed = {} if self.signed is None else self.signed.complaints
        caught = {} if self.rounds.scrutiny.auditor is None else self.rounds.scrutiny.auditor.caught
        return slow | absent | self.rounds.scrutiny.suspicion.complaints | caught | signed

    @property
    def state(self) -> State:
        """What the robot is doing."""
        return self.behaviour.state

    @property
    def ordered(self) -> Given | None:
        """What the robot is to do instead of working; None: it works.

        It works on, too, while it does not know where the frame lies that the order's place is in.
        """
        given = self.orders.in_force(self.robot)
        if given is None or self.framing is None or (of := given.order.in_frame_of) is None:
            return given
        return None if self.framing.in_own(of) is None else given

    def in_own(self, order: OrderT) -> OrderT:
        """Return an order with its place in the frame that the robot reckons in."""
        of = order.in_frame_of
        there = None if of is None or self.framing is None else self.framing.in_own(of)
        return order if there is None else moved(order, there)

    @property
    def finished(self) -> bool:
        """Tell whether the team has agreed that nothing is left to gain."""
        return self.quiet >= QUIET_ROUNDS

    @property
    def done(self) -> bool:
        """Tell whether this robot has nothing left to do, the way home included."""
        return self.state is State.DONE

    @property
    def ending(self) -> Outcome:
        """How the mission ends for this robot, once it is done."""
        ending = self.behaviour.ending
        return Outcome.UNJOINED if self.elsewhere and ending is Outcome.COMPLETE else ending

    def _decided(self, decision: Decision) -> None:
        """Count rounds with nothing to gain; one alone with nothing to gain says nothing of the team's."""
        exact = decision.alone or not decision.approximate
        quiet = exact and not decision.blocked and self.mission.nothing_left(decision.value, decision.time)
        self.quiet = self.quiet + (not decision.alone) if quiet else 0
        self.elsewhere = decision.elsewhere
        self.news = True

    def is_due(self, what: str, period: float, now: float) -> bool:
        """Tell whether something periodic [s] is to be done now, and note when it will be again."""
        if now < self.due.get(what, -inf) - 1e-9:
            return False
        self.due[what] = now + period
        return True

"""Driving by NavigateToPose: what is asked of the navigator, and what its answers mean for the robot.

A state machine without input and output. Goals are told apart by numbers of ours; what the navigator says of
one that is no longer wanted means nothing. The ``status`` topic is the truth about a goal: its result may get
lost on the way.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum, IntEnum
from math import hypot, pi, tau
from typing import TypeAlias

from vedette.agent.events import Arrived, Stuck

THERE = 0.2  # a robot this near a place has reached it, if it need not face anywhere [m]
SAME_PLACE = 0.05  # a goal this near the present one is the same [m] ...
SAME_HEADING = 0.02  # ... if it faces the same way [rad]
ANSWER = 5.0  # a goal is given up that has not been answered for so long [s]
AGAIN = 2.0  # a goal that was rejected, as by a navigator that is not active yet, is sent again [s]
REJECTED = 60.0  # ... for so long; then the robot is stuck [s]
UNMOVED = 30.0  # a robot that neither moves nor turns for so long while driving is stuck [s]
GIVEN_UP = "the navigator gave the goal up"
MOVED = 0.1  # less is no movement [m]
TURNED = 0.2  # less is no turn [rad]

Place: TypeAlias = tuple[float, float, float]  # x, y [m], heading [rad]


class ActionStatus(IntEnum):
    """``action_msgs/GoalStatus``."""

    UNKNOWN = 0
    ACCEPTED = 1
    EXECUTING = 2
    CANCELING = 3
    SUCCEEDED = 4
    CANCELED = 5
    ABORTED = 6


@dataclass(frozen=True)
class Ask:
    """Send a goal; the navigator lets go of the one before."""

    goal: int
    place: Place


@dataclass(frozen=True)
class Cancel:
    """Cancel a goal."""

    goal: int


Order: TypeAlias = Ask | Cancel
Outcome: TypeAlias = Arrived | Stuck


class _State(Enum):
    STANDING = "standing"
    ASKED = "asked"  # no answer yet
    REJECTED = "rejected"  # to be asked again
    DRIVING = "driving"


@dataclass
class Errands:
    """Asks for one place after another; times are the mission's [s]."""

    orders: list[Order] = field(default_factory=list)  # to be carried out, in order; whoever does takes them
    outcomes: list[Outcome] = field(default_factory=list)  # for the agent, likewise
    said: str = ""  # why the last goal was not reached, in words
    wanted: Place | None = None
    slowed: float = 0.0  # time since the robot last moved or turned while it should [s]
    _state: _State = _State.STANDING
    _goal: int = 0  # number of the latest
    _aborted: int = 0  # the latest that the navigator gave up
    _since: float = 0.0  # in this state
    _facing: bool = True  # whether the heading of the present place matters
    _rolling: bool = False  # the robot has reached the place, and the navigator is still at its last touch
    _rejected: float | None = None  # since when this place is rejected
    _spot: tuple[Place, float] | None = None  # where the robot last moved to, and when

    @property
    def driving(self) -> bool:
        """Tell whether the navigator has taken the present goal up."""
        return self._state is _State.DRIVING

    # -- what the agent wants ---------------------------------------------------------------------------

    def want(self, place: Place | None, now: float, *, facing: bool = True) -> None:
        """Go to a place; None: stand. Where the robot is going already it is not sent again.

        ``facing``: whether the heading matters.
        """
        if place is None:
            if self._rolling or self._state in (_State.ASKED, _State.DRIVING):
                self.orders.append(Cancel(self._goal))
            self._rolling = False
            self._stand()
            return
        if self.wanted is not None and _near(place, self.wanted):
            faces = _turn(place[2], self.wanted[2]) <= SAME_HEADING
            if faces or not facing:
                self._facing |= facing
                return
        self.wanted, self._facing, self._rejected, self._spot = place, facing, None, None
        self._ask(now)

    def _ask(self, now: float) -> None:
        assert self.wanted is not None
        self._goal += 1
        self._rolling = False
        self._enter(_State.ASKED, now)
        self.orders.append(Ask(self._goal, self.wanted))

    def _enter(self, state: _State, now: float) -> None:
        self._state, self._since = state, now

    def _stand(self) -> None:
        self.wanted, self._state, self.slowed, self._spot = None, _State.STANDING, 0.0, None

    def _give_up(self, why: str) -> None:
        self.said = why
        self._stand()
        self.outcomes.append(Stuck())

    # -- what the navigator says ------------------------------------------------------------------------

    def accepted(self, goal: int, now: float) -> None:
        """Hear that a goal is taken up; one that nobody wants any more is cancelled."""
        if goal != self._goal or self._state is _State.STANDING:
            if self._state is _State.STANDING and not self._rolling:  # else a newer goal takes its place
                self.orders.append(Cancel(goal))
            return
        if self._state is _State.ASKED:
            self._rejected = None
            self._enter(_State.DRIVING, now)

    def rejected(self, goal: int, now: float) -> None:
        """Hear that a goal is not taken: the navigator is not active, or is going down."""
        if goal == self._goal and self._state is _State.ASKED:
            self._rejected = now if self._rejected is None else self._rejected
            self._enter(_State.REJECTED, now)

    def status(self, goal: int, status: int, now: float) -> None:
        """Hear how a goal stands, from the status topic or with its result."""
        if goal != self._goal or self._state not in (_State.ASKED, _State.DRIVING):
            self._rolling &= goal != self._goal or status <= ActionStatus.CANCELING
            return
        if status == ActionStatus.SUCCEEDED:
            self.said = ""
            self._stand()
            self.outcomes.append(Arrived())
        elif status == ActionStatus.ABORTED:
            self._aborted = goal
            self._give_up(GIVEN_UP)
        elif status == ActionStatus.CANCELED:
            self._give_up("somebody else cancelled the goal")
        elif status in (ActionStatus.ACCEPTED, ActionStatus.EXECUTING):
            self.accepted(goal, now)

    def explained(self, goal: int, why: str) -> None:
        """Hear why a goal was given up, if that is still the latest trouble."""
        if goal == self._aborted and self.said.startswith(GIVEN_UP):
            self.said = f"{GIVEN_UP}: {why}"

    def gone(self, now: float) -> None:
        """Hear that there is no navigator, or another than the one that took the goal up: ask again later."""
        self._rolling = False
        if self._state in (_State.ASKED, _State.DRIVING):
            self._rejected = now if self._rejected is None else self._rejected
            self._enter(_State.REJECTED, now)

    # -- time -------------------------------------------------------------------------------------------

    def tick(self, at: Place | None, now: float) -> None:
        """Let time pass with the robot at a place; None: it does not know where."""
        if self._state is _State.ASKED and now >= self._since + ANSWER:
            self.orders.append(Cancel(self._goal))  # it may have been heard
            self._give_up(f"the navigator did not answer for {ANSWER:g} s")
        elif self._state is _State.REJECTED:
            assert self._rejected is not None
            if now >= self._rejected + REJECTED:
                self._give_up(f"the navigator rejected the goal for {REJECTED:g} s")
            elif now >= self._since + AGAIN:
                self._ask(now)
        elif self._state is _State.DRIVING:
            self._watch(at, now)
            if self._state is _State.DRIVING and self._is_there(at):
                self.said, self._rolling = "", True
                self._stand()
                self.outcomes.append(Arrived())

    def _is_there(self, at: Place | None) -> bool:
        """Tell whether the robot is where it is to be: it need not wait until it stands and has turned."""
        return (
            not self._facing and at is not None and self.wanted is not None and _near(at, self.wanted, THERE)
        )

    def _watch(self, at: Place | None, now: float) -> None:
        """Give up a goal that the robot does not move for; the navigator's own recoveries have their time."""
        if self._spot is None or (at is not None and _moved(at, self._spot[0])):
            self._spot = at or (0.0, 0.0, 0.0), now
        self.slowed = now - self._spot[1]
        if self.slowed >= UNMOVED:
            self.orders.append(Cancel(self._goal))
            self._give_up(f"the robot did not move for {UNMOVED:g} s")


def _near(a: Place, b: Place, within: float = SAME_PLACE) -> bool:
    return hypot(a[0] - b[0], a[1] - b[1]) <= within


def _moved(a: Place, b: Place) -> bool:
    return hypot(a[0] - b[0], a[1] - b[1]) > MOVED or _turn(a[2], b[2]) > TURNED


def _turn(a: float, b: float) -> float:
    return abs((a - b + pi) % tau - pi)

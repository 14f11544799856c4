"""What a domain gives the agent: a belief to keep, a platform to plan for, strategies to carry out."""

from __future__ import annotations

from collections.abc import Collection, Hashable, Sequence
from typing import Any, Protocol, TypeVar, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from vedette.agent.effects import Job, Route
from vedette.agent.events import Pose
from vedette.agent.flight import AnyPlan
from vedette.agent.mates import Mate
from vedette.agent.messages import FrameTold, Note
from vedette.agent.orders import OrderBook
from vedette.forbidden import Forbidden
from vedette.maps.transform import Transform
from vedette.outcome import Outcome
from vedette.problem import Codec, Objective, Reach

Place = tuple[float, float]  # [m], team frame

BeliefT = TypeVar("BeliefT")
BeliefT_contra = TypeVar("BeliefT_contra", contravariant=True)
ImpactT = TypeVar("ImpactT")


class Exchange(Protocol):
    """How a robot shares evidence with its neighbours on the tree; payloads may be lost or repeated."""

    @property
    def digest(self) -> int:
        """Equal for two robots iff they hold the same evidence."""

    def set_neighbours(self, neighbours: Sequence[int]) -> None:
        """Exchange with exactly these robots from now on."""

    def outgoing(self, neighbour: int, now: float) -> bytes | None:
        """Return the next payload for a neighbour, or None if there is no news."""

    def receive(self, neighbour: int, payload: bytes, now: float) -> object:
        """Take in a payload (ValueError if malformed)."""


StrategyT = TypeVar("StrategyT", bound=Hashable)  # within a round equal ones have equal impacts


class RoundPlatform(Protocol[BeliefT_contra, StrategyT, ImpactT]):
    """A robot's platform, prepared for a round; compare ``vedette.problem.Platform``."""

    def impact(self, belief: BeliefT_contra, strategy: StrategyT) -> ImpactT:
        """Return ``Y_i(strategy)`` (paper, eq. (13))."""

    def reply(self, belief: BeliefT_contra, others: ImpactT, current: StrategyT) -> StrategyT:
        """Return the best strategy against the rest of the team, ``current`` if none is better; fast."""

    def slack(self, belief: BeliefT_contra, base: ImpactT) -> float:
        """Return the most that a strategy of this platform adds to ``base``; infinite: not known."""


class Mission(Protocol[BeliefT, StrategyT, ImpactT]):
    """One robot's share of a mission, as rounds need it: its evidence, its platform, the team's objective.

    Beliefs, strategies, impacts and what is observed are the domain's own.
    """

    @property
    def fusion(self) -> Exchange:
        """How this robot shares evidence."""

    @property
    def codec(self) -> Codec[ImpactT]:
        """How impacts travel."""

    @property
    def objective(self) -> Objective[BeliefT, ImpactT]:
        """The team's ``*`` and ``psi``."""

    @property
    def platform(self) -> RoundPlatform[BeliefT, StrategyT, ImpactT]:
        """What this robot can do; ``prepare`` below prepares it."""

    strategy: StrategyT  # what the robot is doing; kept between rounds

    def observe(self, seen: Any, pose: Pose, mates: Sequence[Mate], now: float) -> None:
        """Take a ``Scan`` or what was ``Sensed`` into the robot's own evidence."""

    def publish(self, now: float) -> None:
        """Put the robot's own evidence where fusion sends it from; the only call that may do so."""

    def notes(self) -> Sequence[Note]:
        """Return what this robot has to tell the whole team within a round, beside its evidence."""

    def hear_notes(self, notes: Sequence[Note]) -> None:
        """Take in what anybody had to tell: all of it, anew in each round."""

    def freeze(self, t0: float) -> BeliefT:
        """Return the belief of a round: a snapshot of what the team knows.

        ``t0``: when the round froze [s], by the root's clock and the same for the whole team; from it
        (``flight.start_step``) everybody gets the same steps to plan for.
        """

    def prepare(self, belief: BeliefT, pose: Pose, mates: Sequence[Mate], blocked: bool, now: float) -> None:
        """Do the slow part of planning, the present strategy restated for the round included.

        ``pose``: where the robot will be when its strategy starts. ``blocked``: the robot cannot go on as it
        would, so that its mates count as obstacles. A robot that is kept from work takes none up.
        """

    def reach(self, now: float) -> Reach | None:
        """Return where this robot can make a difference in a round that begins now; None: anywhere."""

    def admit(self, belief: BeliefT, impact: ImpactT, robots: int) -> None:
        """Raise ``ValueError`` if so many robots' sensors cannot make a combined impact that claims so much.

        No impact that robots of the team do have may be refused.
        """

    def nothing_left(self, value: float, now: float) -> bool:
        """Tell whether a decision worth ``value``, all knowing the same and unhindered, leaves nothing to do.

        Two such rounds in a row end the mission.
        """


@runtime_checkable
class Promising(Protocol[BeliefT_contra, ImpactT]):
    """A mission whose impacts promise that places will be seen: it can be found out whether they are."""

    def promised(
        self, belief: BeliefT_contra, impact: ImpactT
    ) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Return the cells that are more likely seen than not, increasing, and after how long each [s]."""

    def unseen(self, belief: BeliefT_contra, cells: NDArray[np.int64]) -> NDArray[np.bool_]:
        """Tell which cells are as unknown as ever."""

    def discounted(self, impact: ImpactT, halvings: int) -> ImpactT:
        """Return an impact that is so many times half as likely."""


@runtime_checkable
class Framing(Protocol):
    """A mission of robots that share no frame: each round says where everybody's lies."""

    def lay_out(self) -> tuple[FrameTold, ...]:
        """As the root: return where contributors' frames lie on the plane of a round that begins."""

    def take_frames(self, told: Sequence[FrameTold]) -> bool:
        """Be on the plane as the root says; tell whether this robot has come to the same.

        Raises:
            ValueError: it cannot be.
        """

    def ground(self) -> Reach | None:
        """Return where on the round's plane what this robot is joined with can be; None: it is not on it."""

    def in_own(self, robot: int) -> Transform | None:
        """Return where a robot's frame lies in this one's; None: it is not known."""

    def meet(self, mates: Sequence[Mate], now: float) -> None:
        """Hear where mates are, each in the frame that it reckons in, and compare it with what is seen."""

    def errand(self, living: Collection[int], now: float) -> Job | None:
        """Return a job that finds out how two contributors' frames lie, if it is time for one."""


@runtime_checkable
class Enduring(Protocol):
    """A mission that minds how far its robot gets."""

    def turns_back(self, pose: Pose) -> bool:
        """Tell whether the robot has to drive home now, or can do nothing more and come home."""


@runtime_checkable
class Heeding(Protocol):
    """A mission whose plans heed orders about areas and about who is believed."""

    def heed(self, book: OrderBook) -> None:
        """Plan by these orders from now on."""


@runtime_checkable
class Leaving(Heeding, Protocol):
    """A mission on the ground, that knows the ways out of where nobody may be any more."""

    def way_out(self, pose: Pose) -> Route | None:
        """Return the shortest way out of where nobody may be any more; None: the robot is not in there."""


class GroundMission(Mission[BeliefT, StrategyT, ImpactT], Protocol[BeliefT, StrategyT, ImpactT]):
    """A mission whose strategies are places to drive to, one after another."""

    @property
    def ending(self) -> Outcome:
        """How the mission ends for this robot, asked when it has nothing left to do."""

    def goal(self) -> tuple[float, float] | None:
        """Return where the present strategy wants the robot next [m], team frame; None: nowhere."""

    def served(self) -> bool:
        """Tell whether the present goal has lost its point."""

    def reached(self, pose: Pose, mates: Sequence[Mate], now: float) -> bool:
        """Note that the robot is at its goal, and go on to the next; False: it has to look on from here."""

    def stand_by(self) -> None:
        """Leave the present strategy to others: somebody keeps the robot from it."""

    def release(self, now: float) -> None:
        """Give up the present strategy: the robot cannot carry it out."""

    def route(
        self, pose: Pose, goal: tuple[float, float], mates: Sequence[Mate], blocked: bool, now: float
    ) -> Route | None:
        """Return a way to a goal on the newest map, or None."""


class FlightMission(Mission[BeliefT, StrategyT, ImpactT], Protocol[BeliefT, StrategyT, ImpactT]):
    """A mission whose strategies are turn rates or velocities, held for a step each from a common time on."""

    def start(self, belief: BeliefT) -> float:
        """Return when strategies planned on a belief start [s]."""

    def plan(self) -> AnyPlan | None:
        """Return the present strategy as turn rates or velocities; None: circle, or stand."""

    @property
    def forbidden(self) -> Forbidden:
        """Where nobody may be."""

    def stand_by(self) -> None:
        """Leave the present strategy: orders keep the vehicle from it."""

    def route(self, here: Place, there: Place, room: float) -> list[Place]:
        """Return the corners of a way from place to place [m], both included; none: there is no way.

        ``room``: that it keeps from where nobody may be [m].
        """

    def passes(self, places: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Tell at which places (..., 2) [m] the vehicle can be, whatever is forbidden."""

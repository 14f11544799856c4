"""What a domain gives the agent: a belief to keep, a platform to plan for, goals to drive to."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from typing import Any, Protocol

from vedette.agent.effects import Route
from vedette.agent.events import Pose, Scan
from vedette.agent.mates import Mate
from vedette.agent.messages import GivenUp
from vedette.fusion import Fusion
from vedette.problem import Codec


class Mission(Protocol):
    """One robot's share of a mission. Beliefs, strategies and impacts are the domain's own (Any)."""

    @property
    def fusion(self) -> Fusion:
        """How this robot shares evidence."""

    @property
    def codec(self) -> Codec[Any]:
        """How impacts travel."""

    strategy: Any  # what the robot is doing; kept between rounds

    def observe(self, scan: Scan, pose: Pose, mates: Sequence[Mate], now: float) -> None:
        """Take a scan into the robot's own evidence."""

    def publish(self, now: float) -> None:
        """Put the robot's own evidence where fusion sends it from."""

    def given_up(self) -> Sequence[GivenUp]:
        """Return the places that this robot's visits did not change, to be told to the team."""

    def hear_given_up(self, given_up: Sequence[GivenUp]) -> None:
        """Take in the places that anybody's visit did not change: all of them, anew in each round."""

    def freeze(self) -> Any:
        """Return the belief of a round: a snapshot of what the team knows."""

    def prepare(self, belief: Any, pose: Pose, mates: Sequence[Mate], blocked: bool, now: float) -> None:
        """Do the slow part of planning, the present strategy restated for the round included.

        ``blocked``: the robot cannot go on as it would, so that its mates count as obstacles.
        """

    def key(self, strategy: Any) -> Hashable:
        """Return a hashable name of a strategy, unique within a round."""

    def impact(self, belief: Any, strategy: Any) -> Any:
        """Return what a strategy would achieve."""

    def reply(self, belief: Any, others: Any, current: Any) -> Any:
        """Return the best strategy against the rest of the team; ``current`` itself if none beats it."""

    def nothing(self, belief: Any) -> Any:
        """Return the identity of ``*``."""

    def combine(self, a: Any, b: Any) -> Any:
        """Return ``a * b``."""

    def value(self, belief: Any, impact: Any) -> float:
        """Return ``psi(impact)``."""

    def slack(self, belief: Any, base: Any) -> float:
        """Return the most that a strategy of this robot adds to ``base``."""

    def goal(self) -> tuple[float, float] | None:
        """Return where the present strategy wants the robot next [m], team frame; None: nowhere."""

    def served(self) -> bool:
        """Tell whether the present goal has lost its point."""

    def reached(self, pose: Pose, mates: Sequence[Mate], now: float) -> None:
        """Note that the robot is at its goal, and go on to the next one of the strategy."""

    def release(self, now: float) -> None:
        """Give up the present strategy: the robot cannot carry it out."""

    def postponed(self, now: float) -> bool:
        """Tell whether something worth doing was put off for a while: the mission is not over then."""

    def route(
        self, pose: Pose, goal: tuple[float, float], mates: Sequence[Mate], blocked: bool, now: float
    ) -> Route | None:
        """Return a way to a goal on the newest map, or None."""

"""What passes between a body and its robot's ROS: plain values one way, orders the other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, TypeAlias

from vedette.ros2.goals import Place
from vedette.ros2.scans import LaserSweep
from vedette.ros2.transforms import Matrix


@dataclass(frozen=True, eq=False)
class Joint:
    """``T_parent_child`` as TF tells it."""

    parent: str
    child: str
    stamp: float  # [s]
    T: Matrix
    fixed: bool = False  # from /tf_static


@dataclass(frozen=True)
class Deviation:
    """How sure the robot's localiser is."""

    place: float = 0.0  # standard deviation of x and of y [m]
    heading: float = 0.0  # [rad]


@dataclass(frozen=True)
class Answer:
    """Whether the navigator takes a goal up."""

    goal: int
    accepted: bool


@dataclass(frozen=True)
class GoalStatus:
    """How a goal of ours stands; ``action_msgs/GoalStatus``."""

    goal: int
    status: int


@dataclass(frozen=True)
class NavigatorGone:
    """There is no navigator now."""


Told: TypeAlias = Joint | LaserSweep | Deviation | Answer | GoalStatus | NavigatorGone


class Door(Protocol):
    """A robot's ROS; all from one thread."""

    def take(self) -> Sequence[Told]:
        """Return what has been told since the last call, in order."""

    @property
    def time(self) -> float | None:
        """What ``/clock`` shows [s]; None: nothing yet."""

    def ask(self, goal: int, place: Place) -> None:
        """Send the navigator a goal; ``place``: x, y [m], heading [rad], map frame."""

    def cancel(self, goal: int) -> None:
        """Cancel a goal, whether it was taken up or not."""

    def close(self) -> None:
        """Leave; what was ordered is sent before."""

"""What passes between a body and its robot's ROS: plain values one way, orders the other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

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


@dataclass(frozen=True, eq=False)
class Grid:
    """``nav_msgs/OccupancyGrid``: the robot's own map as it is now."""

    frame: str
    resolution: float  # [m]
    T: Matrix  # T_frame_corner of its first cell
    occupancy: NDArray[np.int8]  # (R, C) 0 to 100 %, -1 unknown


@dataclass(frozen=True, eq=False)
class Patch:
    """``map_msgs/OccupancyGridUpdate``: cells of the robot's own map that are other ones now."""

    row: int  # of its first cell
    col: int
    occupancy: NDArray[np.int8]  # (R, C) as above


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
class Reason:
    """Why the navigator gave a goal up, in words; it may never come."""

    goal: int
    said: str


@dataclass(frozen=True)
class NavigatorGone:
    """There is no navigator now."""


class Word(StrEnum):
    """What somebody beside the robot may tell it, by a service; ``std_srvs/Trigger``."""

    PAUSE = "pause"  # stand where it is
    RESUME = "resume"  # work again
    RECALL = "recall"  # go back to where it began, and stand there
    STOP = "stop"  # stand, and end the agent: the team goes on without it


@dataclass(frozen=True)
class Notice:
    """A message for those who use the robot's ROS."""

    topic: str
    kind: str  # its type
    cdr: bytes


Told: TypeAlias = (
    Joint | LaserSweep | Grid | Patch | Deviation | Answer | GoalStatus | Reason | NavigatorGone | Word
)


class Door(Protocol):
    """A robot's ROS; all from one thread."""

    def take(self) -> Sequence[Told]:
        """Return what has been told since the last call, in order."""

    @property
    def time(self) -> float | None:
        """What ``/clock`` shows [s]; None: nothing yet."""

    @property
    def navigator(self) -> bool:
        """Whether there is one."""

    def ask(self, goal: int, place: Place, frame: str) -> None:
        """Send the navigator a goal; ``place``: x, y [m], heading [rad], in a frame of the robot's."""

    def cancel(self, goal: int) -> None:
        """Cancel a goal, whether it was taken up or not."""

    def show(self, notice: Notice) -> None:
        """Publish a message."""

    def close(self) -> None:
        """Leave; what was ordered is sent before."""

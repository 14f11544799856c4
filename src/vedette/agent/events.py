"""What an agent is told; whoever runs it delivers these in order of time."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Message:
    """Bytes from a neighbour on the tree."""

    sender: int
    payload: bytes


@dataclass(frozen=True)
class Pose:
    """Where the robot takes itself to be; at least ten times a second: it keeps the agent's time going."""

    x: float  # [m], team frame
    y: float
    heading: float  # [rad]
    slowed: float = 0.0  # time without progress on its way [s]
    deviation: float = 0.0  # standard deviation of x and of y, as a localiser's covariance has it [m]
    heading_deviation: float = 0.0  # [rad]
    at_work: bool = True  # False: somebody beside the robot keeps it from what its agent wants


@dataclass(frozen=True, eq=False)
class Scan:
    """One sweep of the lidar, taken at the latest pose."""

    angles: NDArray[np.float64]  # (B,) [rad], team frame
    ranges: NDArray[np.float64]  # (B,) [m]; inf where nothing is, nan where the beam says nothing
    offset: tuple[float, float] = (0.0, 0.0)  # of the lidar from the pose [m], team frame
    age: float = 0.0  # how long ago it was taken [s]
    mapped: bool = False  # by the robot itself, whose map is the evidence: it is none

    @property
    def unread(self) -> Scan:
        """The same, telling no more than where the robot has looked."""
        return replace(self, ranges=np.full(len(self.ranges), np.nan))


@dataclass(frozen=True, eq=False)
class Sensed:
    """What any other sensor saw, in the terms of the mission."""

    data: object
    time: float  # [s]


@dataclass(frozen=True)
class Arrived:
    """The robot is at the end of the path it was given."""


@dataclass(frozen=True)
class Stuck:
    """The robot has made no progress for a while, though it should."""


@dataclass(frozen=True)
class JobDone:
    """A job has run."""

    key: tuple[int, int]


@dataclass(frozen=True)
class Ordered:
    """The operator has told this robot an order, as bytes."""

    order: bytes


@dataclass(frozen=True)
class TreeChanged:
    """The team's tree is another one now; messages of older epochs are void."""

    epoch: int
    parent: int | None  # None at the root
    neighbours: tuple[int, ...]
    size: int  # robots on the tree
    distance: int = 0  # to the root, in links or more


@dataclass(frozen=True)
class CertificatesRevoked:
    """Whose certificates count no more, by a list that the team's authority has signed."""

    robots: frozenset[int]


Event: TypeAlias = (
    Message | Pose | Scan | Sensed | Arrived | Stuck | JobDone | TreeChanged | CertificatesRevoked | Ordered
)

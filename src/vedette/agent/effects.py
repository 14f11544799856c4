"""What an agent asks for; whoever runs it carries these out in order."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from math import inf
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from vedette.agent.flight import AnyPlan
from vedette.maps import GridFrame


class TrafficKind(Enum):
    """What a message is for; traffic is counted by kind."""

    NEGOTIATION = "negotiation"
    FUSION = "fusion"
    BEACONS = "beacons"
    OVERLAY = "overlay"  # hellos, acknowledgements, and what was sent again


@dataclass(frozen=True)
class Send:
    """Send bytes to a neighbour on the tree."""

    to: int
    traffic: TrafficKind
    payload: bytes


@dataclass(frozen=True)
class Shun:
    """Do without the link to a neighbour for a while: no round gets anywhere over it."""

    robot: int


@dataclass(frozen=True, eq=False)
class Route:
    """A way to drive, and the map it was found on."""

    path: NDArray[np.float64]  # (L, 2) [m], team frame
    passable: NDArray[np.bool_]  # (R, C) where the robot's centre may be; nowhere else
    frame: GridFrame  # of these cells
    room: float = inf  # that it keeps to what is not known free, at least [m]
    facing: float | None = None  # heading to turn to at its end [rad], team frame


@dataclass(frozen=True, eq=False)
class Drive:
    """Follow a route; None: stand still."""

    route: Route | None


@dataclass(frozen=True, eq=False)
class Fly:
    """Fly a plan from its start on, and until then what was planned before; circle when it is over.

    The circle is a turn at the vehicle's greatest rate, counter-clockwise (``flight.Itinerary``); what may
    stand, stands.
    """

    plan: AnyPlan


@dataclass(frozen=True, eq=False)
class Job:
    """Heavy computing, to run outside ``step``; ``JobDone(key)`` comes back when it has."""

    key: tuple[int, int]
    run: Callable[[], None]
    beside: bool = False  # works on nothing of the agent's, which goes on meanwhile


Motion: TypeAlias = Drive | Fly
Effect: TypeAlias = Send | Shun | Motion | Job

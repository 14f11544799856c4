"""Snapshots of a mission, and who takes them while it goes on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, TypeAlias, TypeVar

import numpy as np
from numpy.typing import NDArray

Floats: TypeAlias = NDArray[np.float64]
DEAD, LEFT = "dead", "left"  # states of robots that are no longer of the team


@dataclass(frozen=True, kw_only=True)
class MissionScene:
    """What stays the same all through a mission."""

    name: str
    vehicles: tuple[str, ...]  # the team's names, in its order


@dataclass(frozen=True, eq=False)
class VehicleSample:
    """One robot or vehicle at one moment."""

    x: float  # [m], team frame
    y: float
    heading: float  # [rad]
    state: str  # the agent's word for what it does; DEAD: it was lost, LEFT: it said goodbye
    alive: bool  # neither
    path: Floats  # (k, 2) where its present plan takes it [m], team frame; k may be 0

    @property
    def left(self) -> bool:
        """It said goodbye and is no longer of the team."""
        return not self.alive and self.state == LEFT

    @property
    def fate(self) -> str:
        """What became of it: ``lost``, ``left``, or nothing while it takes part."""
        return "" if self.alive else "left" if self.left else "lost"


class Timed(Protocol):
    """A moment of a mission."""

    @property
    def t(self) -> float:
        """Simulated time [s]."""


TakenT = TypeVar("TakenT", contravariant=True)


class Sink(Protocol[TakenT]):
    """An output that follows the mission while it runs."""

    def update(self, snapshot: TakenT) -> None:
        """Take the next snapshot; its arrays may change after the call."""


def evenly(available: int, wanted: int) -> list[int]:
    """Return at most ``wanted`` indices of ``available``, the first and the last included."""
    return [int(i) for i in np.unique(np.linspace(0, available - 1, min(available, wanted)).round())]

"""The physical side of a simulation: what bodies do, and what their sensors tell."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from vedette.agent.effects import Motion
from vedette.agent.events import Event
from vedette.outcome import Outcome


class Field(Protocol):
    """Robots by index in their true world. Whoever runs it calls ``advance`` in even ticks."""

    @property
    def alive(self) -> NDArray[np.bool_]:
        """``(n,)``."""

    def pose(self, i: int) -> tuple[float, float, float]:
        """Return x, y [m] and heading [rad] of a robot, team frame."""

    def sense(self, i: int, now: float) -> list[Event]:
        """Return what a living robot is told at a tick: its ``Pose`` first, then what its sensors saw."""

    def carry_out(self, i: int, motion: Motion, now: float) -> None:
        """Let a robot move as its agent wants; comes at any time, between ticks too."""

    def advance(self, now: float, dt: float) -> None:
        """Move everybody through the tick of ``dt`` that ends now [s]."""

    def kill(self, i: int) -> None:
        """Stop a robot where it is."""

    def revive(self, i: int, now: float) -> None:
        """Let a robot go on from where it stands, without a plan."""

    def over(self, now: float) -> Outcome | None:
        """Return how the mission ends now, for reasons that lie in the world; None: it goes on."""

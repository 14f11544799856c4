"""A body: the one thing between an agent and its robot, simulated or real."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from vedette.agent.effects import Motion
from vedette.agent.events import Event

TICK = 0.1  # of poses, at most; simulated bodies move in such steps [s]


class Hull(Protocol):
    """What team-mates are told of a robot's body."""

    @property
    def radius(self) -> float:
        """Of the disc that it fills [m]."""

    @property
    def speed(self) -> float:
        """At most [m/s]."""


@dataclass(frozen=True)
class BodyFigures:
    """What a body has counted up to now."""

    travelled: float = 0.0  # way driven or flown [m]
    collisions: int = 0  # steps in which a contact stopped it
    min_clearance: float | None = None  # from its edge to a wall or to a robot, so far [m]; None: not known
    pose_error: float | None = None  # farthest from where it was that it took itself to be [m]


class Body(Protocol):
    """One robot, as whoever runs its agent knows it. Times are the mission's [s], poses in the team frame.

    ``sense`` is called every ``TICK``, the rest at any time; all from one thread.
    """

    @property
    def hull(self) -> Hull:
        """Its disc and its speed."""

    @property
    def pose(self) -> tuple[float, float, float]:
        """Where it is: x, y [m], heading [rad]; of a real robot, where it takes itself to be."""

    @property
    def figures(self) -> BodyFigures:
        """What it has counted."""

    def sense(self, now: float) -> list[Event]:
        """Return what it has sensed since the last call, its ``Pose`` first."""

    def carry_out(self, motion: Motion, now: float) -> None:
        """Drive, or fly, as the agent wants it to from now on."""

    def stop(self, now: float) -> None:
        """Stand, whatever it was told: nobody runs its agent any more."""


class Shown(Protocol):
    """A body that others must see though it is not in their world: each process simulates its own."""

    def show(self, now: float) -> bytes:
        """Return where it is, for the others; ``now`` by the process's clock [s], as below."""

    def see(self, robot: int, shown: bytes, now: float) -> None:
        """Take another body to be where it shows itself, for a while; ValueError if malformed."""

"""A body that is somebody's own class, checked at the door: what it does wrong is told in one line."""

from __future__ import annotations

from contextlib import AbstractContextManager
from dataclasses import dataclass
from math import isfinite

import numpy as np

from vedette.agent.body import Body, BodyFigures
from vedette.agent.effects import Motion
from vedette.agent.events import Arrived, Event, Pose, Scan, Sensed, Stuck
from vedette.parts import telling
from vedette.team import PlatformSpec

FARTHEST = 2.1e7  # from the team frame's origin, of a pose [m]


@dataclass(frozen=True)
class CheckedBody:
    """``vedette.agent.body.Body``; raises InputError where its class raises, or says what cannot be."""

    make: str  # module:NAME of the class
    body: Body
    hull: PlatformSpec  # the file's

    @property
    def pose(self) -> tuple[float, float, float]:
        """Where it takes itself to be."""
        with self._telling("pose"):
            x, y, heading = self.body.pose
            _check_pose(Pose(x, y, heading))
        return x, y, heading

    @property
    def figures(self) -> BodyFigures:
        """What it has counted."""
        with self._telling("figures"):
            figures = self.body.figures
            if not isinstance(figures, BodyFigures):
                raise ValueError(f"is {type(figures).__name__}; give a BodyFigures")
        return figures

    def sense(self, now: float) -> list[Event]:
        """Return what it has sensed since the last call."""
        with self._telling("sense"):
            events = self.body.sense(now)
            for event in events:
                _check(event)
        return events

    def carry_out(self, motion: Motion, now: float) -> None:
        """Let it drive, or stand."""
        with self._telling("carry_out"):
            self.body.carry_out(motion, now)

    def stop(self, now: float) -> None:
        """Let it stand."""
        with self._telling("stop"):
            self.body.stop(now)

    def _telling(self, what: str) -> AbstractContextManager[None]:
        return telling(f"body.own: {what} of {self.make}")


def _check(event: Event) -> None:
    """Raise ValueError for what no body can sense."""
    match event:
        case Pose():
            _check_pose(event)
        case Scan():
            angles, ranges = np.asarray(event.angles), np.asarray(event.ranges)
            if angles.ndim != 1 or angles.shape != ranges.shape:
                raise ValueError(
                    f"a Scan has angles {angles.shape} and ranges {ranges.shape}; give (B,) of both"
                )
            if not np.isfinite(angles).all() or not np.isfinite(event.offset).all() or (ranges < 0.0).any():
                raise ValueError("a Scan has an angle or offset that is not finite, or a range below 0")
        case Arrived() | Stuck() | Sensed():
            pass
        case _:
            raise ValueError(
                f"{type(event).__name__} is nothing that a body senses; see docs/how-to/own-body.md"
            )


def _check_pose(pose: Pose) -> None:
    at = pose.x, pose.y, pose.heading, pose.deviation, pose.heading_deviation
    if not all(map(isfinite, at)) or max(abs(pose.x), abs(pose.y)) > FARTHEST:
        raise ValueError(f"a Pose is at {pose.x}, {pose.y}, {pose.heading}; give finite m and rad")

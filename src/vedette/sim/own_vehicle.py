"""One vehicle's simulated body; other processes simulate the others, which it neither sees nor meets."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vedette.agent.body import TICK, BodyFigures, Hull
from vedette.agent.effects import Motion
from vedette.agent.events import Event
from vedette.sim.vehicles import Vehicles


@dataclass
class OwnVehicle:
    """Flies one of a team's vehicles, whose clock may begin late; ``vedette.agent.body.Body``."""

    hull: Hull
    robot: int
    vehicles: Vehicles  # of which the others stand still, and see nothing
    started: bool = False

    def __post_init__(self) -> None:
        for other in np.flatnonzero(self.vehicles.alive).tolist():
            if other != self.robot:
                self.vehicles.kill(other)

    def put(self, pose: Sequence[float]) -> None:
        """Put it at x, y [m], heading [rad], team frame, before it has begun."""
        self.vehicles.poses[self.robot] = pose

    @property
    def pose(self) -> tuple[float, float, float]:
        """Where it is in truth."""
        return self.vehicles.pose(self.robot)

    @property
    def figures(self) -> BodyFigures:
        """Its way; vehicles touch nothing."""
        return BodyFigures(float(self.vehicles.travelled[self.robot]))

    def sense(self, now: float) -> list[Event]:
        """Fly on to now, and return what it is told; the first time, begin to fly."""
        if not self.started and now > TICK:  # late: it has stood until now
            self.vehicles.revive(self.robot, now - TICK)
        self.started = True
        self.vehicles.advance(now, TICK)
        return self.vehicles.sense(self.robot, now)

    def carry_out(self, motion: Motion, now: float) -> None:
        """Fly a plan from its start on."""
        self.vehicles.carry_out(self.robot, motion, now)

    def stop(self, now: float) -> None:
        """Fly no further."""
        self.vehicles.kill(self.robot)

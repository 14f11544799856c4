"""One robot's simulated body in a world that other processes simulate other bodies in."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vedette.agent.effects import Motion
from vedette.agent.events import Event
from vedette.maps.world import World
from vedette.sim.robots import Robots
from vedette.team import PlatformSpec

ELSEWHERE = 1e6  # where bodies are that nobody tells of, out of everybody's sight [m]


@dataclass(frozen=True)
class Seen:
    """Another body, as its process tells of it."""

    x: float  # [m], team frame
    y: float
    heading: float  # [rad]
    vx: float  # [m/s], team frame
    vy: float
    radius: float  # [m]


class OwnBody:
    """A disc robot with a lidar that feels and scans the bodies it is told of, and moves no other."""

    def __init__(
        self,
        world: World,
        spec: PlatformSpec,
        start: Sequence[float],
        robot: int,
        robots: int,
        rng: np.random.Generator,
    ) -> None:
        """Put robot ``robot`` of at most ``robots`` at its start: x, y [m], heading [rad], team frame."""
        starts = np.full((robots, 3), ELSEWHERE)
        starts[robot] = start
        self.robot = robot
        self._corner = np.array((world.frame.origin_x, world.frame.origin_y))
        self._robots = Robots(world, [spec] * robots, starts, [rng] * robots)
        self._bodies = self._robots.bodies
        self._bodies.alive[np.arange(robots) != robot] = False

    def sense(self, now: float) -> list[Event]:
        """Return what the robot is told at a tick: its pose first."""
        return self._robots.sense(self.robot, now)

    def carry_out(self, motion: Motion, now: float) -> None:
        """Follow a route, or stand."""
        self._robots.carry_out(self.robot, motion, now)

    def advance(self, now: float, dt: float) -> None:
        """Move for the tick of ``dt`` that ends now [s]."""
        self._robots.advance(now, dt)

    def see(self, robot: int, seen: Seen | None) -> None:
        """Put another robot's body where it is said to be; None: away. Strangers and nonsense are not put."""
        if robot == self.robot or not 0 <= robot < len(self._bodies.specs):
            return
        if seen is None:
            self._bodies.poses[robot] = ELSEWHERE
            return
        self._bodies.poses[robot] = (*(np.array((seen.x, seen.y)) - self._corner), seen.heading)
        self._bodies.velocities[robot] = seen.vx, seen.vy
        self._bodies.radii[robot] = seen.radius

    @property
    def shown(self) -> Seen:
        """This body, for the others."""
        x, y, heading = self._robots.pose(self.robot)
        vx, vy = self._bodies.velocities[self.robot].tolist()
        return Seen(x, y, heading, vx, vy, self._bodies.specs[self.robot].radius)

    @property
    def travelled(self) -> float:
        """Way driven so far [m]."""
        return float(self._bodies.travelled[self.robot])

    @property
    def collisions(self) -> int:
        """Steps in which a contact stopped it."""
        return int(self._bodies.collisions[self.robot])

    @property
    def min_clearance(self) -> float:
        """From its edge to a wall or another robot, so far [m]."""
        return float(self._bodies.min_clearance[self.robot])

    @property
    def pose(self) -> NDArray[np.float64]:
        """``(3,)`` x, y [m], heading [rad], team frame."""
        return np.array(self._robots.pose(self.robot))

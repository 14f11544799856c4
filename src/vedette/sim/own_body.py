"""One robot's simulated body in a world that other processes simulate other bodies in."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from vedette.agent.body import TICK, BodyFigures
from vedette.agent.effects import Drive, Motion
from vedette.agent.events import Event
from vedette.align import FramePose
from vedette.maps.world import World
from vedette.sim.framed import FramedRobots
from vedette.sim.robots import Robots
from vedette.sim.shown import ShownBody, decode, encode
from vedette.team import PlatformSpec

ELSEWHERE = 1e6  # where bodies are that nobody tells of, out of everybody's sight [m]
UNSEEN = 2.0  # a body not told of for so long is taken away [s]


@dataclass
class OwnBody:
    """A disc robot with a lidar that feels and scans the bodies it is told of, and moves no other.

    ``vedette.agent.body.Body`` and ``Shown``.
    """

    hull: PlatformSpec
    robot: int
    _robots: Robots
    _seen: dict[int, float] = field(default_factory=dict)  # when each other body was last told of [s]

    @classmethod
    def put(
        cls,
        world: World,
        spec: PlatformSpec,
        start: Sequence[float],
        robot: int,
        robots: int,
        rng: np.random.Generator,
        frame: FramePose | None = None,
    ) -> OwnBody:
        """Put robot ``robot`` of at most ``robots`` at its start: x, y [m], heading [rad], the world's frame.

        ``frame``: where the one lies that it reckons in (T_world_own); None: it reckons in the world's.
        """
        starts = np.full((robots, 3), ELSEWHERE)
        starts[robot] = start
        team = world, [spec] * robots, starts, [rng] * robots
        body = cls(spec, robot, Robots(*team) if frame is None else FramedRobots(*team, [frame] * robots))
        body._robots.bodies.alive[np.arange(robots) != robot] = False
        return body

    @property
    def pose(self) -> tuple[float, float, float]:
        """Where it is in truth, in the frame that it reckons in."""
        if isinstance(self._robots, FramedRobots):
            own = self._robots.frames[self.robot].inverse().after(FramePose(*self._in_world))
            return own.x, own.y, own.angle
        return self._in_world

    @property
    def _in_world(self) -> tuple[float, float, float]:
        return self._robots.pose(self.robot)

    @property
    def figures(self) -> BodyFigures:
        """What it has counted."""
        bodies, i = self._robots.bodies, self.robot
        return BodyFigures(
            float(bodies.travelled[i]),
            int(bodies.collisions[i]),
            float(bodies.min_clearance[i]),
            float(self._robots.pose_errors[i]),
        )

    def sense(self, now: float) -> list[Event]:
        """Move for the tick that ends now, and return what the robot is told."""
        self._robots.advance(now, TICK)
        return self._robots.sense(self.robot, now)

    def carry_out(self, motion: Motion, now: float) -> None:
        """Follow a route, or stand."""
        self._robots.carry_out(self.robot, motion, now)

    def stop(self, now: float) -> None:
        """Stand."""
        self.carry_out(Drive(None), now)

    # -- among other processes' bodies -----------------------------------------------------------------

    def show(self, now: float) -> bytes:
        """Return where it is, and take bodies away that have not been shown for long."""
        for robot in [k for k, when in self._seen.items() if now > when + UNSEEN]:
            self._take_away(robot)
        return encode(self._shown)

    def see(self, robot: int, shown: bytes, now: float) -> None:
        """Put another robot's body where it shows itself; strangers are not put, nor who is in one place."""
        body = decode(shown)
        bodies = self._robots.bodies
        if robot == self.robot or not 0 <= robot < len(bodies.specs):
            return
        if body.inside(self._shown):
            self._take_away(robot)
            return
        self._seen[robot] = now
        corner = self._robots.corner
        bodies.poses[robot] = (*(np.array((body.x, body.y)) - corner), body.heading)
        bodies.velocities[robot] = body.vx, body.vy
        bodies.radii[robot] = body.radius

    def _take_away(self, robot: int) -> None:
        self._seen.pop(robot, None)
        self._robots.bodies.poses[robot] = ELSEWHERE

    @property
    def _shown(self) -> ShownBody:
        x, y, heading = self._in_world
        vx, vy = self._robots.bodies.velocities[self.robot].tolist()
        return ShownBody(x, y, heading, vx, vy, self.hull.radius)

"""Simulated robots on the ground: bodies that drive, and lidars that scan a building and each other."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vedette.agent.effects import Drive, Motion, Route
from vedette.agent.events import Arrived, Event, Pose, Scan, Sensed, Stuck
from vedette.kernels.lidar import cast_rays
from vedette.kernels.motion import remaining
from vedette.maps import GridFrame
from vedette.maps.world import World
from vedette.outcome import NO_PROGRESS, Outcome
from vedette.sensor import CheckedSensor
from vedette.sim.body import Bodies
from vedette.sim.localisation import Localisation
from vedette.sim.odometry import seen_from
from vedette.sim.slam import Slam
from vedette.team import PlatformSpec

STUCK_AFTER = 4.0  # without progress [s]
ASIDE = np.array((0.05, 0.05, np.radians(1.0)))  # who errs otherwise by so much steers anew [m, m, rad]


class Robots:
    """Disc robots with lidars in a world; ``vedette.sim.field.Field``."""

    def __init__(
        self,
        world: World,
        specs: Sequence[PlatformSpec],
        starts: NDArray[np.float64],
        noise: Sequence[np.random.Generator],
    ) -> None:
        """Put the team at its starts, (n, 3) x, y, heading [m, m, rad], and give each lidar its noise."""
        n = len(specs)
        self._world, self._specs, self._noise = world, specs, noise
        self.corner = np.array((world.frame.origin_x, world.frame.origin_y))
        local = starts.copy()
        local[:, :2] -= self.corner
        self.bodies = Bodies(world.solid, world.frame.resolution, specs, local)
        self._beams = [
            np.radians(spec.view) * ((np.arange(spec.beams) + 0.5) / spec.beams - 0.5) for spec in specs
        ]
        self._sensors = [CheckedSensor.of(spec) for spec in specs]
        self._localisers = [Localisation.of(spec, rng) for spec, rng in zip(specs, noise, strict=False)]
        self._slams = [
            Slam(world.frame, spec, start.copy(), rng.spawn(1)[0]) if spec.drift else None
            for spec, start, rng in zip(specs, starts, noise, strict=False)
        ]
        self._wanted: list[Route | None] = [None] * n
        self._aside = np.zeros((n, 3))  # errors of where each took itself to be, as it set out [m, m, rad]
        self.pose_errors = np.zeros(n)  # farthest that each took itself to be from where it was [m]
        self._next_scan = [0.0] * n
        self._stuck_told = [0.0] * n
        self._told_arrival = [True] * n
        self._last_change = 0.0

    @property
    def alive(self) -> NDArray[np.bool_]:
        """``(n,)``."""
        return self.bodies.alive

    def pose(self, i: int) -> tuple[float, float, float]:
        """Return x, y [m] and heading [rad] of a robot, team frame."""
        x, y, heading = self.bodies.poses[i].tolist()
        return x + float(self.corner[0]), y + float(self.corner[1]), heading

    def sense(self, i: int, now: float) -> list[Event]:
        """Return pose, scan, and whether the robot has arrived or is stuck."""
        slowed = self.bodies.stuck_for(i)
        pose = self._told(i, slowed)
        events: list[Event] = [pose]
        arrived = not self._told_arrival[i] and self.bodies.arrived(i)
        if now >= self._next_scan[i] - 1e-9 or (arrived and self._slams[i] is not None):
            self._next_scan[i] += 1.0 / self._specs[i].rate
            events += self._seen(i, pose, now, arrived)
        if arrived:
            self._told_arrival[i] = True
            events.append(Arrived())
        elif slowed < STUCK_AFTER:
            self._stuck_told[i] = 0.0
        elif slowed - self._stuck_told[i] >= STUCK_AFTER:
            self._stuck_told[i] = slowed
            events.append(Stuck())
        return events

    def _told(self, i: int, slowed: float) -> Pose:
        """Return where the robot takes itself to be."""
        x, y, heading = self.pose(i)
        dx, dy, turn = self._error(i)
        self.pose_errors[i] = max(self.pose_errors[i], math.hypot(dx, dy))
        localiser = self._localisers[i]
        if localiser is None:
            return Pose(x + dx, y + dy, heading + turn, slowed)
        deviation, _, heading_deviation = localiser.deviation.tolist()
        return Pose(x + dx, y + dy, heading + turn, slowed, deviation, heading_deviation)

    def _error(self, i: int) -> tuple[float, float, float]:
        """Return how far the robot takes itself to be from where it is [m, m, rad]."""
        localiser, slam = self._localisers[i], self._slams[i]
        if slam is not None:
            x, y, turn = (slam.place - self.pose(i)).tolist()
            return x, y, turn
        if localiser is not None:
            x, y, turn = localiser.error.tolist()
            return x, y, turn
        return 0.0, 0.0, 0.0

    def _seen(self, i: int, pose: Pose, now: float, arrived: bool) -> list[Event]:
        """Return a scan; of a robot with a SLAM its map, too, if there is a new one."""
        scan, slam = self._scan(i, pose.heading), self._slams[i]
        if slam is None:
            return [scan]
        own_map = slam.look(scan, now, arrived)
        looked = replace(scan, mapped=True)
        return [looked] if own_map is None else [looked, Sensed(own_map, now)]

    def _scan(self, i: int, told_heading: float) -> Scan:
        spec = self._specs[i]
        discs = np.column_stack((self.bodies.poses[:, :2], self.bodies.radii))[
            np.arange(len(self._specs)) != i
        ]
        local = self.bodies.poses[i]

        def cast(angles: NDArray[np.float64]) -> NDArray[np.float64]:
            return cast_rays(
                self._world.solid,
                self._world.frame.resolution,
                local[0],
                local[1],
                local[2] + angles,
                spec.range,
                discs,
            )

        sensor = self._sensors[i]
        if sensor is not None:
            angles, told = sensor.scan(cast, self._noise[i])
            return Scan(told_heading + angles, told)
        ranges = cast(self._beams[i])
        noise = self._noise[i].normal(0.0, spec.range_noise, spec.beams)
        return Scan(told_heading + self._beams[i], np.maximum(ranges + noise, 0.0))

    def carry_out(self, i: int, motion: Motion, now: float) -> None:
        """Let a robot follow a route, or stand.

        It follows by the pose that it is told as the command comes, and from there by its wheels: route and
        map lie as far beside the truth as it takes itself to be.
        """
        assert isinstance(motion, Drive), "robots on the ground do not fly"
        self._told_arrival[i] = motion.route is None
        self._wanted[i] = motion.route
        if motion.route is None:
            self.bodies.command(i, None)
            return
        self._follow(i, motion.route, motion.route.path)
        self._last_change = now

    def _follow(self, i: int, route: Route, path: NDArray[np.float64]) -> None:
        """Let a robot follow a path of a route, as it takes itself to lie now."""
        east, north, turn = self._error(i)
        self._aside[i] = east, north, turn
        if self._slams[i] is not None:  # its map is turned as it is
            here = np.array(self.pose(i))
            told = np.append(path - (here + self._aside[i])[:2], np.zeros((len(path), 1)), axis=1)
            path = here[:2] + seen_from(np.array((0.0, 0.0, turn)), told)[:, :2]
        else:
            path = path - (east, north)
        facing = None if route.facing is None else route.facing - turn
        first = self._first(route.frame, east, north)
        self.bodies.command(i, path - self.corner, route.passable, first, route.room, facing)

    def _first(self, frame: GridFrame, east: float, north: float) -> tuple[int, int]:
        """Return where a grid begins among the world's cells, for a robot that lies so far beside it [m]."""
        side, corner = self._world.frame.resolution, self.corner
        row, col = round((frame.origin_y - corner[1]) / side), round((frame.origin_x - corner[0]) / side)
        return row - round(north / side), col - round(east / side)

    def advance(self, now: float, dt: float) -> None:
        """Move everybody for a tick."""
        self.bodies.step(dt)
        for localiser in self._localisers:
            if localiser is not None:
                localiser.advance(dt)
        for i, slam in enumerate(self._slams):
            if slam is not None and self.bodies.alive[i]:
                slam.advance(np.array(self.pose(i)))
                self._correct(i, slam)

    def _correct(self, i: int, slam: Slam) -> None:
        """Let a robot that has come to take itself elsewhere steer by that."""
        route, error = self._wanted[i], np.array(self._error(i))
        gap = np.abs(error - self._aside[i])
        if route is not None and (gap > ASIDE).any():
            x, y, _ = slam.place.tolist()
            self._follow(i, route, remaining(route.path, x, y, math.inf))

    def kill(self, i: int) -> None:
        """Stop a robot; its body stays as an obstacle."""
        self.bodies.kill(i)

    def revive(self, i: int, now: float) -> None:
        """Let a robot go on from where it stands."""
        self.bodies.alive[i] = True
        self._told_arrival[i] = True

    def over(self, now: float) -> Outcome | None:
        """Give up when no robot has got a new route for long."""
        return Outcome.NO_PROGRESS if now > self._last_change + NO_PROGRESS else None

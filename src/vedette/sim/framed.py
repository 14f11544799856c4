"""Simulated robots that reckon each in a frame of its own, as its SLAM would."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vedette.agent.effects import Drive, Motion, Route
from vedette.agent.events import Event, Pose, Scan, Sensed
from vedette.agent.orders import Order, OrderT, moved
from vedette.align import FramePose
from vedette.align.turned import turned
from vedette.maps.transform import Transform
from vedette.maps.world import World
from vedette.missions.explore.own_map import OwnMap
from vedette.sim.robots import Robots
from vedette.team import PlatformSpec

AWAY = 20.0  # a frame's origin lies so far from the world's at most, along either axis [m]


def frames_of(robots: int, seed: int) -> list[FramePose]:
    """Return where each robot's frame lies in the world: ``T_world_own``, anywhere and turned by anything."""
    rng = np.random.default_rng([seed, 19])
    return [
        FramePose.of(*map(float, rng.uniform((-AWAY, -AWAY, -math.pi), (AWAY, AWAY, math.pi))))
        for _ in range(robots)
    ]


def as_told(order: Order, frames: Sequence[FramePose]) -> Order:
    """Return an order of the world with its place in the frame of a robot; ``frames``: T_world_own."""
    of = order.in_frame_of
    return order if of is None else moved(order, _transform(frames[of].inverse()))


def as_meant(order: OrderT, frames: Sequence[FramePose]) -> OrderT:
    """Return an order that robots hold with its place in the world; one of a frame of nobody's as it is."""
    of = order.in_frame_of
    return order if of is None or of >= len(frames) else moved(order, _transform(frames[of]))


def _transform(pose: FramePose) -> Transform:
    return Transform.of(pose.x, pose.y, pose.angle)


class FramedRobots(Robots):
    """Robots that are told, and tell, all in frames of their own; ``pose`` alone is of the world."""

    def __init__(
        self,
        world: World,
        specs: Sequence[PlatformSpec],
        starts: NDArray[np.float64],
        noise: Sequence[np.random.Generator],
        frames: Sequence[FramePose],
    ) -> None:
        super().__init__(world, specs, starts, noise)
        self.frames = list(frames)  # T_world_own

    def sense(self, i: int, now: float) -> list[Event]:
        """Return what a robot senses, in its own frame."""
        return [self._in_own(i, event) for event in super().sense(i, now)]

    def _in_own(self, i: int, event: Event) -> Event:
        back = self.frames[i].inverse()
        match event:
            case Pose():
                own = back.after(FramePose.of(event.x, event.y, event.heading))
                return replace(event, x=own.x, y=own.y, heading=own.angle)
            case Sensed(OwnMap() as own_map):
                corner = back.after(FramePose.of(own_map.x, own_map.y, own_map.heading))
                lies = replace(own_map, x=corner.x, y=corner.y, heading=corner.angle)
                return replace(event, data=lies)
            case Scan():
                (offset,) = np.array([event.offset]) @ back.rotation.T
                return replace(event, angles=event.angles + back.angle, offset=tuple(offset.tolist()))
        return event

    def carry_out(self, i: int, motion: Motion, now: float) -> None:
        """Let a robot follow a route of its own frame, or stand."""
        if isinstance(motion, Drive) and motion.route is not None:
            motion = Drive(self._in_world(i, motion.route))
        super().carry_out(i, motion, now)

    def _in_world(self, i: int, route: Route) -> Route:
        """Return a route as it lies in the world, each of whose cells is as passable as what is under it."""
        there, frame = self.frames[i], self._world.frame
        back = there.inverse()
        facing = None if route.facing is None else route.facing + there.angle
        passable = turned(route.passable, route.frame, back, frame)
        return replace(route, path=there.places(route.path), passable=passable, frame=frame, facing=facing)

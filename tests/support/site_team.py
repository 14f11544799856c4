"""Whole agents on the toy mission of sites: points that move in straight lines, over any graph of links."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tests.support.faulty_world import FRAME, NEAR, SPEED, Published, SiteMission, Sites
from tests.support.overlay_network import Edge
from vedette.agent import Agent, GroundBehaviour
from vedette.agent.driving import Driver
from vedette.agent.effects import Drive, Motion
from vedette.agent.events import Arrived, Event, Pose, Sensed
from vedette.agent.pace import Pace
from vedette.fusion import ReplicatedEvidence
from vedette.fusion.replicated_map import ReplicatedMap
from vedette.maps.world import World
from vedette.outcome import Outcome
from vedette.sim.datagrams import Datagrams, linked
from vedette.sim.faults import Timeline
from vedette.sim.network import Network, Spawn
from vedette.sim.overlaid import Live, OverlaidNetwork
from vedette.sim.setup import Setup
from vedette.sim.simulation import Simulation
from vedette.team import PlatformSpec

PACE = Pace(interval=0.5, period=2.0)


class Bodies:
    """Points that move in straight lines; ``vedette.sim.field.Field``."""

    def __init__(self, places: NDArray[np.float64], sites: Sites) -> None:
        """Put robots at their places, ``(n, 2)`` [m]."""
        self.alive = np.ones(len(places), np.bool_)
        self.places: list[tuple[float, float]] = [(x, y) for x, y in places.tolist()]
        self._sites = [sites.place(site) for site in range(len(sites.cells))]
        self._goals: list[tuple[float, float] | None] = [None] * len(places)
        self._told = [True] * len(places)

    def pose(self, i: int) -> tuple[float, float, float]:
        """Return x, y [m] and heading."""
        return *self.places[i], 0.0

    def sense(self, i: int, now: float) -> list[Event]:
        """Return pose, and at the end of the way what is there."""
        x, y = self.places[i]
        if self._told[i] or self._goals[i] not in (None, (x, y)):
            return [Pose(x, y, 0.0)]
        self._told[i] = True
        near = [k for k, (a, b) in enumerate(self._sites) if math.hypot(a - x, b - y) < NEAR]
        return [Pose(x, y, 0.0), Sensed(near, now), Arrived()]

    def carry_out(self, i: int, motion: Motion, now: float) -> None:
        """Go straight to the end of a route, or stand."""
        assert isinstance(motion, Drive)
        route = motion.route
        self._goals[i] = None if route is None else (float(route.path[-1, 0]), float(route.path[-1, 1]))
        self._told[i] = route is None

    def advance(self, now: float, dt: float) -> None:
        """Move everybody."""
        for i, goal in enumerate(self._goals):
            if goal is not None and self.alive[i]:
                (x, y), step = self.places[i], SPEED * dt
                left = math.hypot(goal[0] - x, goal[1] - y)
                share = 1.0 if left <= step else step / left
                self.places[i] = (
                    goal if share == 1.0 else (x + share * (goal[0] - x), y + share * (goal[1] - y))
                )

    def kill(self, i: int) -> None:
        """Stop a robot."""
        self.alive[i], self._goals[i] = False, None

    def revive(self, i: int, now: float) -> None:
        """Let a robot go on from where it stands."""
        self.alive[i], self._told[i] = True, True

    def over(self, now: float) -> Outcome | None:
        """Never by itself."""


class SiteTeam(Simulation):
    """A team on the links of a graph."""

    def __init__(
        self,
        sites: Sites,
        places: NDArray[np.float64],
        edges: Sequence[Edge],
        datagrams: Datagrams,
        setup: Setup,
        *,
        lease: float,
        published: Published,
        live: Live | None = None,
    ) -> None:
        """Bring the team to life at its places, ``(n, 2)`` [m]."""
        self.sites, self.lease = sites, lease
        self.bodies = Bodies(places, sites)
        self._datagrams, self._published, self._live = datagrams, published, live
        datagrams.set_links(linked(len(places), edges))
        super().__init__(self._spawn, self.bodies, setup)

    def _overlaid(self, spawn: Spawn, walls: World | None) -> Network:
        assert self.setup.faults is not None
        timeline = Timeline(self.setup.faults, len(self.bodies.places))
        return OverlaidNetwork(
            spawn, self.bodies, self._datagrams, timeline=timeline, lease=self.lease, live=self._live
        )

    def _fusion(self, robot: int, boot: int) -> ReplicatedMap[Any]:
        return ReplicatedEvidence(robot, boot, FRAME.shape, len(self.sites.cells))

    def _spawn(self, robot: int, boot: int) -> Agent:
        fusion = self._fusion(robot, boot)
        mission = SiteMission((robot, boot), self.sites, fusion, self._published)
        spec = PlatformSpec(name=f"robot-{robot + 1}", speed=SPEED)
        behaviour = GroundBehaviour(mission, Driver(robot, spec))
        agent = Agent(robot, boot, spec, behaviour, self.setup.scheme, PACE)
        mission.stamp = lambda: agent.rounds.stamp
        agent.due |= {"beacon": math.inf, "look out": math.inf, "listen": -math.inf}  # nobody is in the way
        return agent

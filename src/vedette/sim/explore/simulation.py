"""Exploration put together for the simulator: a building, robots with lidars in it, and an agent for each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf
from typing import cast

import numpy as np
from numpy.typing import NDArray

from vedette.agent import Agent, GroundBehaviour
from vedette.agent.driving import Driver
from vedette.agent.orders import Order, OrderT
from vedette.agent.state import State
from vedette.domains.mapping.impact import Impact
from vedette.domains.mapping.planners import DEFAULT
from vedette.domains.mapping.prior import PriorMap
from vedette.maps.world import World
from vedette.missions.explore.assemble import assemble
from vedette.missions.explore.exploring import Exploring
from vedette.missions.explore.options import ExploreOptions
from vedette.missions.explore.own_map import OwnMap
from vedette.outcome import NO_PROGRESS, Outcome
from vedette.sim.framed import FramedRobots, as_meant, as_told, frames_of
from vedette.sim.robots import Robots
from vedette.sim.setup import Setup
from vedette.sim.simulation import Simulation, random_streams
from vedette.team import Most, PlatformSpec


@dataclass(frozen=True)
class ExploreSetup(Setup):
    """What to simulate, beside the world and the team."""

    planner: str = DEFAULT
    fusion: str = "replicated"
    return_home: bool = False
    area: tuple[tuple[float, float], ...] | None = None  # corners [m], as in ``ExploreOptions``
    unbounded: bool = False
    frames: str = "known"  # as in ``ExploreOptions``
    rendezvous: bool = False
    saved: OwnMap | None = None  # an earlier mission's map, which the first robot knows from the start
    prior: PriorMap | None = None  # an old map of the building, which all have

    @property
    def options(self) -> ExploreOptions:
        """How the team explores."""
        return ExploreOptions(
            *(self.planner, self.scheme, self.fusion, self.return_home, self.area, self.unbounded),
            frames=self.frames,
            rendezvous=self.rendezvous,
        )


class ExploreSimulation(Simulation):
    """A team of robots in a building; ``run`` lets it explore."""

    setup: ExploreSetup

    def __init__(
        self,
        world: World,
        specs: Sequence[PlatformSpec],
        starts: NDArray[np.float64],
        setup: ExploreSetup,
    ) -> None:
        """Put the team at its starts, (n, 3) x, y, heading [m, m, rad], team frame.

        Raises:
            InputError: the planner is unknown, or negotiates otherwise.
        """
        _ = setup.options.negotiates_by
        setup.options.check()
        self.lattice = setup.options.lattice_on(world.frame)
        self.setup = setup
        self.world, self.specs, self.starts = world, tuple(specs), starts
        self.robots = self._bodies()
        super().__init__(self._explorer, self.robots, setup, world)
        self._paused = -inf  # when anybody was told to wait last [s]

    def _bodies(self) -> Robots:
        """Return the robots at their starts."""
        team = self.world, self.specs, self.starts, random_streams(self.setup.seed, len(self.specs))
        if self.setup.frames == "known":
            return Robots(*team)
        return FramedRobots(*team, frames_of(len(self.specs), self.setup.seed))

    def _explorer(self, robot: int, boot: int) -> Agent:
        specs = self.specs
        setup, most = self.setup, Most.of(specs)
        team = self.lattice, specs[robot], setup.options, robot, boot
        agent = assemble(*team, robots=len(specs), most=most, prior=setup.prior)
        if robot == 0 and self.setup.saved is not None:
            cast(Exploring, agent.mission).own.take_over(self.setup.saved, (), 0.0)
        return agent

    @property
    def over(self) -> Outcome | None:
        """How the mission ends as it stands now; for want of progress only where nobody is held."""
        outcome = super().over
        if outcome is Outcome.NO_PROGRESS and self.now <= self._paused + NO_PROGRESS:
            return None
        return outcome

    def _tick(self) -> None:
        """Live through a tick, and note whether anybody is held."""
        super()._tick()
        if any(self.agents[i].state is State.PAUSED for i in self.living):
            self._paused = self.now

    def as_told(self, order: Order) -> Order:
        """Return an order with its place in the frame of a robot, if all have frames of their own."""
        robots = self.robots
        return as_told(order, robots.frames) if isinstance(robots, FramedRobots) else order

    def as_meant(self, order: OrderT) -> OrderT:
        """Return an order that robots hold with its place in the world."""
        robots = self.robots
        return as_meant(order, robots.frames) if isinstance(robots, FramedRobots) else order

    def held(self, robots: Sequence[int]) -> list[int]:
        """Return the digests of their maps."""
        return [self.missions[i].fusion.digest for i in robots]

    def promised(self, robot: int) -> Impact | None:
        """Return what a robot's strategy is to show of the map; None: it has none."""
        impact: Impact | None = self.network.agents[robot].rounds.impact
        return None if impact is None else self.missions[robot].on_map(impact)

    @property
    def missions(self) -> list[Exploring]:
        """Everybody's share of the mission, by index."""
        return [cast(Exploring, agent.mission) for agent in self.network.agents]

    @property
    def drivers(self) -> list[Driver]:
        """Everybody's driver, by index."""
        return [cast(GroundBehaviour, agent.behaviour).driver for agent in self.network.agents]

"""Exploration put together for the simulator: a building, robots with lidars in it, and an agent for each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import cast

import numpy as np
from numpy.typing import NDArray

from vedette.agent import Agent, GroundBehaviour
from vedette.agent.driving import Driver
from vedette.domains.mapping.planners import DEFAULT
from vedette.maps.world import World
from vedette.missions.explore.assemble import assemble
from vedette.missions.explore.exploring import Exploring
from vedette.missions.explore.options import ExploreOptions
from vedette.missions.explore.own_map import OwnMap
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
    saved: OwnMap | None = None  # an earlier mission's map, which the first robot knows from the start

    @property
    def options(self) -> ExploreOptions:
        """How the team explores."""
        return ExploreOptions(
            self.planner, self.scheme, self.fusion, self.return_home, self.area, self.unbounded
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
        self.lattice = setup.options.lattice_on(world.frame)
        self.setup = setup
        self.world, self.specs, self.starts = world, tuple(specs), starts
        self.robots = Robots(world, self.specs, starts, random_streams(setup.seed, len(specs)))
        super().__init__(self._explorer, self.robots, setup, world)

    def _explorer(self, robot: int, boot: int) -> Agent:
        specs = self.specs
        options, most = self.setup.options, Most.of(specs)
        agent = assemble(self.lattice, specs[robot], options, robot, boot, robots=len(specs), most=most)
        if robot == 0 and self.setup.saved is not None:
            cast(Exploring, agent.mission).own.take_over(self.setup.saved, ())
        return agent

    def held(self, robots: Sequence[int]) -> list[int]:
        """Return the digests of their maps."""
        return [self.missions[i].fusion.digest for i in robots]

    @property
    def missions(self) -> list[Exploring]:
        """Everybody's share of the mission, by index."""
        return [cast(Exploring, agent.mission) for agent in self.network.agents]

    @property
    def drivers(self) -> list[Driver]:
        """Everybody's driver, by index."""
        return [cast(GroundBehaviour, agent.behaviour).driver for agent in self.network.agents]

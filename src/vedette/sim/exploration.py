"""Exploration put together for the simulator: a building, robots with lidars in it, and an agent for each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vedette.agent import Agent, GroundBehaviour
from vedette.agent.driving import Driver
from vedette.domains.mapping.planners import planner
from vedette.domains.mapping.sightings import BINS
from vedette.fusion import ChannelFilter, Fusion, ReplicatedEvidence
from vedette.missions.explore import Exploration
from vedette.sim.robots import Robots
from vedette.sim.simulation import BOOT, Setup, Simulation, random_streams
from vedette.sim.world import World
from vedette.team import PlatformSpec

FUSIONS: Mapping[str, type[ReplicatedEvidence] | type[ChannelFilter]] = {
    "replicated": ReplicatedEvidence,
    "channel": ChannelFilter,
}


@dataclass(frozen=True)
class ExploreSetup(Setup):
    """What to simulate, beside the world and the team."""

    planner: str = "tours"
    fusion: str = "replicated"
    return_home: bool = False


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
            InputError: the planner is unknown.
        """
        self.world, self.specs, self.starts = world, tuple(specs), starts
        self.robots = Robots(world, self.specs, starts, random_streams(setup.seed, len(specs)))
        self.missions = [_mission(world, spec, i, setup) for i, spec in enumerate(self.specs)]
        self.drivers = [Driver(i, spec, world.frame) for i, spec in enumerate(self.specs)]
        agents = [
            Agent(i, BOOT, spec, GroundBehaviour(mission, driver, setup.return_home), setup.scheme)
            for i, (spec, mission, driver) in enumerate(
                zip(self.specs, self.missions, self.drivers, strict=True)
            )
        ]
        super().__init__(agents, self.robots, setup)


def _mission(world: World, spec: PlatformSpec, robot: int, setup: ExploreSetup) -> Exploration:
    fusion: Fusion = FUSIONS[setup.fusion](robot, BOOT, world.frame.shape, 4 * BINS)
    return Exploration(world.frame, spec, planner(setup.planner), fusion)

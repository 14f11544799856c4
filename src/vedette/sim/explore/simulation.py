"""Exploration put together for the simulator: a building, robots with lidars in it, and an agent for each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol, cast

import numpy as np
from numpy.typing import NDArray

from vedette.agent import Agent, GroundBehaviour
from vedette.agent.driving import Driver
from vedette.domains.mapping.planners import DEFAULT, planner
from vedette.domains.mapping.sightings import BINS
from vedette.errors import InputError, nearest_name
from vedette.fusion import ChannelFilter, Fusion, ReplicatedEvidence
from vedette.maps import GridFrame
from vedette.maps.world import World
from vedette.missions.explore.exploration import Exploration
from vedette.sim.robots import Robots
from vedette.sim.simulation import Setup, Simulation, random_streams
from vedette.team import Most, PlatformSpec

FUSIONS: Mapping[str, type[ReplicatedEvidence] | type[ChannelFilter]] = {
    "replicated": ReplicatedEvidence,
    "channel": ChannelFilter,
}


class Exploring(Protocol):
    """How a team explores."""

    @property
    def planner(self) -> str:
        """A name of `vedette.domains.mapping.planners`."""

    @property
    def scheme(self) -> str:
        """Of negotiation."""

    @property
    def fusion(self) -> str:
        """A name of ``FUSIONS``."""

    @property
    def return_home(self) -> bool:
        """Robots drive back to their starts in the end."""


@dataclass(frozen=True)
class ExploreSetup(Setup):
    """What to simulate, beside the world and the team."""

    planner: str = DEFAULT
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
        self.setup = setup
        self.world, self.specs, self.starts = world, tuple(specs), starts
        self.robots = Robots(world, self.specs, starts, random_streams(setup.seed, len(specs)))
        super().__init__(self._explorer, self.robots, setup, world)

    def _explorer(self, robot: int, boot: int) -> Agent:
        specs = self.specs
        return explorer(
            self.world.frame, specs[robot], self.setup, robot, boot, robots=len(specs), most=Most.of(specs)
        )

    @property
    def missions(self) -> list[Exploration]:
        """Everybody's share of the mission, by index."""
        return [cast(Exploration, agent.mission) for agent in self.network.agents]

    @property
    def drivers(self) -> list[Driver]:
        """Everybody's driver, by index."""
        return [cast(GroundBehaviour, agent.behaviour).driver for agent in self.network.agents]


def explorer(
    frame: GridFrame,
    spec: PlatformSpec,
    how: Exploring,
    robot: int,
    boot: int,
    *,
    robots: int,
    most: Most,
    waits_for: int = 1,
) -> Agent:
    """Return a fresh agent of a team.

    Args:
        frame: of the map.
        spec: its body.
        how: it explores.
        robot: its number.
        boot: of its start.
        robots: in the team.
        most: what none of them exceeds.
        waits_for: so many robots, itself included, before it begins; for a while.

    Raises:
        InputError: the planner or the way of fusing is unknown, or cannot serve such a team.
    """
    if how.fusion not in FUSIONS:
        raise InputError(f"unknown fusion {how.fusion!r}; {nearest_name(how.fusion, FUSIONS)}")
    fusion: Fusion = FUSIONS[how.fusion](robot, boot, frame.shape, 4 * BINS)
    mission = Exploration(frame, spec, planner(how.planner, robots), fusion, most=most)
    behaviour = GroundBehaviour(mission, Driver(robot, spec, frame), how.return_home, waits_for)
    return Agent(robot, boot, spec, behaviour, scheme_of(how))


def scheme_of(how: Exploring) -> str:
    """Return how the team negotiates: as its planner has it, if that is part of the planner."""
    return planner(how.planner).scheme or how.scheme

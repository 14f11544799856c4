"""A team of robots in a building that they do not know, with somebody in it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import cast

import numpy as np
from numpy.typing import NDArray

from vedette.agent import Agent
from vedette.agent.events import Event, Sensed
from vedette.domains.mapping.impact import Impact
from vedette.kernels.distance import distance_field
from vedette.kernels.frontier import traversable
from vedette.kernels.visibility import line_of_sight
from vedette.maps import FREE, OCCUPIED
from vedette.maps.world import World
from vedette.missions.seek.assemble import assemble
from vedette.missions.seek.options import LOOK_PERIOD, SeekOptions
from vedette.missions.seek.seeking import Glimpse, Seeking
from vedette.outcome import Outcome
from vedette.sim.explore.simulation import ExploreSetup, ExploreSimulation
from vedette.sim.robots import Robots
from vedette.sim.simulation import random_streams
from vedette.team import Most, PlatformSpec

SOMEBODY = 0.25  # radius of whom they look for [m]


@dataclass(frozen=True)
class SeekSetup(ExploreSetup):
    """What to simulate, beside the building and the team."""

    seek: SeekOptions = field(default_factory=SeekOptions)


class SeekingRobots(Robots):
    """Robots that look for somebody twice a second, through open air."""

    def __init__(
        self,
        world: World,
        specs: Sequence[PlatformSpec],
        starts: NDArray[np.float64],
        setup: SeekSetup,
        somebody: tuple[float, float],
    ) -> None:
        """Put the team at its starts, and somebody where they are [m], team frame."""
        super().__init__(world, specs, starts, random_streams(setup.seed, len(specs)))
        self._setup, self.somebody = setup, somebody
        self.found_by: int | None = None
        self.found_s: float | None = None
        self._luck = [np.random.default_rng([setup.seed, i, 3]) for i in range(len(specs))]
        self._next_look = [0.0] * len(specs)

    def sense(self, i: int, now: float) -> list[Event]:
        """Return what a robot senses, and what its look for somebody shows."""
        events = super().sense(i, now)
        if now < self._next_look[i] - 1e-9:
            return events
        self._next_look[i] += LOOK_PERIOD
        sees = self._luck[i].random() < self._setup.seek.detection and self._in_sight(i)
        if sees and self.found_by is None:
            self.found_by, self.found_s = i, now
        return [*events, Sensed(Glimpse(self.somebody if sees else None), now)]

    def _in_sight(self, i: int) -> bool:
        x, y, _ = self.pose(i)
        if np.hypot(x - self.somebody[0], y - self.somebody[1]) > self._setup.seek.reach:
            return False
        frame = self._world.frame
        there = np.array([frame.flat(*self.somebody)], np.int64)
        return bool(line_of_sight(self._world.solid, frame.flat(x, y), there)[0])

    def over(self, now: float) -> Outcome | None:
        """End when somebody is found, or nobody gets on."""
        return Outcome.FOUND if self.found_by is not None else super().over(now)


class SeekSimulation(ExploreSimulation):
    """A team that looks for somebody; ``run`` lets it."""

    setup: SeekSetup
    robots: SeekingRobots

    def _bodies(self) -> SeekingRobots:
        somebody = hidden(self.world, self.specs, self.starts, self.setup.seed)
        return SeekingRobots(self.world, self.specs, self.starts, self.setup, somebody)

    def _explorer(self, robot: int, boot: int) -> Agent:
        setup, specs = self.setup, self.specs
        how = setup.options, setup.seek
        return assemble(self.lattice, specs[robot], *how, robot, boot, most=Most.of(specs))

    def promised(self, robot: int) -> Impact | None:
        """Return what a robot's strategy is to show of the map; None: it has none."""
        impact = self.network.agents[robot].rounds.impact
        return None if impact is None else impact[0]

    @property
    def over(self) -> Outcome | None:
        """How the mission ends as it stands now; to have looked everywhere is not to have found."""
        ended = super().over
        return Outcome.MISSED if ended is Outcome.COMPLETE else ended

    @property
    def missions(self) -> list[Seeking]:  # type: ignore[override]
        """Everybody's share of the mission, by index."""
        return [cast(Seeking, agent.mission) for agent in self.network.agents]


def hidden(
    world: World, specs: Sequence[PlatformSpec], starts: NDArray[np.float64], seed: int
) -> tuple[float, float]:
    """Return where somebody stands [m]: anywhere that the team's largest robot could get to, by the seed."""
    frame = world.frame
    classes = np.where(world.solid, OCCUPIED, FREE).astype(np.uint8)
    radius = max(SOMEBODY, *(spec.radius for spec in specs))
    free = traversable(classes, radius, frame.resolution)
    field = distance_field(free, frame.flat(*starts[0, :2]), frame.resolution)
    cells = np.flatnonzero(np.isfinite(field) & free)
    chosen = np.random.default_rng([seed, 4]).choice(cells)
    x, y = frame.centres(np.array([chosen]))[0].tolist()
    return x, y

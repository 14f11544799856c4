"""Exploring teams with one member that lies, or misbehaves in any other way; all of it follows from a seed.

``python -m tests.support.liars MODE ROBOTS FIRST LAST [SCHEME [PLANNER]]`` plays many, and the same teams
with that member dead.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tests.support.lies import MODES, Mode
from tests.support.misbehaving import Twice
from tests.support.notaries import PlainNotary
from vedette.agent import Agent, NetworkedAgent
from vedette.domains.mapping.planners import DEFAULT
from vedette.fusion.signed import SignedEvidence
from vedette.fusion.trust import Comparison
from vedette.maps import FREE, OCCUPIED, UNKNOWN
from vedette.maps.world import World
from vedette.missions.explore.assemble import assemble
from vedette.missions.explore.exploring import Exploring
from vedette.outcome import Outcome
from vedette.sim.datagrams import Datagrams
from vedette.sim.explore.simulation import ExploreSetup, ExploreSimulation
from vedette.sim.faults import Schedule, Timeline
from vedette.sim.network import FIRST_BOOT, Network, Spawn
from vedette.sim.overlaid import OverlaidNetwork
from vedette.sim.simulation import random_streams
from vedette.sim.starts import choose_starts
from vedette.sim.worlds import office
from vedette.team import Most, PlatformSpec

AT_MOST = 600.0  # a mission may last [s]


class LyingTeam(ExploreSimulation):
    """A team whose evidence is signed, and whose last member lies; honest are all the others."""

    def __init__(
        self, world: World, specs: list[PlatformSpec], setup: ExploreSetup, mode: Mode, liar: int
    ) -> None:
        """Bring it to life at starts that follow from the seed."""
        self.mode, self.liar, self.now = mode, liar, 0.0
        self.worst = Comparison(0, 0, 0)
        self.named: dict[int, float] = {}  # when each robot was first complained of by somebody honest [s]
        starts = choose_starts(world, specs, np.random.default_rng([setup.seed, 1]), None)
        super().__init__(world, specs, starts, setup)

    def _explorer(self, robot: int, boot: int) -> Agent:
        explorer = self.mode.explorer if robot == self.liar else Exploring
        return assemble(
            self.lattice,
            self.specs[robot],
            self.setup.options,
            robot,
            boot,
            robots=len(self.specs),
            most=Most.of(self.specs),
            explorer=explorer,
            notary=PlainNotary(robot, lambda: self.now),
        )

    def _overlaid(self, spawn: Spawn, walls: World | None) -> Network:
        n, setup = len(self.specs), self.setup
        datagrams = Datagrams(n, random_streams(setup.seed, n)[n], (setup.link_delay, setup.link_delay))
        away = np.abs(np.subtract.outer(np.arange(n), np.arange(n)))
        datagrams.set_links((away > 1).astype(float) if self.mode.between else np.zeros((n, n)))
        self.lives: dict[int, NetworkedAgent] = {}
        timeline = Timeline(Schedule(()), n)
        return OverlaidNetwork(spawn, self.field, datagrams, timeline=timeline, live=self._live)

    def _live(self, i: int, agent: Agent, now: float, lease: float) -> NetworkedAgent:
        how: dict[str, Any] = {"lease": lease, "admitted": len(self.specs)}
        if i != self.liar:
            life = NetworkedAgent(agent, now, **how)
        elif self.mode.doubled:
            life = Twice(agent, now, double=self._explorer(i, FIRST_BOOT + 1), **how)
        else:
            life = self.mode.program(np.random.default_rng([self.setup.seed, 6]))(agent, now, **how)
        self.lives[i] = life
        return life

    @property
    def honest(self) -> list[int]:
        """All but the liar."""
        return [i for i in self.living if i != self.liar]

    @property
    def over(self) -> Outcome | None:
        """When the honest are done."""
        if all(self.network.agents[i].done for i in self.honest):
            return Outcome.COMPLETE
        return Outcome.TIME_LIMIT if self.now >= self.setup.max_time else None

    def _tick(self) -> None:
        super()._tick()
        for i in self.honest:
            for robot in self.lives[i].complaints:
                self.named.setdefault(robot, self.now)

    def look(self) -> None:
        """Note how far two of the honest contradict each other, as if all they say stood for ever."""
        fusion = self.missions[self.honest[0]].fusion
        assert isinstance(fusion, SignedEvidence)
        for (a, b), tally in fusion.contradictions(1 << 40).items():
            if self.liar not in (a, b) or self.mode is MODES["honest"]:
                self.worst = max(self.worst, tally)

    # -- how it went ---------------------------------------------------------------------------------

    def looked(self) -> NDArray[np.bool_]:
        """Return ``(R, C)`` where the honest have looked themselves."""
        return np.any([self.missions[i].own.log_odds.window(*self._window) != 0 for i in self.honest], axis=0)

    def wrong(self) -> float:
        """Return the share of wrong cells where the honest have looked, at worst on anybody's map.

        Walls count as right one cell off, as in a mission's summary.
        """
        looked = self.looked()
        inner = (
            self.world.solid & np.pad(self.world.solid, 1)[2:, 1:-1] & np.pad(self.world.solid, 1)[:-2, 1:-1]
        )
        worst = 0.0
        for i in self.honest:
            shown = self._shown(i)
            bad = ((shown == OCCUPIED) & ~_widened(self.world.solid)) | ((shown == FREE) & inner & looked)
            worst = max(worst, float((bad & looked).sum() / looked.sum()))
        return worst

    def known(self) -> float:
        """Return how many cells the honest know, the least of them; of what is free [m^2]."""
        return min(float(((self._shown(i) != UNKNOWN) & ~self.world.solid).sum()) for i in self.honest)

    def _shown(self, i: int) -> NDArray[np.uint8]:
        return self.missions[i].fusion.classes.window(*self._window)

    @property
    def _window(self) -> tuple[slice, slice]:
        """Where the world lies in the lattice."""
        here, there = self.world.frame, self.lattice.frame
        row = round((here.origin_y - there.origin_y) / here.resolution)
        col = round((here.origin_x - there.origin_x) / here.resolution)
        return slice(row, row + here.rows), slice(col, col + here.cols)


def _widened(solid: NDArray[np.bool_]) -> NDArray[np.bool_]:
    rows, cols = solid.shape
    padded = np.pad(solid, 1)
    return np.any([padded[i : i + rows, j : j + cols] for i in range(3) for j in range(3)], axis=0)


@dataclass(frozen=True)
class Ending:
    """How a team's mission went for those that are honest."""

    outcome: Outcome
    time: float  # [s]
    known: float
    wrong: float  # share of cells
    named: Mapping[int, float]  # when who was first complained of [s]
    liar: int
    out: frozenset[int]  # not believed, by anybody honest
    worst: Comparison  # how far two of the honest contradicted each other at most


def play(mode: str, robots: int, seed: int, scheme: str | None = None, planner: str = DEFAULT) -> Ending:
    """Play one mission."""
    rng = np.random.default_rng([seed, 5])
    world = office(rng, 14.0, 12.0)
    liar, how = int(rng.integers(robots)), MODES[mode]
    if how.between:
        liar = robots // 2
    setup = ExploreSetup(
        seed=seed,
        max_time=AT_MOST,
        faults=Schedule(()),
        unbounded=how.unbounded,
        scheme=scheme,
        planner=planner,
    )
    specs = [PlatformSpec(name=f"robot-{i + 1}") for i in range(robots)]
    team = LyingTeam(world, specs, setup, how, liar)
    outcome = team.run(team.look, 5.0)
    fusions = [team.missions[i].fusion for i in team.honest]
    out = frozenset[int]().union(*(each.out for each in fusions if isinstance(each, SignedEvidence)))
    return Ending(outcome, team.now, team.known(), team.wrong(), team.named, liar, out, team.worst)


@cache
def without(mode: str, robots: int, seed: int, scheme: str | None = None, planner: str = DEFAULT) -> Ending:
    """Play the same team with that member dead."""
    return play("dead between" if MODES[mode].between else "dead", robots, seed, scheme, planner)


def main(
    mode: str, robots: int, first: int, last: int, scheme: str | None = None, planner: str = DEFAULT
) -> None:
    """Print a line a mission."""
    for seed in range(first, last):
        began = time.monotonic()
        team = robots, seed, scheme, planner
        dead, ending = without(mode, *team), play(mode, *team)
        named = ending.named.get(ending.liar)
        others = sorted(set(ending.named) - {ending.liar})
        print(
            f"{mode} {robots} seed {seed}: {ending.outcome.value} after {ending.time:.1f} s, "
            f"{ending.time / dead.time:.2f} of dead's {dead.time:.1f}; "
            f"known {ending.known / dead.known:.4f}; "
            f"wrong {100 * ending.wrong:.2f} % (dead {100 * dead.wrong:.2f} %); "
            f"liar {ending.liar} named {named}; others named {others}; out {sorted(ending.out)}; "
            f"honest {tuple(ending.worst)}; {time.monotonic() - began:.0f} s",
            flush=True,
        )


if __name__ == "__main__":
    main(sys.argv[1], *map(int, sys.argv[2:5]), *sys.argv[5:7])

"""``python -m bench.decomposition``: where a robot's time goes, by planner and by how much is known.

Every half second of a robot is of one kind: it sees area that nobody had seen, drives over known ground,
gives way, turns, or stands. Until 90 % are known, from there to 99 %, and until the end.
"""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import mean
from typing import Literal

import click
import numpy as np
from numpy.typing import NDArray

from bench import command
from bench.crowds import known_world
from bench.missions import planner_name, tabulate
from bench.table import figure, markdown
from vedette.maps import UNKNOWN
from vedette.record.explore.score import Reference
from vedette.record.explore.views import RobotView
from vedette.record.summary import SCHEMA_VERSION
from vedette.sim.explore.run import ExploreRun, prepare, views
from vedette.sim.explore.simulation import ExploreSetup, ExploreSimulation
from vedette.sim.worlds import GENERATORS
from vedette.team import PlatformSpec

LOOK = 0.5  # [s]
SEES = 0.1  # a robot that has revealed so much since the last look was seeing new area [m^2]
MOVES, TURNS = 0.05, 0.05  # since the last look: less is standing, less is not turning [m], [rad]
PHASES = ("to 90 %", "to 99 %", "to the end")
KINDS = ("new area", "known ground", "giving way", "turning", "standing")


@dataclass(frozen=True)
class Case:
    """One mission in a generated world."""

    world: str
    robots: int
    planner: str
    seed: int

    @property
    def key(self) -> tuple[str, int, str, int]:
        """What tells it from all others."""
        return self.world, self.robots, self.planner, self.seed

    def __str__(self) -> str:
        """Name it in a line of progress."""
        return f"{self.world} {self.seed}, {self.robots} robots, {self.planner}"


@dataclass(frozen=True)
class Shares:
    """How long a robot did what, on average; one line of the results file."""

    world: str
    robots: int
    planner: str
    seed: int
    outcome: str
    time_s: float
    seconds: dict[str, dict[str, float]]  # by phase and kind
    cpu_s: float
    commit: str
    schema_version: Literal[3] = SCHEMA_VERSION

    @property
    def key(self) -> tuple[str, int, str, int]:
        """The mission's."""
        return self.world, self.robots, self.planner, self.seed


class Decomposition:
    """Tells the kinds of a mission's time, look by look."""

    def __init__(self, simulation: ExploreSimulation) -> None:
        """Begin with a mission that has not."""
        world = simulation.world
        self._simulation = simulation
        self._coverable = Reference(world, simulation.specs, simulation.starts).coverable
        self._known = np.zeros(world.frame.shape, np.bool_)
        self._poses = simulation.robots.bodies.poses.copy()
        self._counts: Counter[tuple[str, str]] = Counter()

    def look(self, seen: Sequence[RobotView]) -> None:
        """Take in what every robot has done since the last look."""
        phase = self._phase()
        poses = self._simulation.robots.bodies.poses.copy()
        for i, view in enumerate(seen):
            revealed = self._revealed(view)
            if view.sample.alive and not self._simulation.agents[i].finished:
                self._counts[phase, self._kind(i, poses[i], revealed)] += 1
        self._poses = poses

    def seconds(self) -> dict[str, dict[str, float]]:
        """Return how long a robot did what, on average [s]."""
        each = LOOK / len(self._poses)
        return {phase: {kind: each * self._counts[phase, kind] for kind in KINDS} for phase in PHASES}

    def _phase(self) -> str:
        share = np.count_nonzero(self._known & self._coverable) / np.count_nonzero(self._coverable)
        return PHASES[int(share >= 0.9) + int(share >= 0.99)]

    def _revealed(self, view: RobotView) -> float:
        """Note what a robot knows; return what of it nobody has known, and could be seen [m^2]."""
        frame = self._simulation.world.frame
        knows: NDArray[np.bool_] = view.seen_on(frame) & (view.classes_on(frame) != UNKNOWN)
        new = int(np.count_nonzero(knows & ~self._known & self._coverable))
        self._known |= knows
        return new * frame.resolution**2

    def _kind(self, i: int, pose: NDArray[np.float64], revealed: float) -> str:
        if revealed >= SEES:
            return "new area"
        before = self._poses[i]
        driver = self._simulation.drivers[i]
        if driver.yielding or driver.queueing:
            return "giving way"
        if np.hypot(*(pose[:2] - before[:2])) >= MOVES:
            return "known ground"
        turned = abs(np.angle(np.exp(1j * (pose[2] - before[2]))))
        return "turning" if turned >= TURNS else "standing"


def run_case(case: Case, commit: str) -> Shares:
    """Run one mission to its end, looking at it every half second."""
    began = time.process_time()
    world = GENERATORS[case.world](np.random.default_rng(case.seed))
    specs = [PlatformSpec(name=f"robot-{number}") for number in range(1, case.robots + 1)]
    simulation = prepare(world, specs, ExploreSetup(planner=case.planner, seed=case.seed))
    mission, decomposition, due = ExploreRun(simulation), Decomposition(simulation), LOOK
    while mission.step() is None:
        if simulation.now >= due:
            due += LOOK
            decomposition.look(views(simulation))
    summary = mission.report.summary
    return Shares(
        *case.key,
        outcome=summary.outcome.value,
        time_s=summary.time_s,
        seconds=decomposition.seconds(),
        cpu_s=time.process_time() - began,
        commit=commit,
    )


@click.command()
@command.worlds_option
@command.planners_option("tours,burgard")
@command.robots_option("3")
@command.seeds_option("0-9", "Of each kind.")
@command.jobs_option(2)
@command.fresh_option
@command.out_option("results and table")
def decomposition(
    worlds: str,
    planners: str,
    robots: tuple[int, ...],
    seeds: tuple[int, ...],
    jobs: int,
    fresh: bool,
    out: Path,
) -> None:
    """Tell where robots' time goes; missions that are in the results file already are not run again.

    Exit status 0 if all missions ran, however well, and 1 if one broke.
    """
    cases = [
        Case(world, team, name, seed)
        for world in map(known_world, worlds.split(","))
        for team in robots
        for name in map(planner_name, planners.split(","))
        for seed in seeds
    ]
    tabulate(cases, out, "decomposition", jobs, fresh, run_case, Shares, decomposition_table)


def decomposition_table(results: Sequence[Shares]) -> str:
    """Return a line a kind of world, team and planner: a robot's seconds by kind, by phase in brackets."""
    header = ("worlds", "robots", "planner", "missions", "end [s]", *KINDS)
    rows = []
    for world, robots, planner in sorted({each.key[:3] for each in results}):
        some = [each for each in results if each.key[:3] == (world, robots, planner)]
        kinds = []
        for kind in KINDS:
            phases = [mean(each.seconds[phase][kind] for each in some) for phase in PHASES]
            kinds.append(f"{figure(round(sum(phases)))} ({'/'.join(f'{each:.0f}' for each in phases)})")
        end = figure(mean(each.time_s for each in some))
        rows.append((world, str(robots), planner, str(len(some)), end, *kinds))
    commits = ", ".join(sorted({each.commit for each in results}))
    about = f"Seconds of a robot, on average; in brackets {', '.join(PHASES)}. Commit: {commits}\n"
    return f"{markdown(header, rows, 'lrlrr' + 'r' * len(KINDS))}\n{about}"


if __name__ == "__main__":
    command.run(decomposition, "bench.decomposition")

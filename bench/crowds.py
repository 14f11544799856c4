"""``python -m bench.crowds``: large teams in offices, caves and mazes, one line a mission."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Literal

import click
import numpy as np

from bench import command
from bench.idleness import Idleness
from bench.missions import tabulate
from bench.table import figure, markdown
from vedette.errors import InputError
from vedette.outcome import Outcome
from vedette.record.summary import SCHEMA_VERSION
from vedette.sim.explore.run import ExploreRun, prepare, views
from vedette.sim.explore.simulation import ExploreSetup
from vedette.sim.worlds import GENERATORS
from vedette.team import PlatformSpec

SEEDS = {"office": tuple(range(10)), "cave": tuple(range(3)), "maze": tuple(range(3))}
LOOK = 1.0  # [s]
LEFT = 1.0  # a robot that was never farther than this from its start never left it [m]
MOVES = 0.05  # who moves less than this between two looks stands [m]


@dataclass(frozen=True)
class Crowd:
    """One mission of a large team in a generated world."""

    world: str
    robots: int
    seed: int

    @property
    def key(self) -> tuple[str, int, int]:
        """What tells it from all others."""
        return self.world, self.robots, self.seed

    def __str__(self) -> str:
        """Name it in a line of progress."""
        return f"{self.world} {self.seed}, {self.robots} robots"


@dataclass(frozen=True)
class CrowdResult:
    """How it went; one line of the results file."""

    world: str
    robots: int
    seed: int
    outcome: str
    coverage: float
    t90_s: float | None
    t99_s: float | None
    time_s: float
    last_gain_s: float
    standing_s: float  # after the last gain, with nobody on the move
    idle_s: float  # the longest that a robot stayed where it was, with work about that was nobody's
    never_left: int
    collisions: int
    cpu_s: float
    commit: str
    schema_version: Literal[3] = SCHEMA_VERSION

    @property
    def key(self) -> tuple[str, int, int]:
        """The mission's."""
        return self.world, self.robots, self.seed


def run_crowd(case: Crowd, commit: str) -> CrowdResult:
    """Run one mission to its end, looking at it every second."""
    began = time.process_time()
    world = GENERATORS[case.world](np.random.default_rng(case.seed))
    specs = [PlatformSpec(name=f"robot-{number}") for number in range(1, case.robots + 1)]
    simulation = prepare(world, specs, ExploreSetup(seed=case.seed))
    mission, idleness = ExploreRun(simulation), Idleness(simulation)
    due = last_gain = standing = known = 0.0
    before, farthest = simulation.starts[:, :2].copy(), np.zeros(case.robots)
    while mission.step() is None:
        if simulation.now < due:
            continue
        due += LOOK
        seen = views(simulation)
        idleness.look(simulation.now, seen)
        here = np.array([(view.sample.x, view.sample.y) for view in seen])
        farthest = np.maximum(farthest, np.hypot(*(here - simulation.starts[:, :2]).T))
        covered = idleness.covered
        if covered > known:
            known, last_gain, standing = covered, simulation.now, 0.0
        elif np.hypot(*(here - before).T).max() < MOVES:
            standing += LOOK
        before = here
    summary = mission.report.summary
    assert summary.coverage is not None, "the ground is known"
    return CrowdResult(
        *case.key,
        outcome=summary.outcome.value,
        coverage=summary.coverage,
        t90_s=summary.t90_s,
        t99_s=summary.t99_s,
        time_s=summary.time_s,
        last_gain_s=last_gain,
        standing_s=standing,
        idle_s=idleness.longest,
        never_left=int(np.count_nonzero(farthest < LEFT)),
        collisions=summary.collisions,
        cpu_s=time.process_time() - began,
        commit=commit,
    )


@click.command()
@click.option(
    "--worlds", default=",".join(SEEDS), show_default=True, help="Kinds of generated worlds, with commas."
)
@command.robots_option("8,10,12,20,40")
@click.option(
    "--seeds", type=command.WholeNumbers(0), help="Of each kind.  [default: 0-9 of offices, else 0-2]"
)
@command.jobs_option(2)
@command.fresh_option
@command.out_option("results and table")
def crowds(
    worlds: str, robots: tuple[int, ...], seeds: tuple[int, ...] | None, jobs: int, fresh: bool, out: Path
) -> None:
    """Run missions of large teams; those that are in the results file already are not run again.

    Exit status 0 if all missions ran, however well, and 1 if one broke.
    """
    cases = [
        Crowd(world, team, seed)
        for world in map(known_world, worlds.split(","))
        for seed in seeds or SEEDS[world]
        for team in robots
    ]
    tabulate(cases, out, "crowds", jobs, fresh, run_crowd, CrowdResult, crowds_table)


def known_world(name: str) -> str:
    """Return the name without blanks around it.

    Raises:
        InputError: there is no such kind.
    """
    if name.strip() not in SEEDS:
        raise InputError(f"--worlds must be of {', '.join(SEEDS)}; got {name!r}")
    return name.strip()


def crowds_table(results: Sequence[CrowdResult]) -> str:
    """Return a line a kind of world and size of team: the worst of its missions, and medians of times."""
    header = (
        "worlds", "robots", "missions", "complete", "end, median [s]", "last gain to end, most [s]",
        "of it standing, most [s]", "idle, most [s]", "never left, most", "coverage, least",
    )  # fmt: skip
    rows = []
    for world, robots in sorted({(each.world, each.robots) for each in results}):
        some = [each for each in results if (each.world, each.robots) == (world, robots)]
        rows.append(
            (
                world,
                str(robots),
                str(len(some)),
                str(sum(each.outcome == Outcome.COMPLETE for each in some)),
                figure(median(each.time_s for each in some)),
                figure(max(each.time_s - each.last_gain_s for each in some)),
                figure(max(each.standing_s for each in some)),
                figure(max(each.idle_s for each in some)),
                str(max(each.never_left for each in some)),
                f"{min(each.coverage for each in some):.4f}",
            )
        )
    commits = ", ".join(sorted({each.commit for each in results}))
    return f"{markdown(header, rows, 'lrrrrrrrrr')}\nCommit: {commits}\n"


if __name__ == "__main__":
    command.run(crowds, "bench.crowds")

"""``python -m bench.omniscient``: how soon a team that knows the true map sees it all, beside planners.

A bound to compare with, not a planner: places to look from, what each shows and what is seen on the way are
taken from the truth, and the longest route is made short by local search. Its times are planned: the longest
route over the speed; nobody turns, and nobody gives way. Found routes need not be the shortest, so that a
better team is not excluded.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from pathlib import Path

import click
import numpy as np

from bench import command
from bench.crowds import known_world
from bench.missions import planner_name, tabulate
from bench.watchman import KnownWorld, plan
from bench.ways import Case, Timed, ratio_table
from vedette.sim.explore.run import explore, placed, prepare
from vedette.sim.explore.simulation import ExploreSetup
from vedette.sim.worlds import GENERATORS
from vedette.team import PlatformSpec

EACH, ONE = (
    "omniscient, each",
    "omniscient, one",
)  # a plan for each share, and one that is made for completion
SHARES = (0.9, 0.99)
COMPLETE = 0.9994  # of what can be seen: so much, at least, was known when ten held-out worlds were complete
ROUNDS = 60  # of local search


def run_case(case: Case, commit: str) -> Timed:
    """Plan for a team that knows the world, or let one explore it."""
    began = time.process_time()
    world = GENERATORS[case.world](np.random.default_rng(case.seed))
    specs = [PlatformSpec(name=f"robot-{number}") for number in range(1, case.robots + 1)]
    if case.way not in (EACH, ONE):
        setup = ExploreSetup(planner=case.way, seed=case.seed)
        summary = explore(prepare(world, specs, setup), curves_only=True).summary
        found = summary.t90_s, summary.t99_s, summary.time_s
        cpu = time.process_time() - began
        return Timed(*case.key, summary.outcome.value, summary.coverage, *found, cpu, commit)
    known = KnownWorld(world, *placed(world, specs, ExploreSetup(seed=case.seed)))
    whole = plan(known, COMPLETE, ROUNDS, np.random.default_rng(case.seed))
    if case.way == ONE:
        ways = [known.known_after(whole, share) for share in SHARES]
    else:
        plans = [plan(known, share, ROUNDS, np.random.default_rng(case.seed)) for share in SHARES]
        ways = [float(known.lengths(routes).max()) for routes in plans]
    t90, t99, end = (way / specs[0].speed for way in (*ways, float(known.lengths(whole).max())))
    cpu = time.process_time() - began
    return Timed(*case.key, "planned", known.share(whole), t90, t99, end, cpu, commit)


@click.command()
@command.worlds_option
@command.planners_option("tours,burgard")
@command.robots_option("3")
@command.seeds_option("200-203", "Of each.")
@command.jobs_option(2)
@command.fresh_option
@command.out_option("results and table")
def omniscient(
    worlds: str,
    planners: str,
    robots: tuple[int, ...],
    seeds: tuple[int, ...],
    jobs: int,
    fresh: bool,
    out: Path,
) -> None:
    """Tell how far from a team that knows the map planners are; what is in the results file is not run again.

    Exit status 0 if all missions ran, however well, and 1 if one broke.
    """
    names = [planner_name(name) for name in planners.split(",")]
    cases = [
        Case(world, team, way, seed)
        for seed in seeds
        for world in map(known_world, worlds.split(","))
        for team in robots
        for way in (EACH, ONE, *names)
    ]

    def table(results: Sequence[Timed]) -> str:
        return ratio_table(results, [(way, name) for name in names for way in (EACH, ONE)])

    tabulate(cases, out, "omniscient", jobs, fresh, run_case, Timed, table)


if __name__ == "__main__":
    command.run(omniscient, "bench.omniscient")

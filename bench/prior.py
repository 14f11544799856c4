"""``python -m bench.prior``: what an old map brings, of this building or another, and what prediction does.

Missions in generated worlds: without an old map, with the right one, with that of another world of its kind,
by what the building itself shows, and by another planner to compare with. Times are compared in the same
world, as ratios.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from pathlib import Path

import click
import numpy as np

from bench import command
from bench.crowds import known_world
from bench.missions import tabulate
from bench.ways import Case, Timed, ratio_table
from vedette.domains.mapping.prior import PriorMap
from vedette.errors import check_word
from vedette.maps import FREE, OCCUPIED
from vedette.maps.world import World
from vedette.sim.explore.run import explore, prepare
from vedette.sim.explore.simulation import ExploreSetup
from vedette.sim.worlds import GENERATORS
from vedette.team import PlatformSpec

ELSEWHERE = 1000  # the other world's seed is so much larger
WAYS = ("none", "right", "wrong", "predicted", "burgard")  # old maps; and other planners, without one
PAIRS = (
    ("right", "none"),
    ("wrong", "none"),
    ("predicted", "none"),
    ("none", "burgard"),
    ("right", "burgard"),
    ("predicted", "burgard"),
)


def old_map(world: World) -> PriorMap:
    """Return a world's plan."""
    return PriorMap.of(np.where(world.solid, np.uint8(OCCUPIED), np.uint8(FREE)), world.frame)


def run_case(case: Case, commit: str) -> Timed:
    """Run one mission to its end."""
    began = time.process_time()
    make = GENERATORS[case.world]
    world = make(np.random.default_rng(case.seed))
    specs = [PlatformSpec(name=f"robot-{number}") for number in range(1, case.robots + 1)]
    prior = None
    if case.way in ("right", "wrong"):
        other = case.seed + ELSEWHERE * (case.way == "wrong")
        prior = old_map(make(np.random.default_rng(other)))
    planner = case.way if case.way in ("predicted", "burgard") else "tours"
    setup = ExploreSetup(planner=planner, seed=case.seed, prior=prior)
    summary = explore(prepare(world, specs, setup), curves_only=True).summary
    times = summary.t90_s, summary.t99_s, summary.time_s
    cpu = time.process_time() - began
    return Timed(*case.key, summary.outcome.value, summary.coverage, *times, cpu, commit)


@click.command()
@command.worlds_option
@command.robots_option("3")
@command.seeds_option("400-405", "Of each.")
@click.option("--ways", default=",".join(WAYS), show_default=True, help="Of them these, with commas.")
@command.jobs_option(2)
@command.fresh_option
@command.out_option("results and table")
def prior(
    worlds: str,
    robots: tuple[int, ...],
    seeds: tuple[int, ...],
    ways: str,
    jobs: int,
    fresh: bool,
    out: Path,
) -> None:
    """Tell what an old map brings, and prediction; missions in the results file already are not run again.

    Exit status 0 if all missions ran, however well, and 1 if one broke.
    """
    kinds, chosen = [known_world(world) for world in worlds.split(",")], ways.split(",")
    for way in chosen:
        check_word("ways", way, WAYS)
    cases = [
        Case(world, team, way, seed) for seed in seeds for world in kinds for team in robots for way in chosen
    ]
    tabulate(cases, out, "prior", jobs, fresh, run_case, Timed, prior_table)


def prior_table(results: Sequence[Timed]) -> str:
    """Return a line a kind of world and pair of ways."""
    return ratio_table(results, PAIRS)


if __name__ == "__main__":
    command.run(prior, "bench.prior")

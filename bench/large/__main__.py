"""``python -m bench.large``: what large worlds, fine cells and large teams cost, before and after."""

from __future__ import annotations

import re
from functools import partial
from itertools import product
from pathlib import Path

import click

from bench import command
from bench.large.cases import LargeResult, Size, large_cases, run_large
from bench.large.tables import large_table
from bench.large.trees import built, present
from bench.missions import tabulate
from vedette.errors import InputError

_WORLD = re.compile(r"(\d{1,3})x(\d{1,3})")


@click.command()
@click.option("--before", metavar="COMMIT", help="Measure this commit too, built in build/before.")
@click.option("--worlds", default="30x20,60x40,120x80,200x200", show_default=True, help="Offices [m].")
@click.option("--resolutions", default="0.1,0.05", show_default=True, help="Sides of a cell [m].")
@command.robots_option("1,3,4,16,50")
@click.option(
    "--max-time", type=click.FloatRange(min=1.0), default=3600.0, show_default=True, help="Simulated [s]."
)
@command.jobs_option(1)
@command.fresh_option
@command.out_option("results and table")
def large(
    before: str | None,
    worlds: str,
    resolutions: str,
    robots: tuple[int, ...],
    max_time: float,
    jobs: int,
    fresh: bool,
    out: Path,
) -> None:
    """Measure missions by CPU time; those that are in the results file already are not run again.

    Exit status 0 if all missions ran, whatever they took, and 1 if one broke.
    """
    sides = [world_of(word) for word in worlds.split(",")]
    cells = [cell_of(word) for word in resolutions.split(",")]
    sizes = [Size(*side, cell, team) for side, cell, team in product(sides, cells, robots)]
    versions = ([] if before is None else [built(before)]) + [present()]
    cases = large_cases(sizes, max_time, versions)
    table = partial(large_table, versions=versions)
    tabulate(cases, out, "large", jobs, fresh, run_large, LargeResult, table)


def world_of(word: str) -> tuple[int, int]:
    """Return width and height [m]; ``InputError`` for what is not ``60x40``."""
    match = _WORLD.fullmatch(word.strip())
    if match is None:
        raise InputError(f"--worlds must be sizes such as 60x40,200x200; got {word!r}")
    return int(match[1]), int(match[2])


def cell_of(word: str) -> float:
    """Return the side of a cell [m]; ``InputError`` for what is none."""
    try:
        return float(word)
    except ValueError as error:
        raise InputError(f"--resolutions must be numbers such as 0.1,0.05; got {word!r}") from error


if __name__ == "__main__":
    command.run(large, "bench.large")

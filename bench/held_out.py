"""``python -m bench.held_out``: the default in worlds that nothing was tuned on, against what is asked."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

import click
import numpy as np
from rich.console import Console

from bench import RESULTS, command, machine
from bench.held_out_table import NEAREST, OURS, REFERENCE, report
from vedette.logs import read_carmen
from vedette.record.files import output_directory, write_text
from vedette.record.lock import locked
from vedette.sim.explore.simulation import ExploreSetup
from vedette.sim.worlds import GENERATORS, logged
from vedette.study.conduct import conduct
from vedette.study.provenance import fingerprint
from vedette.study.rows import figure_rows
from vedette.study.run import GeneratedWorld, MapWorld, Run
from vedette.study.store import Store
from vedette.study.workers import Workers
from vedette.team import PlatformSpec

SIZE, RESOLUTION = (30.0, 20.0), 0.1  # of what is generated or made of logs [m], [m]
REACH = 20.0  # of a log's beams [m]
MAPS = (".yaml", ".yml")
BETWEEN = 5  # rounds of generated worlds from one large building to the next: it takes about as long as they
STARTS = 3  # in each building

Place = tuple[GeneratedWorld | MapWorld, int]  # a world, and the seed of the starts and of all chance


def buildings(files: Sequence[Path], folder: Path) -> list[MapWorld]:
    """Return maps, and what was recorded in logs as maps in ``folder``; the smallest first.

    Raises:
        InputError: one cannot be read, or leaves nothing free.
    """
    found = []
    for path in files:
        if path.suffix not in MAPS:
            world = logged(read_carmen(path), RESOLUTION, REACH, "ignore")
            path = world.save(output_directory(folder / path.name.partition(".")[0], force=True))
        found.append(MapWorld.read(path, None))
    return sorted(found, key=_free)


def _free(building: MapWorld) -> float:
    return float(np.count_nonzero(~building.build().solid)) * building.resolution**2


def in_order(
    seeds: Sequence[int], large: Sequence[MapWorld], teams: Sequence[int]
) -> Iterator[tuple[Place, int]]:
    """Yield places and teams, what tells most first.

    One world of every kind before the second, team by team, and now and then one of the smallest buildings;
    then the other buildings and starts, all of them from one start before the next.
    """
    places = [(building, start) for start in range(STARTS) for building in large]
    early = places[: min(len(seeds) // BETWEEN, len(large))]
    for robots in teams:
        for number, seed in enumerate(seeds, start=1):
            for kind in GENERATORS:
                yield (GeneratedWorld(kind, seed, *SIZE, RESOLUTION), 0), robots
            if number % BETWEEN == 0 and number // BETWEEN <= len(early):
                yield early[number // BETWEEN - 1], robots
    yield from ((place, robots) for place in places[len(early) :] for robots in teams)


def runs(seeds: Sequence[int], large: Sequence[MapWorld], teams: Sequence[int], max_time: float) -> list[Run]:
    """Return the missions, those that are compared with each other side by side."""
    return [
        Run(
            *(world, robots, "together", PlatformSpec("robot")),
            ExploreSetup(planner=name, seed=seed, max_time=max_time),
        )
        for (world, seed), robots in in_order(seeds, large, teams)
        for name in (OURS, REFERENCE, *((NEAREST,) if robots == 1 else ()))
    ]


@click.command()
@click.argument("files", nargs=-1, metavar="[MAP.yaml | LOG]...", type=Path)
@command.seeds_option("420-439", "Of each kind.")
@command.robots_option("3,8,1", "Teams, in this order.")
@click.option(
    "--max-time", type=click.FloatRange(min=1.0), default=4 * 3600.0, show_default=True,
    help="Of a mission [s]; one that is not done by then counts as unfinished.",
)  # fmt: skip
@command.jobs_option(2)
@command.minutes_option
@command.out_option("the results", RESULTS / "held-out")
def held_out(
    files: tuple[Path, ...],
    seeds: tuple[int, ...],
    robots: tuple[int, ...],
    max_time: float,
    jobs: int,
    minutes: float | None,
    out: Path,
) -> None:
    """Let the default and the yardsticks explore: generated worlds, maps, buildings recorded in CARMEN logs.

    Missions that this code has carried out before are not carried out again; the table is of those that are
    there. Exit status 0 if all missions ran, 1 if one broke or is still to do, 130 if it was interrupted.
    """
    end = math.inf if minutes is None else time.monotonic() + 60.0 * minutes
    store = Store.open(out, fingerprint(), files)
    wanted = runs(seeds, buildings(files, out / "worlds"), robots, max_time)
    with locked(out):
        done = conduct(wanted, store, Workers(jobs, over=lambda: time.monotonic() >= end), Console())
        if done.results:
            about = f"Missions: {len(done.results)} of {len(wanted)}, {done.broken} broke."
            text = f"{report(figure_rows(done.results))}\n{about} Commit: {machine.commit()}\n"
            write_text(out / "held-out.md", text)
            click.echo(f"\n{text}\nwritten: {out / 'held-out.md'}")
    raise SystemExit(command.status(done))


if __name__ == "__main__":
    command.run(held_out, "bench.held_out")

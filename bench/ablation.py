"""``python -m bench.ablation``: what the parts of the default are worth, told by exchanging each."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import click
from rich.console import Console

from bench import RESULTS, command, machine
from bench.steps.late import LatePlatform
from bench.steps.regions import RegionPlatform
from bench.steps.sure import SurePlatform
from bench.steps.way import WayPlatform
from bench.table import figure, markdown, ratio_cell
from vedette.domains.mapping import layers, planners
from vedette.domains.mapping.baselines.greedy import GreedyPlatform
from vedette.domains.mapping.planners import Planner
from vedette.domains.mapping.platform import MappingPlatform
from vedette.domains.mapping.price import FREE
from vedette.errors import InputError
from vedette.record.files import write_text
from vedette.sim.explore.simulation import ExploreSetup
from vedette.study.compare import difference, mean
from vedette.study.conduct import conduct
from vedette.study.metrics import AUC, TIMES, TOTAL
from vedette.study.mission import RunResult, carry_out
from vedette.study.provenance import fingerprint
from vedette.study.rows import Row, figure_rows
from vedette.study.run import GeneratedWorld, Run
from vedette.study.store import Store
from vedette.study.workers import Workers
from vedette.team import PlatformSpec

WHOLE = planners.DEFAULT
KINDS = ("office", "cave", "maze")
SIZE, RESOLUTION, MAX_TIME = (30.0, 20.0), 0.1, 1800.0  # of the worlds [m], [m]; of a mission [s]
METRICS = (AUC, *(metric for metric in TIMES if metric.column in ("t90_s", "t99_s")), TOTAL)


def variants() -> Mapping[str, Planner]:
    """Return the planner with one part exchanged, by what differs."""
    whole = replace(planners.PLANNERS[WHOLE], alone=None)

    def with_platform(kind: type[MappingPlatform], stops: int, measured: str) -> Planner:
        return replace(whole, platform=lambda spec: kind(spec, max_stops=stops, measured=measured))

    def with_kind(kind: type[MappingPlatform]) -> Planner:
        return with_platform(kind, 6, "unknown")

    return {
        "rate until 0.7 m2": replace(whole, turn=0.7),
        "rate until 1.4 m2": replace(whole, turn=1.4),
        "rate until 3 m2": replace(whole, turn=3.0),
        "rate throughout": planners.PLANNERS["rate"],
        "single stops instead of tours": with_platform(MappingPlatform, 1, "unknown"),
        "no hidden area": replace(whole, hidden=0.0),
        "no price of the way back": replace(whole, return_price=0.0),
        "twice the price of the way back": replace(whole, return_price=0.6),
        "2 m2 hidden, 1 m2 a metre back": replace(whole, hidden=2.0, return_price=1.0),
        "no time layers": replace(whole, layers=layers.plain()),
        "one pass from nothing": replace(with_platform(GreedyPlatform, 6, "unknown"), scheme="token"),
        "all replying at once": replace(whole, scheme="jacobi"),
        "late frontiers at once": with_kind(LatePlatform),
        "a certain bonus a frontier": with_kind(SurePlatform),
        "seen on the way": with_kind(WayPlatform),
        "predicted": replace(planners.PLANNERS["predicted"], alone=None),
        "regions": with_kind(RegionPlatform),
        "long tours, no price": replace(planners.PLANNERS["long"], alone=None, end_price=FREE),
        "long tours, a price on their end": replace(planners.PLANNERS["long"], alone=None),
        "sightings by distance": with_platform(MappingPlatform, 6, "distance"),
        "sightings by the beam model": with_platform(MappingPlatform, 6, "beam"),
    }


def cases(seeds: Sequence[int], robots: int, names: Sequence[str]) -> list[Run]:
    """Return a mission a world and variant: the same team in an office, a cave and a maze of every seed.

    All that is compared comes world by world, and a world of every kind before the second.
    """
    worlds = [GeneratedWorld(kind, seed, *SIZE, RESOLUTION) for seed in seeds for kind in KINDS]
    setups = [ExploreSetup(planner=name, max_time=MAX_TIME) for name in names]
    return [
        Run(world, robots, "together", PlatformSpec("robot"), setup) for world in worlds for setup in setups
    ]


def carry_out_variant(run: Run) -> RunResult:
    """Carry out a run whose planner may be a variant, in whatever process this is."""
    planners.PLANNERS.update(variants())  # through its module: a worker gets copies of this one's own names
    return carry_out(run)


def table(rows: Sequence[Row]) -> str:
    """Return the Markdown table: each planner's means, and their ratios to those of the whole."""
    header = ("exchanged", *(metric.label for metric in METRICS))
    names = dict.fromkeys(str(row["planner"]) for row in rows)
    return markdown(header, [_row(rows, name) for name in names], "l" + "r" * len(METRICS))


def _row(rows: Sequence[Row], name: str) -> tuple[str, ...]:
    if name == WHOLE:
        return ("nothing", *(figure(mean(rows, name, metric).interval.value) for metric in METRICS))
    ratios = [difference(rows, name, WHOLE, metric).ratio for metric in METRICS]
    return (name, *map(ratio_cell, ratios))


@click.command()
@command.seeds_option("100-103", "Of the worlds.")
@click.option("--robots", type=click.IntRange(1, 64), default=3, show_default=True, help="In every team.")
@click.option("--only", default="", help="Only the parts whose names hold one of these, with commas.")
@command.jobs_option(2)
@command.minutes_option
@command.out_option("the results", RESULTS / "ablation")
def ablation(
    seeds: tuple[int, ...], robots: int, only: str, jobs: int, minutes: float | None, out: Path
) -> None:
    """Exchange the parts of the planner one at a time and print what each is worth.

    Missions that this code has carried out before are not carried out again; the table is of those that are
    there. Exit status 0 if all missions ran, 1 if one broke or is still to do, 130 if it was interrupted.
    """
    end = math.inf if minutes is None else time.monotonic() + 60.0 * minutes
    planners.PLANNERS.update(variants())
    words = [word.strip() for word in only.split(",")]
    for word in words:
        if not any(word in name for name in variants()):
            raise InputError(f"only: no part's name holds {word!r}; there are: {', '.join(variants())}")
    names = [name for name in variants() if any(word in name for word in words)]
    runs = cases(seeds, robots, (WHOLE, *names))
    own = Path(__file__)
    code = fingerprint() + fingerprint(own.parent / "steps") + own.read_text(encoding="utf-8")
    workers = Workers(jobs, work=carry_out_variant, over=lambda: time.monotonic() >= end)
    done = conduct(runs, Store.open(out, code), workers, Console())
    if done.results:
        about = f"Missions: {len(done.results)} of {len(runs)}. Commit: {machine.commit()}"
        text = f"{table(figure_rows(done.results))}\n{about}\n"
        write_text(out / "ablation.md", text)
        click.echo(text)
    raise SystemExit(command.status(done))


if __name__ == "__main__":
    command.run(ablation, "bench.ablation")

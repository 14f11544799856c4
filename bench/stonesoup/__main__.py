"""``python -m bench.stonesoup``: one decision of each manager, from 1 to 16 radars, with verdicts."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from statistics import fmean, median

import click
import numpy as np

from bench import command, machine
from bench.criteria import BenchReport, Criterion, Measurement, verdicts
from bench.stonesoup.managers import ANY, BRUTE, GREEDY, LOG_DET, MANAGERS, OURS, Decision, compare
from bench.stonesoup.scenario import scene
from bench.table import figure, markdown
from vedette.record.files import write_text

RADARS, LARGE = (1, 2, 3, 4, 8, 16), 16
QUICK_SIZE = 16  # radars x targets up to which the slow managers take part in a smoke run
HEADER = ("radars", "targets", "manager", "CPU s", "of greedy's", "share, mean", "share, worst", "scenes")


@dataclass(frozen=True)
class Row:
    """One manager on all scenes of a size."""

    radars: int
    targets: int
    manager: str
    cpu_s: float  # median over the scenes
    of_greedy: float  # its CPU time over the greedy manager's on the same scenes, median
    share: float  # of the best known reward, mean
    worst: float
    scenes: int

    def cells(self) -> tuple[str, ...]:
        """Return the row of the table."""
        shares = (f"{share:.4f}" for share in (self.share, self.worst))
        numbers = (figure(self.cpu_s), figure(self.of_greedy))
        return (str(self.radars), str(self.targets), self.manager, *numbers, *shares, str(self.scenes))


@dataclass(frozen=True, kw_only=True)
class StoneSoupReport(BenchReport):
    """``stonesoup.json``."""

    rows: tuple[Row, ...]


@click.command()
@click.option(
    "--quick", is_flag=True, help="A smoke run: one scene a size, small teams for the slow managers."
)
@click.option("--scenes", type=click.IntRange(min=1), default=3, show_default=True, help="Of each size.")
@command.out_option("JSON and table")
def bench(quick: bool, scenes: int, out: Path) -> None:
    """Measure Stone Soup's managers and ours, and say MET or MISSED. Exit status 0 either way."""
    folder = command.results_folder(out)
    machine.stay_on_one_core()
    about = machine.describe() | {"stonesoup": version("stonesoup")}
    click.echo(f"{about['machine']}; Stone Soup {about['stonesoup']}; commit {about['commit']}")
    rows = measure(quick, 1 if quick else scenes, lambda text: click.echo(f"  {text} ...", err=True))
    judged = judge(rows)
    text = markdown(HEADER, [row.cells() for row in rows], "rrlrrrrr") + "\n" + verdicts(judged)
    click.echo("\n" + text)
    name = "stonesoup-quick" if quick else "stonesoup"
    write_text(folder / f"{name}.md", text)
    criteria = tuple(each.judged() for each in judged)
    StoneSoupReport(about=about, quick=quick, measurements=criteria, rows=tuple(rows)).write(
        folder / f"{name}.json"
    )
    click.echo(f"written: {folder / name}.json, .md")


def measure(quick: bool, scenes: int, progress: Callable[[str], None]) -> list[Row]:
    """Return all rows, by size."""
    rows = []
    for radars in RADARS:
        for targets in sorted({8, 2 * radars}):
            progress(f"{radars} radars, {targets} targets")
            found = [decisions(radars, targets, seed, quick) for seed in range(scenes)]
            rows += table(radars, targets, found)
    return rows


def decisions(radars: int, targets: int, seed: int, quick: bool) -> dict[str, Decision]:
    """Let the managers that can decide one scene."""
    size = radars * targets
    names = [
        name
        for name, manager in MANAGERS.items()
        if size <= manager.most and (size <= QUICK_SIZE or manager.most == ANY or not quick)
        if manager.all_scenes or seed == 0
    ]
    made = scene(radars, targets, np.random.default_rng([radars, targets, seed]))
    return compare(made, names, searches=64 if quick else 512, repeats=1 if quick else None)


def table(radars: int, targets: int, found: Sequence[Mapping[str, Decision]]) -> list[Row]:
    """Return a row for every manager that decided at least one scene."""
    rows = []
    for name in MANAGERS:
        took_part = [each for each in found if name in each]
        if took_part:
            shares = [each[name].share for each in took_part]
            ratios = [each[name].cpu_s / each[GREEDY].cpu_s for each in took_part]
            cpu_s = median(each[name].cpu_s for each in took_part)
            rows.append(
                Row(radars, targets, name, cpu_s, median(ratios), fmean(shares), min(shares), len(shares))
            )
    return rows


def judge(rows: Sequence[Row]) -> list[Measurement]:
    """Hold our rows against what is asked: shares in the worst scene, CPU time in the median one."""
    by = {(row.radars, row.targets, row.manager): row for row in rows}
    exact = [by[row.radars, row.targets, OURS] for row in rows if row.manager == BRUTE]
    large = [row for row in rows if row.radars == LARGE and row.manager in (OURS, LOG_DET)]
    slowest = max(large, key=lambda row: row.of_greedy)
    return [
        Measurement(
            Criterion("share of brute force's reward", 0.99, "", at_least=True),
            min(row.worst for row in exact),
            f"worst of {sum(row.scenes for row in exact)} scenes, up to {exact[-1].radars} radars",
        ),
        Measurement(
            Criterion("share of the best known, 16 radars", 0.99, "", at_least=True),
            min(row.worst for row in large),
            "; ".join(f"{row.manager}, {row.targets} targets {row.worst:.4f}" for row in large),
        ),
        Measurement(
            Criterion("CPU over greedy's, 16 radars", 0.2, ""),
            slowest.of_greedy,
            "; ".join(f"{row.manager}, {row.targets} targets {row.of_greedy:.3f}" for row in large),
        ),
    ]


if __name__ == "__main__":
    command.run(bench, "bench.stonesoup")

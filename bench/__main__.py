"""``python -m bench``: speed and traffic on one core, side by side with what is asked."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import click

from bench import command, machine
from bench.criteria import BenchReport, Criterion, Measurement, verdicts
from bench.frontiers import Effort, measure_frontiers
from bench.heartbeats import measure_heartbeats
from bench.porous import WEARS, Site, measure_porous
from bench.scale import report as scale
from bench.speed import Run, run_mission

SMALL, LARGE = (30.0, 20.0), (100.0, 100.0)  # of offices at 0.1 m: 200x300 and 1000x1000 cells [m]
FULL_EFFORT = {SMALL: Effort(5, 2000, 5), LARGE: Effort(3, 500, 3)}
FULL_SITES = Site(15.0, 10.0, 0.05), Site(12.0, 10.0, 0.02)
QUICK_SITES = (Site(10.0, 10.0, 0.05, max_time=15.0),)
QUICK_EFFORT = {SMALL: Effort(1, 200, 2), LARGE: Effort(1, 50, 1)}


@click.command()
@click.option("--quick", is_flag=True, help="A smoke run: few repeats, short missions.")
@command.date_option
@command.out_option("the JSON")
def bench(quick: bool, date: str | None, out: Path) -> None:
    """Measure what the project has to reach, and say MET or MISSED. Exit status 0 either way.

    A smoke run measures too little for some verdicts and says NOT MEASURED.
    The scale table comes last: ``python -m bench.scale`` makes it alone.
    Teams of processes have a bench of their own, ``python -m bench.network``.
    """
    folder = command.results_folder(out)
    machine.stay_on_one_core()
    about = machine.describe()
    click.echo(f"{about['machine']}; Python {about['python']}; commit {about['commit']}")
    about |= {"date": date or about["commit_date"]}

    def progress(text: str) -> None:
        click.echo(f"  {text} ...", err=True)

    measurements = measure(quick, progress)
    click.echo("\n" + verdicts(measurements))
    click.echo("ratio: how many times better than asked")
    path = folder / ("bench-quick.json" if quick else "bench.json")
    judged = tuple(each.judged() for each in measurements)
    BenchReport(about=about, quick=quick, measurements=judged).write(path)
    click.echo(f"written: {path}\n")
    click.echo(scale.run(folder, about, quick, progress))


def measure(quick: bool, progress: Callable[[str], None]) -> list[Measurement]:
    """Return all measurements, in the order of the table."""
    effort = QUICK_EFFORT if quick else FULL_EFFORT
    progress("frontiers in 200x300 cells")
    small_frontiers = measure_frontiers(Criterion("frontiers, 200x300", 0.4, "ms"), *SMALL, effort[SMALL])
    progress("frontiers in 1000x1000 cells")
    large_frontiers = measure_frontiers(Criterion("frontiers, 1000x1000", 5.0, "ms"), *LARGE, effort[LARGE])
    small = []
    for seed in range(1 if quick else 3):
        progress(f"default mission, seed {seed}")
        small.append(run_mission(seed, *SMALL, robots=3, max_time=30.0 if quick else 3600.0))
    progress("mission in an office of 100x100 m")
    large = [run_mission(0, *LARGE, robots=4, max_time=20.0 if quick else 200.0)]
    porous = [
        measurement
        for site in (QUICK_SITES if quick else FULL_SITES)
        for measurement in measure_porous(site, WEARS[1:2] if quick else WEARS, progress)
    ]
    return [
        small_frontiers,
        large_frontiers,
        replan(Criterion("one replan, 200x300", 40.0, "ms"), small),
        replan(Criterion("one replan, 1000x1000", 400.0, "ms"), large),
        answer(Criterion("answering the token, 200x300", 3.0, "ms"), small),
        answer(Criterion("answering the token, 1000x1000", 3.0, "ms"), large),
        real_time(Criterion("default mission", 30.0, "x real time", at_least=True), small),
        sent(Criterion("negotiation sent by a robot", 800.0, "kB"), small, Run.negotiation),
        sent(Criterion("fusion sent by a robot", 250.0, "kB"), small, Run.fusion),
        *porous,
        measure_heartbeats(20.0, 20 if quick else 200),
    ]


def replan(criterion: Criterion, runs: Sequence[Run]) -> Measurement:
    """Judge the 95th percentile of the replans, in the worst of the missions."""
    worst = max(runs, key=lambda run: run.planning.p95)
    p50, top = worst.planning.p50, max(run.planning.max for run in runs)
    return Measurement(
        criterion,
        worst.planning.p95,
        f"p95, median {p50:.1f} ms, longest {top:.1f} ms; {worst.known:.0%} of the grid known in the end",
    )


def answer(criterion: Criterion, runs: Sequence[Run]) -> Measurement:
    """Judge the 95th percentile of the answers, in the worst of the missions."""
    worst = max(runs, key=lambda run: run.answer.p95)
    p50, top = worst.answer.p50, max(run.answer.max for run in runs)
    return Measurement(criterion, worst.answer.p95, f"p95, median {p50:.2f} ms, longest {top:.2f} ms")


def real_time(criterion: Criterion, runs: Sequence[Run]) -> Measurement:
    """Judge the slowest of the missions by wall time."""
    worst = min(runs, key=lambda run: run.real_time)
    length = f"{worst.summary.time_s:.0f} s long"
    note = f"wall time, slowest of {len(runs)}, {length}; {worst.cpu_time:.0f} x by CPU time"
    return Measurement(criterion, worst.real_time, note)


def sent(criterion: Criterion, runs: Sequence[Run], kilobytes: Callable[[Run], float]) -> Measurement:
    """Judge the robot that sent most in any of the missions."""
    each = ", ".join(f"{kilobytes(run):.0f}" for run in runs)
    return Measurement(criterion, max(map(kilobytes, runs)), f"most of any robot; by seed {each} kB")


if __name__ == "__main__":
    command.run(bench, "bench")

"""``python -m bench.network``: teams of real processes on this host, against what is asked of them.

With ``--modes``: teams with a member that misbehaves, so far as the results file does not have them.

The figures are wall-clock and mission times of processes that share the host's cores with whatever else runs:
the load is told beside them.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

import click
import numpy as np

from bench import command, machine
from bench.criteria import BenchReport, Criterion, Measurement, verdicts
from bench.members import ALL, modes_of, results, sizes_of, table
from tests.support.net_processes import (
    Chain,
    Diary,
    Fault,
    Mission,
    freeze,
    kill,
    leaf,
    overlay_rate,
    plan_of,
    root,
    run,
)
from vedette.cli.teams import SPEED
from vedette.maps.world import World
from vedette.net.launch import TeamProcesses
from vedette.sim.explore.run import explore, prepare
from vedette.sim.explore.simulation import ExploreSetup
from vedette.sim.worlds import office

LEASE = 3.0  # [s]
REST = 12.0  # in which a team that is done shows what the overlay needs [s]
EARLY = 0.1  # coverage at which faults come
AFTER = 15.0  # for which a team is watched after a fault, in a mission in real time [s]

Progress = Callable[[str], None]


@click.command()
@click.option("--quick", is_flag=True, help="A smoke run: a small office, few missions, nobody misbehaves.")
@click.option("--speed", default=SPEED, show_default=True, help="Of the mission that is compared.")
@click.option(
    "--modes", help=f"Only teams with a member that misbehaves so, with commas between: {', '.join(ALL)}."
)
@click.option("--robots", default="3,5", show_default=True, help="Of such teams, with commas between.")
@command.date_option
@command.out_option("the JSON")
def network(quick: bool, speed: float, modes: str | None, robots: str, date: str | None, out: Path) -> None:
    """Measure teams of processes, and say MET or MISSED. Exit status 0 either way."""
    folder = command.results_folder(out)
    about = machine.describe()
    click.echo(f"{about['machine']}; Python {about['python']}; commit {about['commit']}")
    wanted = modes_of(modes or "all"), sizes_of(robots)
    if modes is None:
        _measure_all(folder, about, quick, speed, date)
    if not quick or modes is not None:
        for each in results(folder / "members.jsonl", *wanted, speed, about["commit"]):
            click.echo(f"  {each.mode}, {each.robots} robots: {each.outcome}", err=True)
        click.echo(table(folder / "members.jsonl"), nl=False)


def _measure_all(folder: Path, about: dict[str, str], quick: bool, speed: float, date: str | None) -> None:
    about = about | {"date": date or about["commit_date"], "load_before": _load()}

    def progress(text: str) -> None:
        click.echo(f"  {text} (load {_load()}) ...", err=True)

    measurements = measure(quick, speed, progress)
    about |= {"load_after": _load()}
    click.echo(f"\nload {about['load_before']} before, {about['load_after']} after\n{verdicts(measurements)}")
    path = folder / ("network-quick.json" if quick else "network.json")
    judged = tuple(each.judged() for each in measurements)
    BenchReport(about=about, quick=quick, measurements=judged).write(path)
    click.echo(f"written: {path}")


def measure(quick: bool, speed: float, progress: Progress) -> list[Measurement]:
    """Return all measurements, in the order of the table."""
    rng = np.random.default_rng(0)
    world = office(rng, 12.0, 10.0) if quick else office(rng)
    seeds = 1 if quick else 3
    progress("the mission in one process")
    alone = _in_process(world)
    missions = []
    for number in range(seeds):
        progress(f"the same, a process a robot, {number + 1} of {seeds}")
        missions.append(_run(world, 3, speed, rest=REST))
    progress("a chain of eight")
    chain = _run(world, 8, 1.0, team=Chain, max_time=20.0 if quick else 90.0)
    return [
        completion(missions, alone, speed),
        overlay(missions[0]),
        rounds(chain),
        *recoveries(world, progress, quick),
    ]


def completion(missions: Sequence[Mission], alone: float, speed: float) -> Measurement:
    """Compare the mission time of processes with that of the same mission in one process."""
    times = [mission.report.summary.time_s for mission in missions]
    paces = [mission.report.timing.real_time_factor for mission in missions]
    done = all(mission.report.summary.completed for mission in missions)
    each = ", ".join(f"{time:.0f}" for time in times)
    return Measurement(
        Criterion("mission of 3 processes, of in-process", 1.15, ""),
        float(np.median(times)) / alone if done else np.inf,
        f"median of {each} s, in process {alone:.0f} s; at {min(paces):.2f} of {speed:g} times real time",
    )


def overlay(mission: Mission) -> Measurement:
    """Take what the overlay sends on a link when nothing happens."""
    rate = overlay_rate(mission.diary, mission.ended + 2.0, links=3)
    return Measurement(Criterion("steady overlay, a link", 200.0, "B/s"), rate, "both ways, team done")


def rounds(mission: Mission) -> Measurement:
    """Take the wall time of the rounds of a chain of eight."""
    took = mission.report.timing.round_ms
    criterion = Criterion("round of 8 on a chain", 600.0, "ms")
    if took is None:
        return Measurement(criterion, np.inf, "no round ended")
    count = max(mission.diary.last(i).rounds for i in range(8))
    note = f"p95, median {took.p50:.0f} ms, longest {took.max:.0f} ms, {count} rounds; in real time"
    return Measurement(criterion, took.p95, note)


def recoveries(world: World, progress: Progress, quick: bool) -> list[Measurement]:
    """Kill and freeze robots of teams in real time; judge how soon the others have a new plan."""
    roles = [root] if quick else [root, leaf]
    killed, frozen = [], []
    for role in roles:
        progress(f"kill -9, {role.__name__}")
        killed.append(_struck(world, kill(role), survivors_of=role))
        progress(f"SIGSTOP, {role.__name__}")
        frozen.append(_struck(world, freeze(role), survivors_of=role))
    return [
        _recovery(Criterion("new plan after kill -9", 1.0, "s"), killed),
        _recovery(Criterion("new plan after a silent cut", LEASE + 1.0, "s"), frozen),
    ]


def _struck(
    world: World, strike: Callable[[Diary], None], survivors_of: Callable[[Diary], int]
) -> tuple[float, float]:
    """Return after how long a loss was noticed, and a new plan made [s]."""
    lost: list[int] = []

    def note(diary: Diary) -> None:
        lost.append(survivors_of(diary))
        strike(diary)

    mission = _run(world, 3, 1.0, faults=[Fault(EARLY, "loss", note)], max_time=AFTER + 15.0)
    cost = mission.recovery_of([i for i in range(3) if i not in lost])
    return cost.noticed, cost.replanned


def _recovery(criterion: Criterion, costs: Sequence[tuple[float, float]]) -> Measurement:
    noticed = ", ".join(f"{notice:.2f}" for notice, _ in costs)
    planned = ", ".join(f"{plan:.2f}" for _, plan in costs)
    return Measurement(
        criterion, max(plan for _, plan in costs), f"worst of {planned} s; noticed after {noticed} s"
    )


def _in_process(world: World) -> float:
    """Return the mission time of the same team in one process [s]."""
    plan = plan_of(world, 3)
    return explore(prepare(world, plan.specs, ExploreSetup())).summary.time_s


def _run(
    world: World,
    robots: int,
    speed: float,
    faults: Sequence[Fault] = (),
    team: type[TeamProcesses] = TeamProcesses,
    max_time: float = 3600.0,
    rest: float = 0.0,
) -> Mission:
    with TemporaryDirectory(prefix="vedette-bench-") as logs:
        return run(plan_of(world, robots, speed, LEASE), Path(logs), faults, team, max_time, rest)


def _load() -> str:
    return f"{os.getloadavg()[0]:.1f}"


if __name__ == "__main__":
    command.run(network, "bench.network")

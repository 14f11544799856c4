"""``python -m bench.compare``: what a user would try instead, on cost and on value, in one table."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import fmean
from typing import Any

import click
import numpy as np
from numpy.typing import NDArray

from bench import command, machine
from bench.criteria import BenchReport
from bench.latency import Trip, play, root_of
from bench.scale.team import Team
from bench.speed import team
from bench.stonesoup.managers import MANAGERS, best_known, decide
from bench.stonesoup.scenario import THEN, Scene, scene
from bench.table import figure, markdown
from vedette.negotiation import Tree
from vedette.record.files import write_text
from vedette.sim.explore.run import explore, prepare
from vedette.sim.explore.simulation import ExploreSetup
from vedette.sim.worlds import office
from vedette.stonesoup.candidates import menus
from vedette.stonesoup.forecast import forecast
from vedette.stonesoup.objectives import REWARDS, StoneSoupTracks

RADARS, QUICK_RADARS = (2, 4, 8, 16), (2, 4)
SCENES = 3
HOP = 20.0  # [ms]
THEIRS = ("greedy", "brute force")  # of Stone Soup's managers
CENTRE = "greedy in a centre"
TREE = ("token", "fork")
ROBOTS, PLANNERS = (2, 4, 8), ("nearest", "burgard", "greedy", "tours")
WORLD = (20.0, 15.0)  # of the office [m]
HEADER = ("problem", "n", "who decides", "CPU [s]", "messages", "kB", "round at 20 ms [s]", "value")


@dataclass(frozen=True)
class Row:
    """One way to decide, on teams of one size; means over scenes or missions."""

    problem: str
    n: int
    way: str
    cpu_s: float | None  # of one decision, everybody's together
    messages: float | None  # of one decision
    kilobytes: float | None
    seconds: float | None  # until everybody knows, where a message takes 20 ms
    value: float  # share of the best known, or of the time that the best planner takes

    def cells(self) -> tuple[str, ...]:
        """Return the row of the table."""
        numbers = (self.cpu_s, self.messages, self.kilobytes, self.seconds)
        return (self.problem, str(self.n), self.way, *map(figure, numbers), f"{self.value:.3f}")


@dataclass(frozen=True, kw_only=True)
class CompareReport(BenchReport):
    """``compare.json``."""

    rows: tuple[Row, ...]


class TracksCodec:
    """Information about the tracks in view as bytes: number and upper triangle, four bytes a number."""

    def __init__(self, shape: tuple[int, ...]) -> None:
        self._shape = shape
        self._upper = np.triu_indices(shape[-1])

    def encode(self, impact: NDArray[np.float64]) -> bytes:
        """Return the tracks that there is information about."""
        seen = np.flatnonzero(impact.any(axis=(1, 2)))
        return bytes(seen.astype("<u2").tobytes() + impact[seen][:, *self._upper].astype("<f4").tobytes())

    def decode(self, data: bytes) -> NDArray[np.float64]:
        """Return the impact, to four bytes a number."""
        width = len(self._upper[0])
        count = len(data) // (2 + 4 * width)
        impact = np.zeros(self._shape)
        numbers = np.frombuffer(data, "<f4", count * width, 2 * count).reshape(count, width)
        seen = np.frombuffer(data, "<u2", count)
        impact[seen[:, None], self._upper[0], self._upper[1]] = numbers
        impact[seen[:, None], self._upper[1], self._upper[0]] = numbers
        return impact


def ours(made: Scene) -> Team:
    """Return the radars of a scene as a team, by Stone Soup's own reward."""
    ahead = forecast(made.tracks, made.predictor, THEN)
    found, _ = menus(set(made.sensors), set(), ahead, 10_000)
    belief = StoneSoupTracks.of(ahead.covariances, ahead.names)
    own = [[candidate.information for candidate in menu.candidates] for menu in found]
    places = np.zeros((len(own), 2))
    everywhere = [((-1e9, -1e9, 1e9, 1e9),)] * len(own)
    codec = TracksCodec(belief.roots.shape)
    return Team(REWARDS["uncertainty"], belief, places, own, everywhere, codec, 0)


def in_a_centre(problem: Team) -> tuple[float, int, int, float]:
    """Let one that knows everybody's candidates choose for all, one after the other, on the same kernels.

    Returns:
        CPU time [s], messages and bytes on a star, and the reward: lists come in, an index goes out.
    """
    began = time.process_time()
    team_ = problem.objective.nothing(problem.belief)
    for own in problem.candidates:
        best = int(np.argmax(problem.objective.values(problem.belief, team_, own)))
        team_ = problem.objective.combine(team_, own[best])
    cpu = time.process_time() - began
    told = sum(len(problem.codec.encode(each)) for own in problem.candidates[1:] for each in own)
    n = len(problem)
    return cpu, 2 * (n - 1), told + 2 * (n - 1), problem.objective.value(problem.belief, team_)


def radars(n: int, scenes: int) -> list[Row]:
    """Compare who decides where so many radars look."""
    found: dict[str, list[tuple[float | None, ...]]] = {}
    for seed in range(scenes):
        targets = max(8, 2 * n)
        made = scene(n, targets, np.random.default_rng([n, targets, seed]))
        problem, tree = ours(made), Tree.balanced(n)
        tries: dict[str, tuple[float | None, ...]] = {}
        for name in THEIRS:
            if n * targets <= MANAGERS[name].most:
                cpu, worth = decide(name, made, 1)
                tries[f"Stone Soup, {name}"] = cpu, None, None, None, worth
        cpu_s, messages, size, worth = in_a_centre(problem)
        tries[CENTRE] = cpu_s, float(messages), size / 1e3, 2.0 * HOP / 1e3 + cpu_s, worth
        for scheme in TREE:
            began = time.process_time()
            trip: Trip = play(problem, tree, root_of("balanced", tree)[0], scheme, (HOP,))
            cpu_s = time.process_time() - began
            numbers = float(trip.messages), trip.bytes / 1e3, float(trip.seconds[0])
            tries[f"a tree, {scheme}"] = cpu_s, *numbers, trip.outcome.value
        best = max(
            [best_known(made, "uncertainty", 64), *(float(each[-1] or 0.0) for each in tries.values())]
        )
        for name, numbers_ in tries.items():
            found.setdefault(name, []).append((*numbers_[:-1], float(numbers_[-1] or 0.0) / best))
    return [Row("radars, share of best", n, name, *_means(runs)) for name, runs in found.items()]


def _means(runs: Sequence[tuple[Any, ...]]) -> tuple[Any, ...]:
    """Return the mean of each number over the runs; None where there is none."""
    return tuple(None if None in column else fmean(column) for column in zip(*runs, strict=True))


def robots(n: int, seeds: Sequence[int], progress: Callable[[str], None]) -> list[Row]:
    """Compare planners that explore an office: frontier explorers, and negotiation, in and out of turn."""
    found: dict[str, list[tuple[Any, ...]]] = {}
    for seed in seeds:
        world = office(np.random.default_rng(seed), *WORLD)
        for planner in PLANNERS:
            progress(f"{n} robots, {planner}")
            began = time.process_time()
            report = explore(
                prepare(world, team(n), ExploreSetup(seed=seed, max_time=1200.0, planner=planner))
            )
            summary = report.summary
            rounds = max(summary.rounds, 1)
            sent = sum(each.negotiation for each in summary.bytes.values()) / 1e3 / rounds
            count = sum(each.negotiation for each in summary.messages.values()) / rounds
            cpu = (time.process_time() - began) / rounds
            found.setdefault(planner, []).append((cpu, count, sent, None, summary.t90_s, summary.time_s))
    rows = []
    for at, what in ((4, "90 % of an office"), (5, "a whole office")):
        means = {planner: fmean(float(run[at] or 1200.0) for run in runs) for planner, runs in found.items()}
        for planner, runs in found.items():
            cpu, count, sent, seconds = _means([run[:4] for run in runs])
            value = min(means.values()) / means[planner]
            rows.append(Row(f"{what}, best time over own", n, planner, cpu, count, sent, seconds, value))
    return rows


@click.command()
@click.option("--quick", is_flag=True, help="A smoke run: 2 and 4 radars, no missions.")
@click.option("--seeds", default=1, show_default=True, type=click.IntRange(1), help="Missions of each kind.")
@command.out_option("JSON and table")
def bench(quick: bool, seeds: int, out: Path) -> None:
    """Compare Stone Soup's managers, a centre, trees and frontier explorers. Exit status 0 either way."""
    folder = command.results_folder(out)
    machine.stay_on_one_core()

    def progress(text: str) -> None:
        click.echo(f"  {text} ...", err=True)

    rows: list[Row] = []
    for n in QUICK_RADARS if quick else RADARS:
        progress(f"{n} radars")
        rows += radars(n, 1 if quick else SCENES)
    for n in () if quick else ROBOTS:
        rows += robots(n, range(seeds), progress)
    text = markdown(HEADER, [row.cells() for row in rows], "lrlrrrrr")
    click.echo("\n" + text)
    path = folder / ("compare-quick.json" if quick else "compare.json")
    write_text(path.with_suffix(".md"), text)
    about = machine.describe()
    CompareReport(about=about, quick=quick, measurements=(), rows=tuple(rows)).write(path)
    click.echo(f"written: {path}, and beside it .md")


if __name__ == "__main__":
    command.run(bench, "bench.compare")

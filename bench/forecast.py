"""``python -m bench.forecast``: fits what is expected of explorations, and checks it on other worlds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import click
import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog

from bench import command
from bench.missions import tabulate
from bench.table import markdown
from vedette.missions.explore.expected import ENDED, KNOWN, Forecaster, Progress
from vedette.outcome import Outcome
from vedette.record.explore.log import ExploreLog
from vedette.record.summary import SCHEMA_VERSION
from vedette.sim.explore.run import explore, prepare
from vedette.sim.explore.simulation import ExploreSetup
from vedette.sim.worlds.by_name import generated
from vedette.team import PlatformSpec

FIT = (*range(30, 129), *range(500, 525))  # seeds
CHECK = (*range(1000, 1060), *range(1500, 1520))
LARGE = 500  # from this seed of each thousand on, worlds are large
AREAS = (105.0, 260.0), (260.0, 600.0)  # of small and large worlds [m^2]
MOMENTS = np.arange(0.08, 1.0, 0.06)  # of a mission's time, at which it is asked what it expects
LOW, HIGH = 0.1, 0.9  # quantiles
FOLDS = 6
SPREADS = 3  # features that the spread is a function of
PHASES = ((0.0, 0.25), (0.25, 0.5), (0.5, 0.75), (0.75, 1.01), (0.0, 1.01))  # of a mission's time


@dataclass(frozen=True)
class Foreseen:
    """One mission, drawn by its seed."""

    seed: int

    @property
    def key(self) -> int:
        """What tells it from all others."""
        return self.seed

    def __str__(self) -> str:
        """Name it in a line of progress."""
        return f"mission {self.seed}"


@dataclass(frozen=True)
class ForeseenResult:
    """How it went; one line of the results file."""

    seed: int
    world: str
    robots: int
    outcome: str
    t90_s: float | None
    time_s: float
    asked: list[tuple[float, tuple[float, ...]]]  # at which times [s], and what the expectation is of then
    commit: str
    schema_version: Literal[3] = SCHEMA_VERSION

    @property
    def key(self) -> int:
        """The mission's."""
        return self.seed


def run_foreseen(case: Foreseen, commit: str) -> ForeseenResult:
    """Run the mission of a seed: one to six robots of any kind in an office, cave or maze, large or small."""
    rng = np.random.default_rng([case.seed, 17])
    kind = ("office", "cave", "maze")[rng.integers(3)]
    large = case.seed % 1000 >= LARGE
    area, ratio = np.exp(rng.uniform(*np.log(AREAS[large]))), rng.uniform(0.6, 1.6)
    width, height = (max(round(float(np.sqrt(area * by)), 1), 10.0) for by in (ratio, 1.0 / ratio))
    robots = int(rng.integers(1, 6)) + large
    reach, speed = float(rng.choice([4.0, 6.0, 8.0, 12.0])), float(rng.choice([0.3, 0.5, 1.0]))
    specs = [PlatformSpec(f"robot-{i + 1}", range=reach, speed=speed) for i in range(robots)]
    world = generated(kind, case.seed, width, height)
    report = explore(prepare(world, specs, ExploreSetup(seed=case.seed)), curves_only=True)
    summary = report.summary
    return ForeseenResult(
        case.seed,
        f"{kind} {width:g} x {height:g} m",
        robots,
        outcome=summary.outcome.value,
        t90_s=summary.t90_s,
        time_s=summary.time_s,
        asked=asked(report.log, summary.time_s, robots),
        commit=commit,
    )


def asked(log: ExploreLog, end: float, robots: int) -> list[tuple[float, tuple[float, ...]]]:
    """Return what the expectation is a function of, at moments of a mission that was recorded."""
    forecaster, told = Forecaster(), []
    due = list(MOMENTS * end)
    ways = log.path_length.mean(axis=1)
    for k, (t, area, frontiers) in enumerate(zip(log.times, log.known_m2, log.frontiers, strict=True)):
        left = None if np.isnan(frontiers) else int(frontiers)
        now = Progress(float(t), float(area), left, float(ways[k]), robots)
        forecaster.add(now)
        if due and t >= due[0] - 1e-9:
            due.pop(0)
            features = forecaster.features(now)
            if features is not None:
                told.append((float(t), tuple(map(float, features))))
    return told


@dataclass(frozen=True, eq=False)
class Sample:
    """What was asked of missions, and what came of it."""

    x: NDArray[np.float64]  # (S, 6)
    known: NDArray[np.float64]  # (S,) ln(T / t) until 90 % are known
    ended: NDArray[np.float64]  # (S,) and to the end
    when: NDArray[np.float64]  # (S,) 0..1 of the mission's time
    mission: NDArray[np.int64]  # (S,)

    @classmethod
    def of(cls, results: Sequence[ForeseenResult]) -> Sample:
        """Take the missions that came to their end."""
        rows = [
            (features, np.log(max(each.t90_s, 1.0) / t), np.log(each.time_s / t), t / each.time_s, each.seed)
            for each in results
            if each.outcome == Outcome.COMPLETE and each.t90_s is not None
            for t, features in each.asked
        ]
        x, known, ended, when, mission = zip(*rows, strict=True)
        return cls(*map(np.array, (x, known, ended, when, mission)))

    def only(self, chosen: NDArray[np.bool_]) -> Sample:
        """Return a part of it."""
        return Sample(*(each[chosen] for each in vars(self).values()))


def quantile(x: NDArray[np.float64], y: NDArray[np.float64], level: float) -> NDArray[np.float64]:
    """Return the weights of the regressed quantile of ``y``: the least tilted absolute error."""
    rows, cols = x.shape
    cost = np.concatenate((np.zeros(2 * cols), np.full(rows, level), np.full(rows, 1.0 - level)))
    eye = np.eye(rows)
    solved = linprog(cost, A_eq=np.hstack((x, -x, eye, -eye)), b_eq=y, bounds=(0.0, None), method="highs")
    return np.asarray(solved.x[:cols] - solved.x[cols : 2 * cols])


def fitted(x: NDArray[np.float64], y: NDArray[np.float64], mission: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return ``(3, 6)`` weights of the low, the middle and the high quantile.

    The outer ones are moved apart until four in five lie between them where they were not fitted: of each
    sixth of the missions by the other five.
    """
    misses = []
    for fold in range(FOLDS):
        out = mission % FOLDS == fold
        low, _, high = (x[out] @ three_of(x[~out], y[~out]).T).T
        misses.append(np.maximum(low - y[out], y[out] - high))
    apart = float(np.quantile(np.concatenate(misses), HIGH - LOW))
    weights = three_of(x, y)
    weights[:, 0] += (-apart, 0.0, apart)
    return weights


def three_of(x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return ``(3, 6)`` weights of the median, and of what lies below and above it.

    How far that is is a function of the frontiers and of the share that was known at half the time alone, so
    that it grows neither with the area nor with the team.
    """
    median = quantile(x, y, 0.5)
    weights = np.tile(median, (3, 1))
    for row, level in ((0, LOW), (2, HIGH)):
        weights[row, :SPREADS] += quantile(x[:, :SPREADS], y - x @ median, level)
    return weights


def foretold(x: NDArray[np.float64], weights: Sequence[Sequence[float]], least: float) -> NDArray[np.float64]:
    """Return ``(S, 3)`` what the weights say of ``ln(T / t)``, none below the least, in order."""
    return np.asarray(np.maximum(np.sort(x @ np.array(weights).T, axis=1), least))


def checked(sample: Sample) -> list[list[str]]:
    """Return how many ends lie where the house's weights expect them, and how wide that is, by phase."""
    rows = []
    kinds = (("90 % known", sample.known, KNOWN, -np.inf), ("the end", sample.ended, ENDED, 0.0))
    for name, came, weights, least in kinds:
        low, middle, high = foretold(sample.x, weights, least).T
        inside = (low <= came + 1e-9) & (came <= high + 1e-9)
        for first, last in PHASES:
            phase = (first <= sample.when) & (sample.when < last)
            rows.append(
                [
                    name,
                    f"{100 * first:.0f} to {100 * min(last, 1.0):.0f} %",
                    str(np.count_nonzero(phase)),
                    f"{100 * inside[phase].mean():.0f} %",
                    f"{np.exp(np.median((high - low)[phase])):.2f}",
                    f"{np.exp(np.median(np.abs(middle - came)[phase])):.2f}",
                ]
            )
    return rows


def forecast_table(results: Sequence[ForeseenResult]) -> str:
    """Return the weights that the fitting missions give, and how the house's fare in the checking ones."""
    lines = []
    fit = [each for each in results if each.seed < CHECK[0]]
    if len(fit) >= FOLDS:
        sample = Sample.of(fit)
        for name, came in (("KNOWN", sample.known), ("ENDED", sample.ended)):
            weights = fitted(sample.x, came, sample.mission).tolist()
            told = ",\n".join(f"    ({', '.join(f'{each:.4f}' for each in row)})" for row in weights)
            lines.append(f"{name} = (\n{told},\n)  # of {len(np.unique(sample.mission))} missions\n")
    check = [each for each in results if each.seed >= CHECK[0]]
    if check:
        header = ["expected", "asked at", "times", "inside", "high / low", "middle off by"]
        lines.append(markdown(header, checked(Sample.of(check)), "llrrrr"))
        lines.append(f"of {len(check)} missions that nothing was fitted on\n")
    commits = ", ".join(sorted({each.commit for each in results}))
    return "\n".join([*lines, f"Commit: {commits}\n"])


@click.command()
@click.option("--fit", type=command.WholeNumbers(0), default=FIT, help="Seeds to fit on, below 1000.")
@click.option("--check", type=command.WholeNumbers(1000), default=CHECK, help="Seeds to check on.")
@command.jobs_option(1)
@command.fresh_option
@command.out_option("results and table")
def forecast(fit: tuple[int, ...], check: tuple[int, ...], jobs: int, fresh: bool, out: Path) -> None:
    """Fit and check what is expected of explorations; exit status 1 if a mission broke."""
    cases = [Foreseen(seed) for seed in (*fit, *check)]
    tabulate(cases, out, "forecast", jobs, fresh, run_foreseen, ForeseenResult, forecast_table)


if __name__ == "__main__":
    command.run(forecast, "python -m bench.forecast")

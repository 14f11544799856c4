"""``python -m bench.priority``: what a priority area in an office's farthest quarter brings, and costs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from statistics import median
from typing import Literal

import click
import numpy as np
from numpy.typing import NDArray

from bench import command
from bench.missions import tabulate
from bench.table import figure, markdown
from vedette.agent.orders import Priority
from vedette.maps import UNKNOWN
from vedette.maps.world import World
from vedette.record.explore.log import ExploreSnapshot
from vedette.record.explore.score import Reference
from vedette.record.summary import SCHEMA_VERSION
from vedette.sim.explore.run import ExploreRun, prepare
from vedette.sim.explore.simulation import ExploreSetup
from vedette.sim.orders import OrderAt
from vedette.sim.worlds.by_name import generated
from vedette.team import PlatformSpec

ROBOTS = 3
SIZE = 20.0, 15.0  # of the offices [m]
LEVEL = 0.9  # of what can be seen of the quarter, and of the rest
EARLIER, LATER = 0.80, 1.05  # asked of the median ratios to the mission without the order


@dataclass(frozen=True)
class Errand:
    """One mission in a generated office, with the order or without."""

    seed: int
    ordered: bool

    @property
    def key(self) -> tuple[int, bool]:
        """What tells it from all others."""
        return self.seed, self.ordered

    def __str__(self) -> str:
        """Name it in a line of progress."""
        return f"office {self.seed}, {'quarter first' if self.ordered else 'no order'}"


@dataclass(frozen=True)
class ErrandResult:
    """How it went; one line of the results file."""

    seed: int
    ordered: bool
    outcome: str
    quarter_s: float | None  # when 90 % of what can be seen of the quarter was known
    rest_s: float | None  # and of all else
    time_s: float
    commit: str
    schema_version: Literal[3] = SCHEMA_VERSION

    @property
    def key(self) -> tuple[int, bool]:
        """The mission's."""
        return self.seed, self.ordered


@dataclass
class Times:
    """A sink that notes when parts of the ground are known."""

    parts: Sequence[NDArray[np.bool_]]  # (R, C) each
    at: dict[int, float] = field(default_factory=dict)  # by part [s]

    def update(self, snapshot: ExploreSnapshot) -> None:
        """Look at all parts that are not known yet."""
        for k, part in enumerate(self.parts):
            if k not in self.at and (snapshot.classes[part] != UNKNOWN).mean() >= LEVEL:
                self.at[k] = snapshot.t


def farthest_quarter(world: World, starts: NDArray[np.float64]) -> tuple[tuple[float, float], ...]:
    """Return the corners [m] of that quarter of a world whose middle is farthest from the mean start."""
    x0, x1, y0, y1 = world.frame.extent
    xs, ys = (x0, (x0 + x1) / 2.0, x1), (y0, (y0 + y1) / 2.0, y1)
    here = starts[:, :2].mean(axis=0)

    def away(k: tuple[int, int]) -> float:
        col, row = k
        return float(
            np.hypot((xs[col] + xs[col + 1]) / 2.0 - here[0], (ys[row] + ys[row + 1]) / 2.0 - here[1])
        )

    col, row = max(((col, row) for col in (0, 1) for row in (0, 1)), key=away)
    left, right, low, high = xs[col], xs[col + 1], ys[row], ys[row + 1]
    return (left, low), (right, low), (right, high), (left, high)


def run_errand(case: Errand, commit: str) -> ErrandResult:
    """Run one mission to its end."""
    world = generated("office", case.seed, *SIZE)
    specs = [PlatformSpec(name=f"robot-{number}") for number in range(1, ROBOTS + 1)]
    plain = prepare(world, specs, ExploreSetup(seed=case.seed))
    quarter = Priority(area="quarter", corners=farthest_quarter(world, plain.starts))
    orders = (OrderAt(0.0, quarter),) if case.ordered else ()
    simulation = prepare(world, specs, ExploreSetup(seed=case.seed, orders=orders))
    coverable = Reference(world, simulation.specs, simulation.starts).coverable
    (left, low), _, (right, high), _ = quarter.corners
    x, y = world.frame.centres(np.arange(world.frame.size)).T.reshape(2, *world.frame.shape)
    inside = (left <= x) & (x < right) & (low <= y) & (y < high)
    times = Times((coverable & inside, coverable & ~inside))
    summary = ExploreRun(simulation, (times,), curves_only=True).run().summary
    return ErrandResult(
        *case.key,
        outcome=summary.outcome.value,
        quarter_s=times.at.get(0),
        rest_s=times.at.get(1),
        time_s=summary.time_s,
        commit=commit,
    )


def priority_table(results: Sequence[ErrandResult]) -> str:
    """Return the ratios of times with the order to those without, world by world, and their medians."""
    told = {each.key: each for each in results}
    pairs = [
        (told[seed, True], told[seed, False])
        for seed in sorted({each.seed for each in results})
        if {(seed, True), (seed, False)} <= told.keys()
    ]
    ratios = [
        (_ratio(a.quarter_s, b.quarter_s), _ratio(a.rest_s, b.rest_s), a.time_s / b.time_s) for a, b in pairs
    ]
    rows = [(str(a.seed), *map(figure, each)) for (a, _), each in zip(pairs, ratios, strict=True)]
    middle = [median(column) for column in zip(*ratios, strict=True)]
    rows.append(("median", *map(figure, middle)))
    header = ("world", "quarter", "rest", "end")
    quarter, rest = ("MET" if ok else "MISSED" for ok in (middle[0] <= EARLIER, middle[1] <= LATER))
    commits = ", ".join(sorted({each.commit for each in results}))
    return (
        f"{markdown(header, rows, 'rrrr')}\n"
        f"quarter asked at most {EARLIER}: {quarter}; rest at most {LATER}: {rest}\nCommit: {commits}\n"
    )


def _ratio(ordered: float | None, plain: float | None) -> float:
    """Return how much later it was; who never got there was infinitely late."""
    if plain is None:
        return 1.0 if ordered is None else 0.0
    return float("inf") if ordered is None else ordered / plain


@click.command()
@command.seeds_option("1-20")
@command.jobs_option(1)
@command.fresh_option
@command.out_option("results and table")
def priority(seeds: tuple[int, ...], jobs: int, fresh: bool, out: Path) -> None:
    """Compare missions with and without a priority area; exit status 1 if one broke."""
    cases = [Errand(seed, ordered) for seed in seeds for ordered in (False, True)]
    tabulate(cases, out, "priority", jobs, fresh, run_errand, ErrandResult, priority_table)


if __name__ == "__main__":
    command.run(priority, "python -m bench.priority")

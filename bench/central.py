"""``python -m bench.central``: what a negotiation costs beside a centralised greedy on the same problem.

Platforms choose what to see of a strip of cells; how wide what they can choose from lies says whether they
get into each other's way. The greedy knows all candidates and gives every platform one, the best pair first;
it is lazy, and evaluates only what can still be best. Both work on one core, and in one process.
"""

from __future__ import annotations

import heapq
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import click
import numpy as np
from numpy.typing import NDArray

from bench import command, machine
from bench.table import figure, markdown
from vedette.negotiation import Tree, negotiate
from vedette.problem.coverage import Coverage
from vedette.record.files import write_text

CELLS = 64  # of the strip, a platform
SEEN = 24  # cells that a candidate sees
CANDIDATES = 32  # of a platform
WIDTHS = (1.0, 4.0, 16.0)  # of the strip from which a platform's candidates come, in shares of its part
SEEDS = 3

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class CentralRow:
    """Both on the same problems; medians over the seeds."""

    platforms: int
    width: float
    negotiation: float  # CPU [ms]
    greedy: float  # CPU [ms]
    ratio: float
    value: float  # of the negotiation's choice over the greedy's, the least


def problem(n: int, width: float, rng: np.random.Generator) -> tuple[Floats, list[list[Floats]]]:
    """Return weights ``(n * CELLS,)``, and each platform's candidates as miss probabilities of all cells."""
    weights = rng.uniform(0.0, 1.0, n * CELLS)
    candidates = []
    for i in range(n):
        middles = CELLS * (i + 0.5 + width * rng.uniform(-0.5, 0.5, CANDIDATES))
        candidates.append([_seen(len(weights), int(middle), rng) for middle in middles])
    return weights, candidates


def _seen(cells: int, middle: int, rng: np.random.Generator) -> Floats:
    misses = np.ones(cells)
    first = min(max(middle - SEEN // 2, 0), cells - SEEN)
    misses[first : first + SEEN] = rng.uniform(0.1, 0.9, SEEN)
    return misses


def lazy_greedy(weights: Floats, candidates: Sequence[Sequence[Floats]]) -> float:
    """Return the value of a choice that takes the best pair of platform and candidate, again and again."""
    left = weights.copy()  # what the team as chosen so far leaves
    bounds = [
        (-float(np.vdot(left, 1.0 - misses)), i, k)
        for i, own in enumerate(candidates)
        for k, misses in enumerate(own)
    ]
    heapq.heapify(bounds)
    chosen, value = set[int](), 0.0
    while len(chosen) < len(candidates):
        _, i, k = heapq.heappop(bounds)
        if i in chosen:
            continue
        gain = float(np.vdot(left, 1.0 - candidates[i][k]))
        if bounds and -gain > bounds[0][0]:
            heapq.heappush(bounds, (-gain, i, k))
            continue
        chosen.add(i)
        value += gain
        left *= candidates[i][k]
    return value


def central_row(n: int, width: float) -> CentralRow:
    """Measure both on teams of ``n``."""
    took, values = [], []
    for seed in range(SEEDS):
        weights, candidates = problem(n, width, np.random.default_rng([n, seed]))
        began = time.thread_time()
        agreed = negotiate(Coverage(), weights, candidates, Tree.chain(n))
        between = time.thread_time()
        value = lazy_greedy(weights, candidates)
        took.append((1e3 * (between - began), 1e3 * (time.thread_time() - between)))
        values.append(agreed.value / value)
    negotiation, greedy = (float(np.median(column)) for column in zip(*took, strict=True))
    return CentralRow(n, width, negotiation, greedy, negotiation / greedy, min(values))


@click.command()
@click.option("--platforms", type=command.WholeNumbers(2), default="4,16,64,128", show_default=True)
@command.out_option("the table")
def central(platforms: tuple[int, ...], out: Path) -> None:
    """Measure CPU and value of negotiations over those of a centralised lazy greedy."""
    folder = command.results_folder(out)
    machine.stay_on_one_core()
    text = central_table([central_row(n, width) for n in platforms for width in WIDTHS])
    write_text(folder / "central.md", text)
    click.echo(text)


def central_table(rows: Sequence[CentralRow]) -> str:
    """Return a line a kind of team."""
    header = ("platforms", "choose over", "negotiate [ms]", "lazy greedy [ms]", "CPU ratio", "value ratio")
    cells = [
        (str(row.platforms), *map(figure, (row.width, row.negotiation, row.greedy, row.ratio, row.value)))
        for row in rows
    ]
    return markdown(header, cells, "r" * len(header))


if __name__ == "__main__":
    command.run(central, "bench.central")

"""Ways to explore the same generated worlds: one line a mission, and a table of the ratios of their times."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from bench.table import markdown, ratio_cell
from vedette.record.summary import SCHEMA_VERSION
from vedette.study.intervals import ratio_interval

TIMES = ("t90_s", "t99_s", "time_s")


@dataclass(frozen=True)
class Case:
    """One mission in a generated world."""

    world: str
    robots: int
    way: str
    seed: int

    @property
    def key(self) -> tuple[str, int, str, int]:
        """What tells it from all others."""
        return self.world, self.robots, self.way, self.seed

    def __str__(self) -> str:
        """Name it in a line of progress."""
        return f"{self.world} {self.seed}, {self.robots} robots, {self.way}"


@dataclass(frozen=True)
class Timed:
    """How long a mission took; one line of the results file."""

    world: str
    robots: int
    way: str
    seed: int
    outcome: str
    coverage: float | None
    t90_s: float | None
    t99_s: float | None
    time_s: float
    cpu_s: float
    commit: str
    schema_version: Literal[3] = SCHEMA_VERSION

    @property
    def key(self) -> tuple[str, int, str, int]:
        """The mission's."""
        return self.world, self.robots, self.way, self.seed


def ratio_table(results: Sequence[Timed], against: Sequence[tuple[str, str]]) -> str:
    """Return a line a kind of world and pair of ways: ratios of times in the same worlds, with intervals."""
    header = ("worlds", "robots", "", "pairs", "90 %", "99 %", "complete", "least coverage")
    by_key = {each.key: each for each in results}
    rows = []
    kinds = sorted({each.world for each in results})
    for robots in sorted({each.robots for each in results}):
        for worlds in [*([kind] for kind in kinds), *([kinds] if len(kinds) > 1 else [])]:
            for way, other in against:
                pairs = [
                    (each, by_key[each.world, robots, other, each.seed])
                    for each in results
                    if (each.robots, each.way) == (robots, way) and each.world in worlds
                    if (each.world, robots, other, each.seed) in by_key
                ]
                if pairs:
                    ratios = [_ratio(pairs, name) for name in TIMES]
                    least = min(each.coverage or 0.0 for each, _ in pairs)
                    name = worlds[0] if len(worlds) == 1 else "all"
                    told = (name, str(robots), f"{way} / {other}", str(len(pairs)), *ratios, f"{least:.4f}")
                    rows.append(told)
    commits = ", ".join(sorted({each.commit for each in results}))
    about = f"Ratios of times, geometric means, with t intervals of 95 % on logarithms. Commit: {commits}\n"
    return f"{markdown(header, rows, 'lrlrlllr')}\n{about}"


def _ratio(pairs: Sequence[tuple[Timed, Timed]], name: str) -> str:
    """Return the geometric mean of ratios; '-' where a share was not reached."""
    both = np.array([(getattr(one, name), getattr(other, name)) for one, other in pairs], np.float64)
    both = both[~np.isnan(both).any(axis=1)]
    if not len(both):
        return "-"
    return ratio_cell(ratio_interval(*both.T))

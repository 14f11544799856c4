"""``python -m bench.strangers``: how long robots that share no frame take beside those that share one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Literal

import click

from bench import command
from bench.missions import tabulate
from bench.table import figure, markdown
from vedette.record.summary import SCHEMA_VERSION
from vedette.sim.explore.run import ExploreRun, prepare
from vedette.sim.explore.simulation import ExploreSetup
from vedette.sim.worlds.by_name import generated
from vedette.team import PlatformSpec

ROBOTS = 3
SIZE = 20.0, 15.0  # of the offices [m]
ASKED, ERRORS = 1.15, 0.01  # of the median ratio of times to the end, and of any map's wrong cells
ARMS = {"known": {}, "unknown": {"frames": "unknown"}, "seeking": {"frames": "unknown", "rendezvous": True}}

Arm = Literal["known", "unknown", "seeking"]  # the last look for each other


@dataclass(frozen=True)
class StrangersCase:
    """One mission in a generated office."""

    seed: int
    arm: Arm

    @property
    def key(self) -> tuple[int, str]:
        """What tells it from all others."""
        return self.seed, self.arm

    def __str__(self) -> str:
        """Name it in a line of progress."""
        return f"office {self.seed}, {self.arm}"


@dataclass(frozen=True)
class StrangersResult:
    """How it went; one line of the results file."""

    seed: int
    arm: Arm
    outcome: str
    time_s: float
    t90_s: float | None
    coverage: float | None
    map_error_share: float
    joined_s: float | None  # when the last two components became one; None: they did not
    by_meeting: int  # joins
    commit: str
    schema_version: Literal[3] = SCHEMA_VERSION

    @property
    def key(self) -> tuple[int, str]:
        """The mission's."""
        return self.seed, self.arm


def run_strangers(case: StrangersCase, commit: str) -> StrangersResult:
    """Run one mission to its end."""
    specs = [PlatformSpec(name=f"robot-{number}") for number in range(1, ROBOTS + 1)]
    setup = ExploreSetup(seed=case.seed, **ARMS[case.arm])  # type: ignore[arg-type]
    simulation = prepare(generated("office", case.seed, *SIZE), specs, setup)
    summary = ExploreRun(simulation, curves_only=True).run().summary
    found = summary.frames
    whole = found is not None and len(found.components) == 1 and found.joins
    return StrangersResult(
        case.seed,
        case.arm,
        outcome=summary.outcome.value,
        time_s=summary.time_s,
        t90_s=summary.t90_s,
        coverage=summary.coverage,
        map_error_share=summary.map_error_share,
        joined_s=found.joins[-1].time_s if found is not None and whole else None,
        by_meeting=sum(join.by == "meeting" for join in found.joins) if found is not None else 0,
        commit=commit,
    )


def strangers_table(results: Sequence[StrangersResult]) -> str:
    """Return ratios of times to those with one frame, world by world, and their medians."""
    told = {each.key: each for each in results}
    rows, ends = [], list[float]()
    for seed in sorted({each.seed for each in results}):
        known, unknown, seeking = (told.get((seed, arm)) for arm in ARMS)
        if known is None or unknown is None:
            continue
        ends.append(unknown.time_s / known.time_s)
        rows.append(
            (
                str(seed),
                figure(known.time_s),
                figure(ends[-1]),
                figure(_ratio(unknown.t90_s, known.t90_s)),
                figure(None if seeking is None else seeking.time_s / known.time_s),
                figure(unknown.joined_s),
                f"{unknown.map_error_share:.2%}",
            )
        )
    header = ("world", "known [s]", "unknown", "to 90 %", "rendezvous", "one map after [s]", "wrong cells")
    worst = max((each.map_error_share for each in results), default=0.0)
    middle = median(ends) if ends else float("inf")
    said = "MET" if middle <= ASKED else "MISSED", "MET" if worst <= ERRORS else "MISSED"
    commits = ", ".join(sorted({each.commit for each in results}))
    return (
        f"{markdown(header, rows, 'rrrrrrr')}\n"
        f"median to the end of {len(ends)} worlds {middle:.2f}, asked at most {ASKED}: {said[0]}; "
        f"wrong cells {worst:.2%} at most, asked {ERRORS:.0%}: {said[1]}\nCommit: {commits}\n"
    )


def _ratio(unknown: float | None, known: float | None) -> float | None:
    return None if unknown is None or known is None else unknown / known


@click.command()
@command.seeds_option("1-20")
@command.jobs_option(1)
@command.fresh_option
@command.out_option("results and table")
def strangers(seeds: tuple[int, ...], jobs: int, fresh: bool, out: Path) -> None:
    """Compare teams that share no frame with teams that share one; exit status 1 if a mission broke."""
    arms: tuple[Arm, ...] = ("known", "unknown", "seeking")
    cases = [StrangersCase(seed, arm) for seed in seeds for arm in arms]
    tabulate(cases, out, "strangers", jobs, fresh, run_strangers, StrangersResult, strangers_table)


if __name__ == "__main__":
    command.run(strangers, "python -m bench.strangers")

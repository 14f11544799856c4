"""``python -m bench.monitoring``: how well six robots know a field, by how they decide, and what that takes.

Robots begin in one corner of 60 x 60 cells of 1 m. The error is compared at equal ways. SGP-Tools, which
needs an environment of its own, plans a way a robot beforehand, and they share what they measure.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import mean, median
from typing import Any, Literal

import click

from bench import command
from bench.missions import tabulate
from bench.sgp import ways
from bench.table import figure, markdown
from vedette.errors import check_word
from vedette.record.monitor.observer import MonitorReport
from vedette.record.summary import SCHEMA_VERSION
from vedette.run import DomainMission
from vedette.sim.domains import domain_of

OWN = ("negotiated", "shared", "none", "lawnmower", "random")
SGP = "sgptools"
COORDINATIONS = (*OWN, SGP)
ASKED, BUDGET_MS = 0.85, 50.0  # of the shared belief's error; CPU time of a replan

SIDE, DURATION = 60, 120.0  # of the area [m], of a mission [s]
STARTS = ((3, 3), (4, 3), (5, 3), (3, 4), (4, 4), (5, 4))  # where they are set down together [m]
FIELDS: dict[str, dict[str, Any]] = {
    "still": {"field": {"type": "drawn"}, "model": {"mean": 20, "deviation": 3, "length": 10}},
    "changing": {
        "field": {"type": "drawn"},
        "model": {"mean": 20, "deviation": 3, "length": 10, "lasting": 300},
    },
    "plume": {
        "field": {"type": "plume", "source": [20, 20], "wind": [0.15, 0.1]},
        "model": {"lasting": 300, "drift": [0.15, 0.1]},
    },
    "jacksboro": {"field": {"type": "jacksboro"}, "sensor": {"noise": 10}},
}


@dataclass(frozen=True)
class FieldCase:
    """One mission."""

    field: str
    coordination: str
    seed: int
    sgptools: str | None = None  # Python of the environment that has it

    @property
    def key(self) -> tuple[str, str, int]:
        """What tells it from all others."""
        return self.field, self.coordination, self.seed

    def __str__(self) -> str:
        """Name it in a line of progress."""
        return f"{self.field} {self.seed}, {self.coordination}"


@dataclass(frozen=True)
class FieldRun:
    """One mission; one line of the results file."""

    field: str
    coordination: str
    seed: int
    outcome: str
    time_s: float
    rmse: float  # in the end
    rmse_mean: float  # over the way
    nees: float
    worst_age_s: float
    planning_ms: float | None  # CPU time of a replan, median
    planning_p95_ms: float | None
    cpu_s: float
    commit: str
    schema_version: Literal[3] = SCHEMA_VERSION

    @property
    def key(self) -> tuple[str, str, int]:
        """The mission's."""
        return self.field, self.coordination, self.seed


def scenario(field: str) -> dict[str, Any]:
    """Return six robots in a corner of 60 x 60 cells."""
    return {
        "area": [0, 0, SIDE, SIDE],
        "cell": 1,
        "sensor": {"noise": 0.5},
        "vehicles": [{"start": list(start), "speed": 1} for start in STARTS],
        "duration": DURATION,
        "horizon": 40,
        "replan": 4,
        **FIELDS[field],
    }


def run_case(case: FieldCase, commit: str) -> FieldRun:
    """Run a mission and return what came of it."""
    began = time.process_time()
    domain, coordination, elsewhere = domain_of("monitor"), case.coordination, 0.0
    if coordination == SGP:
        planned = ways.ask(str(case.sgptools), domain.case(scenario(case.field)), case.seed)
        domain, coordination, elsewhere = ways.Given(planned), "lawnmower", planned.cpu_s
    mission = DomainMission[MonitorReport](domain, scenario(case.field), case.seed, coordination=coordination)
    report = mission.run(compare=False)
    summary, spent = report.summary, report.timing.planning_ms
    return FieldRun(
        *case.key,
        outcome=summary.outcome.value,
        time_s=summary.time_s,
        rmse=summary.rmse,
        rmse_mean=summary.rmse_mean,
        nees=summary.nees,
        worst_age_s=summary.worst_age_s,
        planning_ms=None if spent is None else spent.p50,
        planning_p95_ms=None if spent is None else spent.p95,
        cpu_s=time.process_time() - began + elsewhere,
        commit=commit,
    )


def monitoring_table(results: Sequence[FieldRun]) -> str:
    """Return a line a field and way of coordination; ratios are means over the seeds."""
    header = (
        "field", "coordination", "runs", "error, end", "over the way", "of shared's", "end, of lawn-mower's",
        "NEES", "worst age [s]", "replan [ms]",
    )  # fmt: skip
    rows = []
    for field, name in ((field, name) for field in FIELDS for name in COORDINATIONS):
        own = [each for each in results if each.key[:2] == (field, name)]
        if own:
            spent = [each.planning_ms for each in own if each.planning_ms is not None]
            figures = (
                mean(each.rmse for each in own),
                mean(each.rmse_mean for each in own),
                _against(results, own, "shared", "rmse_mean"),
                _against(results, own, "lawnmower", "rmse"),
                mean(each.nees for each in own),
                mean(each.worst_age_s for each in own),
                median(spent) if spent else None,
            )
            rows.append((field, name, str(len(own)), *map(figure, figures)))
    commits = ", ".join(sorted({each.commit for each in results}))
    about = (
        f"Asked: over the way at most {ASKED} of shared's, in the end at most 1 of the lawn-mower's, and "
        f"{BUDGET_MS:.0f} ms of CPU a replan. Commit: {commits}\n"
    )
    return f"{markdown(header, rows, 'llr' + 'r' * 7)}\n{about}"


def _against(results: Sequence[FieldRun], own: Sequence[FieldRun], other: str, what: str) -> float | None:
    """Return the mean ratio of a figure to that of another way of coordination, on the same seeds."""
    figures = {each.key: getattr(each, what) for each in results}
    ratios = [
        getattr(each, what) / figures[each.field, other, each.seed]
        for each in own
        if (each.field, other, each.seed) in figures
    ]
    return mean(ratios) if ratios else None


@click.command()
@click.option("--fields", default=",".join(FIELDS), show_default=True, help="By name, with commas.")
@click.option("--coordinations", default=",".join(OWN), show_default=True, help="By name, with commas.")
@click.option("--sgptools", metavar="PYTHON", help=f"Compare SGP-Tools too: {ways.HOW}.")
@command.seeds_option("0-4")
@command.jobs_option(2)
@command.fresh_option
@command.out_option("results and table")
def monitoring(
    fields: str,
    coordinations: str,
    sgptools: str | None,
    seeds: tuple[int, ...],
    jobs: int,
    fresh: bool,
    out: Path,
) -> None:
    """Tell how well six robots know a field; missions that are in the results file are not run again.

    Exit status 0 if all missions ran, however well, and 1 if one broke.
    """
    for word, known in ((fields, FIELDS), (coordinations, COORDINATIONS)):
        for each in word.split(","):
            check_word("name", each, known)
    names = coordinations.split(",")
    names += [SGP] if sgptools is not None and SGP not in names else []
    if SGP in names:
        ways.check(sgptools)
    cases = [
        FieldCase(field, name, seed, sgptools)
        for seed in seeds
        for field in fields.split(",")
        for name in names
    ]
    tabulate(cases, out, "monitoring", jobs, fresh, run_case, FieldRun, monitoring_table)


if __name__ == "__main__":
    command.run(monitoring, "bench.monitoring")

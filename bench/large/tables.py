"""The table of large missions, and what they have to reach."""

from __future__ import annotations

from collections.abc import Sequence

from bench.criteria import Criterion, Measurement, verdicts
from bench.large.cases import LargeResult, Size
from bench.large.trees import Version
from bench.table import figure, markdown
from vedette.outcome import Outcome

HEADER = (
    "mission", "", "real-time factor", "planning p50 [ms]", "p95 [ms]", "peak memory [MB]",
    "record [kB]", "sent by a robot [kB]", "simulated [s]", "known [%]",
)  # fmt: skip
MEGABYTE, KILOBYTE = 1e6, 1e3


def times(name: str, asked: float) -> Criterion:
    """Return a criterion of a real-time factor."""
    return Criterion(name, asked, "x real time", at_least=True)


FACTORS: dict[Size, Criterion] = {
    Size(30, 20, 0.1, 3): times("the default mission", 60.0),
    Size(60, 40, 0.1, 16): times("16 robots, 60x40 m", 10.0),
    Size(120, 80, 0.1, 16): times("16 robots, 120x80 m", 5.0),
    Size(60, 40, 0.1, 50): times("50 robots, 60x40 m", 3.0),
    Size(200, 200, 0.1, 50): times("50 robots, 200x200 m", 1.0),
    Size(200, 200, 0.05, 4): times("4 robots, 200x200 m at 0.05 m", 5.0),
}
MEMORY: dict[Size, Criterion] = {
    Size(200, 200, 0.1, 50): Criterion("50 robots, 200x200 m: peak memory", 1500.0, "MB")
}


def large_table(results: Sequence[LargeResult], versions: Sequence[Version]) -> str:
    """Return a line a mission and version, and how those of this version stand to what is asked."""
    when = {version.commit: version.when for version in versions}
    rows = [_row(result, when[result.commit]) for result in results]
    text = markdown(HEADER, rows, "llrrrrrrrr")
    measured = judge([result for result in results if when[result.commit] == "after"])
    if measured:
        text += f"\n{verdicts(measured)}"
    return f"{text}\nCommits: {', '.join(f'{each.when} {each.commit}' for each in versions)}\n"


def judge(results: Sequence[LargeResult]) -> list[Measurement]:
    """Hold the missions that something is asked of against it."""
    measured = []
    for result in results:
        note = "whole" if result.outcome != Outcome.TIME_LIMIT else f"its first {figure(result.time_s)} s"
        if result.size in FACTORS:
            measured.append(Measurement(FACTORS[result.size], result.factor, note))
        if result.size in MEMORY:
            measured.append(Measurement(MEMORY[result.size], result.peak_bytes / MEGABYTE, note))
    return measured


def _row(result: LargeResult, when: str) -> tuple[str, ...]:
    return (
        str(result.size),
        when,
        figure(result.factor),
        figure(result.planning_p50_ms),
        figure(result.planning_p95_ms),
        figure(result.peak_bytes / MEGABYTE),
        figure(result.record_bytes / KILOBYTE),
        figure(result.sent_bytes / KILOBYTE),
        figure(result.time_s),
        f"{100.0 * result.coverage:.1f}",
    )

"""The table of missions: one row a group and planner, and the criteria for the default planner."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from statistics import fmean, median

from bench.cases import OFFICE, Result
from bench.criteria import Criterion, Measurement
from bench.table import figure, markdown
from vedette.domains.mapping.planners import DEFAULT

JUDGED = DEFAULT  # has to meet the criteria; the others are yardsticks
HEADER = (
    "missions",
    "planner",
    "complete",
    "coverage, least [%]",
    "map errors, most [%]",
    "collisions",
    "t90, mean [s]",
    "t99, mean [s]",
    "time, mean [s]",
    "time, median [s]",
    "path, mean [m]",
)
COMPLETE = Criterion("missions complete", 100.0, "%", at_least=True)
CRITERIA: tuple[tuple[Criterion, Callable[[Result], float]], ...] = (
    (Criterion("coverage", 99.5, "%", at_least=True), lambda result: 100.0 * result.coverage),
    (Criterion("map errors of known cells", 0.5, "%"), lambda result: 100.0 * result.map_error_share),
    (Criterion("collisions", 0.0, ""), lambda result: float(result.collisions)),
)


def missions_table(results: Sequence[Result]) -> str:
    """Return the Markdown table of all missions: offices by team size, then each map."""
    rows: dict[tuple[str, str], list[Result]] = {}
    for result in results:
        rows.setdefault((_group(result), result.planner), []).append(result)
    return markdown(HEADER, [_row(*names, group) for names, group in rows.items()], "ll" + "r" * 9)


def judge(results: Sequence[Result]) -> list[Measurement]:
    """Hold every mission of the default planner against the criteria; the worst one counts and is named."""
    judged = [result for result in results if result.planner == JUDGED]
    if not judged:
        return []
    return [_complete(judged), *(_worst(criterion, figure_of, judged) for criterion, figure_of in CRITERIA)]


def _complete(results: Sequence[Result]) -> Measurement:
    incomplete = [f"{_name(result)} ({result.outcome})" for result in results if not result.completed]
    share = 100.0 * (1.0 - len(incomplete) / len(results))
    return Measurement(COMPLETE, share, f"all {len(results)}" if not incomplete else "; ".join(incomplete))


def _worst(
    criterion: Criterion, figure_of: Callable[[Result], float], results: Sequence[Result]
) -> Measurement:
    worst = (min if criterion.at_least else max)(results, key=figure_of)
    missed = sum(not criterion.met(figure_of(result)) for result in results)
    note = f"in all {len(results)}" if not missed else f"missed by {missed}, most by {_name(worst)}"
    return Measurement(criterion, figure_of(worst), note)


def _name(result: Result) -> str:
    return f"{_group(result)}, seed {result.seed}"


def _group(result: Result) -> str:
    world = "offices" if result.world == OFFICE else result.world
    return f"{world}, {result.robots} robot{'s' if result.robots > 1 else ''}"


def _row(group: str, planner: str, results: Sequence[Result]) -> tuple[str, ...]:
    times = [result.time_s for result in results]
    return (
        group,
        planner,
        f"{sum(result.completed for result in results)}/{len(results)}",
        f"{100 * min(result.coverage for result in results):.2f}",
        f"{100 * max(result.map_error_share for result in results):.3f}",
        str(sum(result.collisions for result in results)),
        _mean_where_reached([result.t90_s for result in results]),
        _mean_where_reached([result.t99_s for result in results]),
        figure(round(fmean(times), 1)),
        figure(round(median(times), 1)),
        figure(round(fmean(result.path_m for result in results), 1)),
    )


def _mean_where_reached(times: Sequence[float | None]) -> str:
    """Return the mean time, with the share of missions that got so far where not all did."""
    reached = [time for time in times if time is not None]
    if not reached:
        return "-"
    share = "" if len(reached) == len(times) else f" ({len(reached)}/{len(times)})"
    return figure(round(fmean(reached), 1)) + share

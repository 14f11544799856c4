"""The report of a study: one HTML page with everything a reader needs to judge it, losses included."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from vedette.number import many
from vedette.study import page
from vedette.study.compare import Difference, difference, mean
from vedette.study.facets import Facet, margins, overview, planners
from vedette.study.intervals import LEVEL, Interval
from vedette.study.metrics import COSTS, PLANNING, QUALITY, TIMES, Metric, traffic
from vedette.study.provenance import Provenance
from vedette.study.rows import Row

_MOST_LISTED = 200  # of the runs that failed or are incomplete; the results have them all


@dataclass(frozen=True, eq=False)
class Findings:
    """All that a report tells of."""

    title: str
    rows: Sequence[Row]
    timing: Sequence[Row]
    missing: int  # runs that were not carried out
    reference: str
    spec: str  # the text of its file
    provenance: Provenance
    pictures: Path | None  # the folder with them; None: there are none


def report(findings: Findings) -> str:
    """Return the text of ``report.html``."""
    rows = findings.rows
    return page.page(
        findings.title,
        [
            *_made(findings),
            *_losses(findings),
            *([] if findings.pictures is None else _pictures(findings.pictures)),
            *_means("Times", rows, TIMES, bounds=True),
            *_differences(findings),
            *_means("What it costs", rows, COSTS),
            *_means("Maps", rows, QUALITY),
            *_means("Bytes sent by the team", rows, traffic(list(rows))),
            *_planning(findings),
            *_reading(findings),
            page.heading("The spec"),
            page.verbatim(findings.spec),
        ],
    )


def _made(findings: Findings) -> list[str]:
    made = findings.provenance
    lines = [
        ("command", made.command),
        ("made", made.made),
        ("vedette", f"{made.version}, code {made.code}"),
        ("machine", made.machine),
        ("Python", made.python),
        ("runs", f"{len(findings.rows)} of {len(findings.rows) + findings.missing}"),
    ]
    warning = f"Incomplete: {many(findings.missing, 'run')} missing. The same command goes on with them."
    return [
        page.table(("", ""), lines, left=2),
        *([page.paragraph(warning, warning=True)] if findings.missing else []),
    ]


def _losses(findings: Findings) -> list[str]:
    """List what went wrong first: a mean over what went right says nothing without it."""
    rows = findings.rows
    counts = []
    for name in planners(rows):
        own = [row for row in rows if row["planner"] == name]
        complete = sum(row["completed"] is True for row in own)
        broke = sum(bool(row["error"]) for row in own)
        counts.append((name, str(len(own)), str(complete), str(len(own) - complete - broke), str(broke)))
    lost = [row for row in rows if not row["completed"]]
    parts = [
        page.heading("Losses"),
        page.table(("planner", "runs", "complete", "incomplete", "broke"), counts),
    ]
    if not lost:
        return [*parts, page.paragraph("Every run is complete.")]
    parts.append(page.table(("run", "how it ended", "coverage [%]", "time [s]"), _listed(lost), left=2))
    if len(lost) > _MOST_LISTED:
        parts.append(page.paragraph(f"… and {len(lost) - _MOST_LISTED} more, in `results.csv`."))
    return parts


def _listed(lost: Sequence[Row]) -> list[tuple[str, str, str, str]]:
    return [
        (_name(row), str(row["error"] or row["outcome"]).replace("_", " "), *_how_far(row))
        for row in lost[:_MOST_LISTED]
    ]


def _how_far(row: Row) -> tuple[str, str]:
    share, time = row.get("coverage"), row.get("time_s")
    return (
        f"{100 * share:.1f}" if isinstance(share, int | float) else "–",
        _number(float(time)) if isinstance(time, int | float) else "–",
    )


def _name(row: Row) -> str:
    world = str(row["world"]) + ("" if row["world_seed"] is None else f" {row['world_seed']}")
    team = f"{many(int(row['robots'] or 0), 'robot')} {row['starts']}"
    return f"{world}, {team}, seed {row['seed']}, {row['planner']}"


def _pictures(folder: Path) -> list[str]:
    interval = f"{100 * LEVEL:.0f} % interval of the mean"
    return [
        page.heading("Unknown share against time"),
        page.picture(
            folder / "curves.png",
            f"Means over worlds and seeds, with the {interval}; a mission that has ended keeps its last "
            "value. Grey: what no team can be below.",
        ),
        page.heading("Times"),
        page.picture(
            folder / "metrics.png",
            f"Means with the {interval}. Hollow: not all runs have the figure. Grey: no team can be below.",
        ),
        page.heading("Information first or completion first"),
        page.picture(
            folder / "tradeoff.png",
            f"Completion against the area under the unknown share, means with the {interval}; low and left "
            "is better. Complete missions only.",
        ),
    ]


def _means(title: str, rows: Sequence[Row], metrics: Sequence[Metric], bounds: bool = False) -> list[str]:
    parts = [page.heading(title)]
    for facet in overview(rows):
        inside = facet.of(rows)
        lines = []
        for name in planners(rows):
            means = [mean(inside, name, metric) for metric in metrics]
            lines.append((name, *(_interval(m.interval) + _share(m.reached, m.runs) for m in means)))
        if bounds:
            means = [mean(inside, planners(inside)[0], metric) for metric in metrics]
            lines.append(("no team below", *(_number(m.bound) for m in means)))
        faint = [len(lines) - 1] if bounds else []
        header = ("planner", *(metric.label for metric in metrics))
        parts.append(page.table(header, lines, caption=str(facet), faint=faint))
    return parts


def _differences(findings: Findings) -> list[str]:
    others = [name for name in planners(findings.rows) if name != findings.reference]
    if not others:
        return []
    parts = [page.heading(f"Differences from {findings.reference} in the same cases")]
    header = ("planner", "", *(metric.label for metric in TIMES))
    for facet in dict.fromkeys((Facet(), *margins(findings.rows), *overview(findings.rows))):
        inside = facet.of(findings.rows)
        lines: list[Sequence[str]] = []
        for name in others:
            found = [difference(inside, name, findings.reference, metric) for metric in TIMES]
            lines.append((name, "difference", *(_interval(d.difference, signed=True) for d in found)))
            lines.append(("", "ratio", *(_interval(d.ratio, digits=3) for d in found)))
            lines.append(("", "lower : higher, of pairs", *map(_counts, found)))
            lines.append(("", "draws that ±5 % takes", *map(_needed, found)))
        parts.append(page.table(header, lines, left=2, caption=str(facet)))
    return parts


def _planning(findings: Findings) -> list[str]:
    by_team = sorted({int(str(row["robots"])) for row in findings.timing})
    lines = []
    for name in planners(findings.timing):
        for robots in by_team:
            inside = Facet((("robots", robots),)).of(findings.timing)
            means = [_plain_mean(inside, name, metric) for metric in PLANNING]
            lines.append((name, str(robots), *map(_number, means)))
    return [
        page.heading("Planning time"),
        page.paragraph(
            "CPU time of one robot for one replan, all sweeps included, and wall time of whole missions: "
            "means over runs, on the machine and with the load of that day."
        ),
        page.table(("planner", "robots", *(metric.label for metric in PLANNING)), lines),
    ]


def _plain_mean(rows: Sequence[Row], planner: str, metric: Metric) -> float:
    values = [v for row in rows if row["planner"] == planner and (v := metric.of(row)) is not None]
    return sum(values) / len(values) if values else math.nan


def _reading(findings: Findings) -> list[str]:
    reference = findings.reference
    lines = (
        "T50 to T99: simulated time until so many percent of what can be seen at all are known; total: until "
        "the team agrees that nothing is left; AUC: area under the unknown share.",
        "Figures are mean [low, high], Student's t interval at 95 % over draws of world and seed. Runs in "
        "the same draw are averaged first, for they are not independent.",
        "n/m: only n of m runs have the figure; total, AUC and costs are of complete missions only. Where "
        "something is missing, compare differences, not means.",
        f"Differences are planner minus {reference} and ratios planner over {reference}, in cases with the "
        "same world, starts, seed and all else. Ratios are averaged by their logarithms: twice as long and "
        "half as long make one. Below them, how many draws it takes until a ratio is known within 5 %.",
        "No team below: what even a team that knew the map could not beat, from the distance of the farthest "
        "cell and the area that sensors can sweep. The best that can be reached lies well above it.",
        "Deviation of areas seen: standard deviation between the robots of a team. Overlap: share of the "
        "known cells that two robots or more have seen.",
    )
    return [page.heading("How to read this"), page.bullets(lines)]


def _interval(interval: Interval, signed: bool = False, digits: int = 0) -> str:
    value = _number(interval.value, signed, digits)
    if not math.isfinite(interval.low):
        return value
    return f"{value} [{_number(interval.low, signed, digits)}, {_number(interval.high, signed, digits)}]"


def _number(value: float, signed: bool = False, digits: int = 0) -> str:
    """Return a number with three digits that count, or so many decimals, ``–`` where there is none."""
    if not math.isfinite(value):
        return "–"
    if not digits:
        digits = max(0, 2 - math.floor(math.log10(abs(value)))) if value else 0
        digits = min(digits, 3)
    text = f"{value:+.{digits}f}" if signed else f"{value:.{digits}f}"
    return text.replace("-", "−")


def _share(reached: int, runs: int) -> str:
    return "" if reached == runs else f" ({reached}/{runs})"


def _counts(found: Difference) -> str:
    return f"{found.lower} : {found.higher} of {found.pairs}"


def _needed(found: Difference) -> str:
    return f"{found.needed} (of {found.draws} this is)" if found.needed is not None else "–"

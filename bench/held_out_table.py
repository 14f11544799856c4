"""The table of held-out worlds: ratios of times in the same worlds, and whether they are what is asked.

A mission that does not get so far has no time for it, and a time that is at least that of its end. Such pairs
stay, and count against the planner that is judged: it is taken to have needed all the time that it was given,
another only the time until it ended.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from bench.criteria import Criterion, Measurement, verdicts
from bench.table import interval_cell, markdown, ratio_cell
from vedette.domains.mapping.planners import DEFAULT
from vedette.sim.worlds import GENERATORS
from vedette.study.compare import difference
from vedette.study.metrics import TIMES, TOTAL, Metric
from vedette.study.rows import Row

OURS, REFERENCE, NEAREST = DEFAULT, "burgard", "nearest"
SHARES: Mapping[str, Metric] = {
    "90 %": next(metric for metric in TIMES if metric.column == "t90_s"),
    "99 %": next(metric for metric in TIMES if metric.column == "t99_s"),
    "complete": TOTAL,
}
ASKED = {"90 %": 0.72, "99 %": 0.80, "complete": 0.92}  # of teams of ...
TEAMS = (3, 8)
ALONE = 0.94  # one robot, complete, of the nearest frontier's
ALL, REAL = "all", "real buildings"
HEADER = ("robots", "worlds", "of", "pairs", *SHARES, "unfinished", "draws", "for 5 %")


def report(rows: Sequence[Row]) -> str:
    """Return the table and the verdicts of the missions that came to an end."""
    whole = [row for row in rows if not row["error"]]
    lines = [_line(*each) for each in _groups(whole)]
    about = (
        f"{OURS}: geometric means of ratios of times in the same worlds, t intervals of 95 % on logarithms.\n"
        f"Unfinished by {OURS} and by the other: {OURS} counts as if it had taken all its time, the other\n"
        "as if it had been done when it ended. Draws are worlds and starts; so many take all ratios of a\n"
        "line to within 5 %."
    )
    table = markdown(HEADER, lines, "rllr" + "l" * len(SHARES) + "rrr")
    return f"{table}\n{about}\n\n{verdicts(judged(whole))}"


def counted(rows: Sequence[Row]) -> list[Row]:
    """Return the rows with a time for every share: what was not reached counts against the judged planner."""
    found: list[Row] = []
    for row in rows:
        instead = row["max_time"] if row["planner"] == OURS else row["time_s"]
        missing = {each.column: instead for each in SHARES.values() if each.of(row) is None}
        found.append({**row, **missing, "completed": True})
    return found


def judged(rows: Sequence[Row]) -> list[Measurement]:
    """Hold the ratios against what is asked."""
    measurements = []
    for robots in TEAMS:
        for share, asked in ASKED.items():
            criterion = Criterion(f"{robots} robots, {share}, of {REFERENCE}", asked, "")
            measurements.append(_measured(criterion, _of(rows, robots), REFERENCE, share))
    alone = Criterion(f"1 robot, complete, of {NEAREST}", ALONE, "")
    return [*measurements, _measured(alone, _of(rows, 1), NEAREST, "complete"), _worst_kind(rows)]


def _measured(criterion: Criterion, rows: Sequence[Row], against: str, share: str) -> Measurement:
    found = difference(counted(rows), OURS, against, SHARES[share])
    if not found.pairs:
        return Measurement(criterion, None, "no pairs")
    return Measurement(criterion, found.ratio.value, f"{interval_cell(found.ratio)}, {found.pairs} pairs")


def _worst_kind(rows: Sequence[Row]) -> Measurement:
    """Hold the highest ratio of all kinds of worlds, teams and shares against 1."""
    found = [
        (difference(counted(inside), OURS, against, metric), f"{worlds}, {robots} robots, {share}")
        for robots, worlds, against, inside in _groups(rows)
        if against == REFERENCE and worlds in (*GENERATORS, REAL)
        for share, metric in SHARES.items()
    ]
    criterion = Criterion(f"any kind of world, of {REFERENCE}", 1.0, "")
    if not found:
        return Measurement(criterion, None, "no pairs")
    worst, where = max(found, key=lambda each: each[0].ratio.value)
    above = sum(each.ratio.value > 1.0 for each, _ in found)
    note = f"{where}: {ratio_cell(worst.ratio)}; {above} of {len(found)} above"
    return Measurement(criterion, worst.ratio.value, note)


def _groups(rows: Sequence[Row]) -> Iterator[tuple[int, str, str, list[Row]]]:
    """Yield team, worlds, the planner compared with, and the rows; those that have pairs."""
    real = list(dict.fromkeys(str(row["world"]) for row in rows if _kind(row) == REAL))
    for robots in sorted({int(str(row["robots"])) for row in rows}):
        for against in (REFERENCE, NEAREST):
            for worlds in (ALL, *GENERATORS, REAL, *real):
                inside = [row for row in _of(rows, robots) if worlds in (ALL, _kind(row), row["world"])]
                if difference(counted(inside), OURS, against, TOTAL).pairs:
                    yield robots, worlds, against, inside


def _line(robots: int, worlds: str, against: str, rows: Sequence[Row]) -> tuple[str, ...]:
    found = [difference(counted(rows), OURS, against, metric) for metric in SHARES.values()]
    paired = {row["case"] for row in rows if row["planner"] == OURS}
    paired &= {row["case"] for row in rows if row["planner"] == against}
    unfinished = [
        sum(row["planner"] == name and row["case"] in paired and not _finished(row) for row in rows)
        for name in (OURS, against)
    ]
    needed = [each.needed for each in found]
    enough = "-" if None in needed else str(max(each for each in needed if each is not None))
    ratios = [ratio_cell(each.ratio) for each in found]
    shown = str(robots), worlds, against, str(found[0].pairs), *ratios
    return (*shown, f"{unfinished[0]} : {unfinished[1]}", str(found[0].draws), enough)


def _of(rows: Sequence[Row], robots: int) -> list[Row]:
    return [row for row in rows if row["robots"] == robots]


def _kind(row: Row) -> str:
    return str(row["world"]) if row["world"] in GENERATORS else REAL


def _finished(row: Row) -> bool:
    return all(metric.of(row) is not None for metric in SHARES.values())

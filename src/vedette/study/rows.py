"""Results as tidy tables: a run a row, a figure a column; as Parquet and as CSV."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TypeAlias

import pyarrow as pa
import pyarrow.parquet as pq

from vedette.record.files import atomic_path
from vedette.study.mission import RunResult
from vedette.study.run import Run, Value

Row: TypeAlias = Mapping[str, Value]


def figure_rows(results: Mapping[Run, RunResult]) -> list[Row]:
    """Return the runs with their figures in simulated time; the same runs give the same rows."""
    return _filled([{"case": run.case, **run.columns(), **result.figures} for run, result in results.items()])


def timing_rows(results: Mapping[Run, RunResult]) -> list[Row]:
    """Return the runs with their wall-clock figures, which differ from machine to machine."""
    return _filled([{"case": run.case, **_team(run), **result.timing} for run, result in results.items()])


def _team(run: Run) -> Row:
    columns = run.columns()
    return {name: columns[name] for name in ("planner", "world", "world_seed", "robots", "starts", "seed")}


def _filled(rows: Sequence[Row]) -> list[Row]:
    """Give all rows all columns, in the order in which they first appear in a row that has the most."""
    names = dict.fromkeys(name for row in sorted(rows, key=len, reverse=True) for name in row)
    return [{name: row.get(name) for name in names} for row in rows]


def write_rows(rows: Sequence[Row], path: Path) -> None:
    """Put ``path.parquet`` and ``path.csv`` in place, with the same columns."""
    names = list(rows[0]) if rows else []
    columns = {name: _array([row[name] for row in rows]) for name in names}
    with atomic_path(path.with_suffix(".parquet")) as temporary:
        pq.write_table(pa.table(columns), temporary)
    with (
        atomic_path(path.with_suffix(".csv")) as temporary,
        temporary.open("w", encoding="utf-8", newline="") as file,
    ):
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(names)
        writer.writerows([_text(row[name]) for name in names] for row in rows)


def _array(values: Sequence[Value]) -> pa.Array:
    """Return a column of one type; whole numbers among others become such."""
    if any(isinstance(value, float) for value in values):
        values = [float(value) if isinstance(value, int) else value for value in values]
    return pa.array(values)


def _text(value: Value) -> Value:
    return str(value).lower() if isinstance(value, bool) else value

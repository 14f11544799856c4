"""What a part of the reproduction leaves: words, tables, a picture, and for a claim a verdict."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import TypeAlias

from vedette.record.files import atomic_path

Value: TypeAlias = str | int | float | bool | None


class Verdict(StrEnum):
    """How a claim of the paper fares."""

    HOLDS = "holds"
    IN_PART = "holds in part"
    FAILS = "does not hold"


def judge(core: bool, whole: bool) -> Verdict:
    """Return the verdict on a claim whose core was found to hold or not, and that as a whole or not."""
    if not core:
        return Verdict.FAILS
    return Verdict.HOLDS if whole else Verdict.IN_PART


@dataclass(frozen=True)
class Table:
    """Rows of one kind; the report shows them all unless there are too many."""

    name: str  # of the CSV file, without its suffix
    title: str
    columns: tuple[str, ...]  # with units
    rows: tuple[tuple[Value, ...], ...]
    wall_clock: bool = False  # differs from run to run, so it is kept apart from the data
    shown: bool = True  # in the report; otherwise only as CSV

    def groups(self) -> dict[str, list[tuple[Value, ...]]]:
        """Return the rows by what their first column names, in order."""
        found: dict[str, list[tuple[Value, ...]]] = {}
        for row in self.rows:
            found.setdefault(str(row[0]), []).append(row)
        return found


@dataclass(frozen=True)
class Section:
    """A figure or a claim of the paper, and what came out."""

    key: str  # "fig-1", "c3"
    title: str
    paper: str  # what the paper says or shows
    found: tuple[str, ...]  # what came out, a paragraph each; `code` between backquotes
    verdict: Verdict | None = None  # None: a figure
    evidence: str = ""  # of a claim, the measured figures in one line
    tables: tuple[Table, ...] = ()
    pictures: tuple[str, ...] = ()  # files in the folder of figures
    but: str = ""  # of a claim that holds in part: where it does, and where not

    @property
    def name(self) -> str:
        """What comes before the colon of the title, such as ``C3``."""
        return self.title.split(": ", 1)[0]

    @property
    def judgement(self) -> str:
        """The verdict in words: ``holds in part: on a chain, not at a star's hub``."""
        told = "" if self.verdict is None else self.verdict.value
        return f"{told}: {self.but}" if self.verdict is Verdict.IN_PART and self.but else told

    @property
    def statement(self) -> str:
        """What comes after it."""
        return self.title.split(": ", 1)[1]


def table(
    name: str, title: str, columns: Sequence[str], rows: Sequence[Sequence[Value]], *, shown: bool = True
) -> Table:
    """Return a table of reproducible figures."""
    return Table(name, title, tuple(columns), tuple(tuple(row) for row in rows), shown=shown)


def wall_table(name: str, title: str, columns: Sequence[str], rows: Sequence[Sequence[Value]]) -> Table:
    """Return a table of wall-clock figures."""
    return Table(name, title, tuple(columns), tuple(tuple(row) for row in rows), wall_clock=True)


def plain_text(value: Value) -> str:
    """Return a value as CSV has it: floats to nine significant digits, nothing for ``None``."""
    if value is None:
        return ""
    if isinstance(value, bool):
        return "yes" if value else "no"
    return format(float(value), ".9g") if isinstance(value, float) else str(value)


def write_csv(table: Table, path: Path) -> None:
    """Put a table in place as CSV, a line of column names first."""
    with atomic_path(path) as temporary, temporary.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(table.columns)
        writer.writerows([plain_text(value) for value in row] for row in table.rows)


def column(rows: Sequence[Sequence[Value]], k: int) -> list[float]:
    """Return a column of numbers."""
    return [float(row[k] or 0.0) for row in rows]

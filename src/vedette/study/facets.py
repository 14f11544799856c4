"""Which runs of a study are looked at together: those that agree in what the study varies."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

from vedette.number import many
from vedette.study.rows import Row
from vedette.study.run import OF_PLATFORM, OF_SETUP, Value

# What a study can vary beside the planners; worlds and seeds of one kind are draws, not axes.
AXES = ("world", "robots", "starts", *OF_PLATFORM, *OF_SETUP)


@dataclass(frozen=True)
class Facet:
    """Runs that have these values in these columns; all runs if there are none."""

    where: tuple[tuple[str, Value], ...] = ()

    def __str__(self) -> str:
        """Name it."""
        return ", ".join(_words(column, value) for column, value in self.where) or "all"

    def of(self, rows: Sequence[Row]) -> list[Row]:
        """Return the rows in it."""
        return [row for row in rows if all(row[column] == value for column, value in self.where)]


def varied(rows: Sequence[Row]) -> dict[str, list[Value]]:
    """Return the axes in which the runs differ, with their values."""
    axes = {axis: _values(rows, axis) for axis in AXES}
    return {axis: values for axis, values in axes.items() if len(values) > 1}


def panels(rows: Sequence[Row]) -> list[list[Facet]]:
    """Return a grid of facets by the first two axes that vary; the other axes are averaged over."""
    axes = list(varied(rows).items())[:2]
    axes += [(axis, _values(rows, axis)) for axis in AXES[:2] if axis not in dict(axes)][: 2 - len(axes)]
    (down, rows_of), (across, cols_of) = axes
    return [[Facet(((down, a), (across, b))) for b in cols_of] for a in rows_of]


def margins(rows: Sequence[Row]) -> list[Facet]:
    """Return each value of each axis that varies, averaged over all others."""
    return [Facet(((axis, value),)) for axis, values in varied(rows).items() for value in values]


def cells(rows: Sequence[Row]) -> list[Facet]:
    """Return every combination of the values of all axes that vary."""
    axes = varied(rows)
    combinations = itertools.product(*axes.values())
    facets = [Facet(tuple(zip(axes, values, strict=True))) for values in combinations]
    return [facet for facet in facets if facet.of(rows)]


def overview(rows: Sequence[Row]) -> list[Facet]:
    """Return the facets that a reader sees first: the panels, then the axes that they average over."""
    shown = [facet for line in panels(rows) for facet in line if facet.of(rows)]
    axes = {column for facet in shown for column, _ in facet.where}
    return shown + [facet for facet in margins(rows) if facet.where[0][0] not in axes]


def planners(rows: Sequence[Row]) -> list[str]:
    """Return the planners of a study in their order."""
    return list(dict.fromkeys(str(row["planner"]) for row in rows))


def _values(rows: Sequence[Row], column: str) -> list[Value]:
    values = list(dict.fromkeys(row[column] for row in rows))
    numbers = [value for value in values if isinstance(value, int | float)]
    return [*sorted(numbers)] if len(numbers) == len(values) else values


def _words(column: str, value: Value) -> str:
    if column == "robots":
        return many(int(value or 0), "robot")
    if column == "world":
        return str(value)
    return f"{column.replace('_', ' ')} {'none' if value in (None, '') else value}"

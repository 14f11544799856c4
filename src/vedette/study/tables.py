"""The statistics of a study as tidy tables: means, and paired differences."""

from __future__ import annotations

import math
from collections.abc import Sequence

from vedette.study.compare import difference, mean
from vedette.study.facets import AXES, Facet, cells, margins, planners, varied
from vedette.study.intervals import Interval
from vedette.study.metrics import COMPARED, QUALITY, traffic
from vedette.study.rows import Row
from vedette.study.run import Value


def mean_rows(rows: Sequence[Row]) -> list[Row]:
    """Return a row for each combination of what the study varies, planner and metric."""
    found: list[Row] = []
    for facet in cells(rows):
        inside = facet.of(rows)
        for planner in planners(rows):
            for metric in (*COMPARED, *QUALITY, *traffic(list(rows))):
                each = mean(inside, planner, metric)
                found.append(
                    {
                        **_where(facet, rows),
                        "planner": planner,
                        "metric": metric.column,
                        "unit": metric.unit,
                        **_columns("mean", each.interval),
                        "bound": _number(each.bound),
                        "reached": each.reached,
                        "runs": each.runs,
                    }
                )
    return found


def difference_rows(rows: Sequence[Row], reference: str) -> list[Row]:
    """Return a row for each planner but the reference and metric: over all, along each axis, in each cell.

    A column of an axis is empty where all its values are taken together.
    """
    found: list[Row] = []
    for facet in dict.fromkeys((Facet(), *margins(rows), *cells(rows))):
        inside = facet.of(rows)
        for planner in planners(rows):
            if planner == reference:
                continue
            for metric in COMPARED:
                each = difference(inside, planner, reference, metric)
                found.append(
                    {
                        **_where(facet, rows),
                        "planner": planner,
                        "reference": reference,
                        "metric": metric.column,
                        "unit": metric.unit,
                        **_columns("difference", each.difference),
                        **_columns("ratio", each.ratio),
                        "lower": each.lower,
                        "higher": each.higher,
                        "pairs": each.pairs,
                        "left_out": each.left_out,
                        "draws": each.draws,
                        "needed": each.needed,
                    }
                )
    return found


def _where(facet: Facet, rows: Sequence[Row]) -> dict[str, Value]:
    """Return a column for each axis that varies, and for world and robots in any case."""
    fixed = {axis: rows[0][axis] for axis in AXES[:2]}
    return fixed | dict.fromkeys(varied(rows)) | dict(facet.where)


def _columns(name: str, interval: Interval) -> dict[str, Value]:
    return {
        name: _number(interval.value),
        f"{name}_low": _number(interval.low),
        f"{name}_high": _number(interval.high),
    }


def _number(value: float) -> float | None:
    return round(value, 6) if math.isfinite(value) else None

"""How the unknown share falls with time, averaged over runs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vedette.study.compare import Draw, draw
from vedette.study.intervals import mean_band
from vedette.study.mission import RunResult
from vedette.study.rows import Row
from vedette.study.run import Value

Curve = tuple[Sequence[float], Sequence[float]]  # times of change [s], unknown share from then on
POINTS = 240
_SHOWN_UNTIL = 0.005  # unknown share below which a curve has nothing more to show
CurvesOf = Mapping[tuple[Value, Value], RunResult]  # by case and planner


@dataclass(frozen=True, eq=False)
class Averaged:
    """Mean curves of one planner, with the 95 % interval of the mean."""

    mean: NDArray[np.float64]  # (T,)
    low: NDArray[np.float64]  # (T,)
    high: NDArray[np.float64]  # (T,)


def averaged(rows: Sequence[Row], curves: CurvesOf, times: NDArray[np.float64]) -> Averaged | None:
    """Return the mean unknown share of the runs of ``rows`` at ``times``; ``None`` if none came to an end."""
    stacked = _stacked(_found(rows, curves), times)
    return Averaged(stacked.mean(axis=0), *mean_band(stacked)) if len(stacked) else None


def lowest(rows: Sequence[Row], curves: CurvesOf, times: NDArray[np.float64]) -> NDArray[np.float64] | None:
    """Return the mean of what no team can be below in the cases of ``rows`` at ``times``."""
    cases = {row["case"]: row for row in rows if _of(row, curves).times}
    found = [
        (draw(row), (r.limit_times, r.limit_unknown))
        for row in cases.values()
        if (r := _of(row, curves)).limit_times
    ]
    return np.asarray(_stacked(found, times).mean(axis=0)) if found else None


def time_axis(rows: Sequence[Row], curves: CurvesOf, groups: Sequence[Sequence[Row]]) -> NDArray[np.float64]:
    """Return ``(POINTS,)`` times from 0 to where the mean of every group has nothing more to show."""
    ends = [r.times[-1] for row in rows if (r := _of(row, curves)).times]
    times = np.linspace(0.0, max(ends, default=1.0), 4 * POINTS)
    last = 1.0
    for group in groups:
        stacked = _stacked(_found(group, curves), times)
        if len(stacked):
            above = np.flatnonzero(stacked.mean(axis=0) > _SHOWN_UNTIL)
            last = max(last, float(times[above[-1]]) if len(above) else 0.0)
    return np.linspace(0.0, last, POINTS)


def at(curve: Curve, times: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a step function at ``times``: all is unknown before its first step, and the last one lasts."""
    steps = np.searchsorted(np.asarray(curve[0]), times, side="right")
    return np.append(1.0, curve[1])[steps]


def _found(rows: Sequence[Row], curves: CurvesOf) -> list[tuple[Draw, Curve]]:
    return [(draw(row), (r.times, r.unknown)) for row in rows if (r := _of(row, curves)).times]


def _stacked(found: Sequence[tuple[Draw, Curve]], times: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return ``(n, T)`` curves at ``times``, a draw each: those within a draw averaged."""
    groups: dict[Draw, list[NDArray[np.float64]]] = {}
    for place, curve in found:
        groups.setdefault(place, []).append(at(curve, times))
    return np.array([np.mean(group, axis=0) for group in groups.values()])


def _of(row: Row, curves: CurvesOf) -> RunResult:
    return curves[row["case"], row["planner"]]

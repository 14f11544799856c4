"""Planners side by side: means where the same is asked of them, and differences in the same cases."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from vedette.study.intervals import Interval, draws_needed, mean_interval, ratio_interval
from vedette.study.metrics import Metric
from vedette.study.rows import Row

Draw: TypeAlias = tuple[object, object]  # world, seed: what is drawn anew, and with it all runs in it


@dataclass(frozen=True)
class Mean:
    """A planner's mean over a facet; an interval is of the draws of worlds and seeds."""

    interval: Interval
    reached: int  # runs that have the figure
    runs: int
    bound: float  # mean of what it cannot be below; not a number if there is none


@dataclass(frozen=True)
class Difference:
    """A planner against the reference over a facet, in the cases where both have the figure."""

    difference: Interval  # planner minus reference
    ratio: Interval  # planner over reference
    lower: int  # cases in which the planner's figure is lower
    higher: int
    pairs: int
    left_out: int  # cases in which one of them has none
    draws: int  # of worlds and seeds that the pairs are of
    needed: int | None  # so that the ratio is known within 5 %; as `draws_needed`


def mean(rows: Sequence[Row], planner: str, metric: Metric) -> Mean:
    """Return the mean of a planner's figures over rows: within a draw first, then of the draws."""
    own = [row for row in rows if row["planner"] == planner]
    found = [(draw(row), value) for row in own if (value := metric.of(row)) is not None]
    bounds = [(draw(row), value) for row in own if (value := metric.bound_of(row)) is not None]
    values = by_draw(found)
    return Mean(
        mean_interval(values) if len(values) else Interval(math.nan),
        len(found),
        len(own),
        float(by_draw(bounds).mean()) if bounds else math.nan,
    )


def difference(rows: Sequence[Row], planner: str, reference: str, metric: Metric) -> Difference:
    """Return how a planner differs from the reference where all else is equal."""
    theirs = {row["case"]: metric.of(row) for row in rows if row["planner"] == reference}
    cases = [row for row in rows if row["planner"] == planner and row["case"] in theirs]
    pairs = [
        (draw(row), own, other)
        for row in cases
        if (own := metric.of(row)) is not None and (other := theirs[row["case"]]) is not None
    ]
    if not pairs:
        return Difference(Interval(math.nan), Interval(math.nan), 0, 0, 0, len(cases), 0, None)
    above = by_draw([(place, a) for place, a, _ in pairs])
    below = by_draw([(place, b) for place, _, b in pairs])
    return Difference(
        mean_interval(above - below),
        ratio_interval(above, below),
        sum(a < b for _, a, b in pairs),
        sum(a > b for _, a, b in pairs),
        len(pairs),
        len(cases) - len(pairs),
        len(above),
        draws_needed(above, below),
    )


def draw(row: Row) -> Draw:
    """Return the world and the seed of a run."""
    return row["world_id"], row["seed"]


def by_draw(values: Sequence[tuple[Draw, float]]) -> NDArray[np.float64]:
    """Return ``(n,)`` means within the draws: runs in one world are not independent of each other."""
    groups: dict[Draw, list[float]] = {}
    for place, value in values:
        groups.setdefault(place, []).append(value)
    return np.array([np.mean(group) for group in groups.values()])

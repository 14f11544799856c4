"""The figures of monitoring: ``summary.json``, in simulated time only; and the last words."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from vedette.number import many, short
from vedette.record.log import Floats
from vedette.record.monitor.log import MonitorLog
from vedette.record.summary import MissionSummary, Traffic


@dataclass(frozen=True)
class MonitorQuality:
    """How well the field was known; what ways of coordination are compared by."""

    rmse: float  # in the end [unit]
    rmse_mean: float  # over the way that the team goes [unit]
    entropy_nat: float  # in the end
    entropy_mean_nat: float  # over time
    nees: float  # a cell, in the mean over time; 1 or less is not too sure
    worst_age_s: float  # that any place had in the second half
    mean_age_s: float  # of all places, in the mean over the second half
    way_m: float  # of a vehicle, in the mean

    @classmethod
    def of(cls, log: MonitorLog) -> MonitorQuality:
        """Return the figures of a log that is not empty."""
        _, ways, rmse = log.against("rmse")
        entropy, nees = (log.against(name)[2] for name in ("entropy", "nees"))
        later = log.snapshots[len(log.snapshots) // 2 :]
        return cls(
            rmse=float(rmse[-1]),
            rmse_mean=over_way(ways, rmse),
            entropy_nat=float(entropy[-1]),
            entropy_mean_nat=float(entropy.mean()),
            nees=float(nees.mean()),
            worst_age_s=max(each.worst_age for each in later),
            mean_age_s=float(np.mean([each.mean_age for each in later])),
            way_m=log.snapshots[-1].way,
        )


def over_way(ways: Floats, numbers: Floats) -> float:
    """Return the mean of numbers over the way (k,) [m] at which they were; over time where nobody moves."""
    span = float(ways[-1] - ways[0])
    return float(np.trapezoid(numbers, ways) / span) if span > 0.0 else float(numbers.mean())


@dataclass(frozen=True, kw_only=True)
class MonitorSummary(MissionSummary):
    """What one mission achieved; the fields are explained in ``docs/outputs.md``."""

    scenario: str
    coordination: str
    scheme: str
    fusion: str
    radio: str | None
    faults: str | None
    vehicles: int
    time_s: float
    cells: int
    mean: float
    deviation: float
    length_m: float
    lasting_s: float | None
    rmse: float
    rmse_mean: float
    entropy_nat: float
    entropy_mean_nat: float
    nees: float
    worst_age_s: float
    mean_age_s: float
    way_m: float
    path_m: Mapping[str, float]
    rounds: int
    sweeps: int
    bound_ratio: float | None
    messages: Mapping[str, Traffic]
    bytes: Mapping[str, Traffic]
    comparison: Mapping[str, MonitorQuality] = field(default_factory=dict)


def closing(summary: MonitorSummary, folder: Path) -> list[str]:
    """Say in a few lines how it went and where the pictures are."""
    lines = [
        f"{summary.outcome.said}: {many(summary.vehicles, 'vehicle')} measured {summary.cells} cells for "
        f"{summary.time_s:.0f} s; error {short(summary.rmse)} (rms) in the end, "
        f"{short(summary.rmse_mean)} over the way, NEES {summary.nees:.2f} a cell",
        f"a place was last looked at {summary.mean_age_s:.0f} s ago in the mean, {summary.worst_age_s:.0f} s "
        "at worst",
    ]
    if summary.comparison:
        each = (f"{name} {short(quality.rmse)}" for name, quality in summary.comparison.items())
        lines.append(f"error in the end: {', '.join(each)}")
        each = (f"{name} {short(quality.rmse_mean)}" for name, quality in summary.comparison.items())
        lines.append(f"error over the way: {', '.join(each)}")
    return [*lines, f"pictures: {folder / 'field.png'}, {folder / 'curves.png'}; all else beside them"]

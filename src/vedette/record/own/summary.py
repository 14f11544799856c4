"""The figures of a mission of an own domain: ``summary.json``, in simulated time only; and the last words."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from vedette.number import many
from vedette.record.summary import MissionSummary, Traffic


@dataclass(frozen=True, kw_only=True)
class OwnSummary(MissionSummary):
    """What one mission achieved; the fields are explained in ``docs/outputs.md``."""

    domain: str
    scenario: str
    coordination: str
    scheme: str
    fusion: str
    radio: str | None
    faults: str | None
    vehicles: int
    time_s: float
    figures: Mapping[str, float]  # in the end
    mean_figures: Mapping[str, float]  # over time
    path_m: Mapping[str, float]
    rounds: int
    sweeps: int
    bound_ratio: float | None
    messages: Mapping[str, Traffic]
    bytes: Mapping[str, Traffic]
    comparison: Mapping[str, Mapping[str, float]] = field(default_factory=dict)  # mean figures


def closing(summary: OwnSummary, folder: Path) -> list[str]:
    """Say in a few lines how it went and where the pictures are."""
    figures = ", ".join(f"{name} {value:.4g}" for name, value in summary.figures.items())
    lines = [
        f"{summary.outcome.said}: {summary.scenario} by {many(summary.vehicles, 'vehicle')} for "
        f"{summary.time_s:.0f} s; {figures} in the end"
    ]
    for name, value in summary.mean_figures.items():
        if summary.comparison:
            others = (f"{how} {told[name]:.4g}" for how, told in summary.comparison.items())
            lines.append(f"{name}, mean over time: {', '.join(others)}, {summary.coordination} {value:.4g}")
    return [*lines, f"pictures: {folder / 'ways.png'}, {folder / 'curves.png'}; all else beside them"]

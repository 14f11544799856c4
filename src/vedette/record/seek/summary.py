"""The figures of a search in an unknown building: ``summary.json``, in simulated time only."""

from __future__ import annotations

from dataclasses import dataclass

from vedette.record.explore.summary import ExploreSummary


@dataclass(frozen=True, kw_only=True)
class SeekSummary(ExploreSummary):
    """What exploring tells, and who found somebody when; the fields are explained in ``docs/outputs.md``."""

    order: str
    reach_m: float
    detection: float
    found_s: float | None
    found_by: str | None
    somebody: tuple[float, float]  # [m], team frame

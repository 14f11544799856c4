"""The figures of a search: ``summary.json``, in simulated time only."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vedette.domains.search.metrics import mean_time_to_detection
from vedette.record.summary import MissionSummary, Traffic


@dataclass(frozen=True)
class SearchQuality:
    """How soon some look truly reports the target; what the ways of coordination are compared by."""

    detection: float
    t50_s: float | None
    t90_s: float | None
    mean_time_s: float

    @classmethod
    def of(cls, times: NDArray[np.float64], detection: NDArray[np.float64]) -> SearchQuality:
        """Return the figures of a curve ``(K + 1,)``, the probability of detection by each time [s].

        The mean time is cut at the end of the search: ``E[min(T, t_K)]``, docs/search.md (V50).
        """
        return cls(
            detection=float(detection[-1]),
            t50_s=_passed(times, detection, 0.5),
            t90_s=_passed(times, detection, 0.9),
            mean_time_s=mean_time_to_detection(detection[1:], float(times[-1]) / max(1, len(times) - 1)),
        )


def ended_how(figures: Mapping[str, Any]) -> str:
    """Return how a search ended, by the fields of its summary, or of one vehicle's."""
    ended = str(figures["outcome"] or "so far").replace("_", " ")
    if figures.get("found_by") is not None:
        ended = f"found by {figures['found_by']} after {figures['found_s']:.0f} s"
    return f"{figures['coordination']}, {ended}" if "coordination" in figures else ended


@dataclass(frozen=True)
class Rule:
    """When a place is declared, where there are false alarms."""

    probability: float  # posterior that the target is within
    radius_m: float  # of it


@dataclass(frozen=True)
class Counted:
    """What was counted over many targets drawn from the prior; intervals of 95 %.

    Without false alarms a detection is a declaration, and never mistaken.
    """

    trials: int
    of: str  # "looks": others' looks at each target; "runs": a mission of its own for each
    found: float  # share of them
    found_low: float
    found_high: float
    mistaken: int  # declared where the target is not
    missed: int  # never declared
    mean_time_s: float
    mean_time_low_s: float | None  # None: of a single trial
    mean_time_high_s: float | None
    band: float
    off: float | None  # largest distance from the predicted curve; None: it predicts something else


@dataclass(frozen=True)
class IdealSearch:
    """A search that is ideal in some sense."""

    detection: float
    mean_time_s: float

    @classmethod
    def of(cls, times: NDArray[np.float64], detection: NDArray[np.float64]) -> IdealSearch:
        """Return the figures of a curve, as of a search's."""
        quality = SearchQuality.of(times, detection)
        return cls(quality.detection, quality.mean_time_s)


@dataclass(frozen=True, kw_only=True)
class SearchSummary(MissionSummary):
    """What one search achieved; the fields are explained in ``docs/outputs.md``."""

    scenario: str
    coordination: str
    scheme: str
    fusion: str
    worth: str
    radio: str | None
    faults: str | None
    vehicles: int
    time_s: float
    found_s: float | None
    found_by: str | None
    declared_m: tuple[float, float] | None
    target_m: tuple[float, float]
    error_m: float | None
    declare: Rule | None = None
    counted: Counted | None = None
    detection_then: float
    outside_then: float | None
    duration_s: float
    detection: float | None = None
    t50_s: float | None = None
    t90_s: float | None = None
    mean_time_s: float | None = None
    outside: float | None = None
    bound: IdealSearch
    koopman: IdealSearch
    path_m: Mapping[str, float]
    rounds: int
    sweeps: int
    bound_ratio: float | None
    messages: Mapping[str, Traffic]
    bytes: Mapping[str, Traffic]
    comparison: Mapping[str, SearchQuality] = field(default_factory=dict)


def _passed(times: NDArray[np.float64], detection: NDArray[np.float64], level: float) -> float | None:
    """Return when the curve first was at a level [s]."""
    reached = np.flatnonzero(detection >= level)
    return float(times[reached[0]]) if len(reached) else None

"""The figures of a search: ``summary.json``, in simulated time only."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from enum import StrEnum
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vedette.domains.search.metrics import mean_time_to_detection
from vedette.record.files import write_text
from vedette.record.plain import json_text, plain
from vedette.record.summary import Traffic

SCHEMA_VERSION = 2


class SearchOutcome(StrEnum):
    """Why a search ended."""

    FOUND = "found"  # a vehicle declared the target, and it is there
    MISTAKEN = "mistaken"  # a vehicle declared the target, and it is elsewhere
    TIME_LIMIT = "time_limit"  # the scenario's duration, or --max-time, passed
    INTERRUPTED = "interrupted"  # Ctrl-C
    TEAM_LOST = "team_lost"  # no vehicle is alive


@dataclass(frozen=True)
class Quality:
    """How soon a search finds its target; what the ways of coordination are compared by."""

    detection: float
    t50_s: float | None
    t90_s: float | None
    mean_time_s: float

    @classmethod
    def of(cls, times: NDArray[np.float64], detection: NDArray[np.float64]) -> Quality:
        """Return the figures of a curve ``(K + 1,)``, the probability of detection by each time [s].

        The mean time is cut at the end of the search: ``E[min(T, t_K)]``, docs/search.md (V50).
        """
        return cls(
            detection=float(detection[-1]),
            t50_s=_passed(times, detection, 0.5),
            t90_s=_passed(times, detection, 0.9),
            mean_time_s=mean_time_to_detection(detection[1:], float(times[-1]) / max(1, len(times) - 1)),
        )


@dataclass(frozen=True)
class Counted:
    """What was counted over many targets drawn from the prior; intervals of 95 %."""

    trials: int
    of: str  # "looks": others' looks at each target; "runs": a mission of its own for each
    detection: float
    detection_low: float
    detection_high: float
    mean_time_s: float
    mean_time_low_s: float
    mean_time_high_s: float
    band: float
    mistaken: int


@dataclass(frozen=True)
class Best:
    """A search that is ideal in some sense."""

    detection: float
    mean_time_s: float


@dataclass(frozen=True)
class SearchSummary:
    """What one search achieved; the fields are explained in ``docs/outputs.md``."""

    completed: bool
    outcome: SearchOutcome
    seed: int
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
    detection_then: float
    duration_s: float
    quality: Quality | None
    counted: Counted | None
    bound: Best
    koopman: Best
    path_m: Mapping[str, float]
    rounds: int
    sweeps: int
    bound_ratio: float | None
    messages: Mapping[str, Traffic]
    bytes: Mapping[str, Traffic]
    comparison: Mapping[str, Quality]
    schema_version: int = field(default=SCHEMA_VERSION, init=False)

    def to_json(self) -> str:
        """Return the text of ``summary.json``: the team's quality among the other fields, where it stands."""
        flat: dict[str, object] = {"schema_version": self.schema_version}
        for each in fields(self):
            value = getattr(self, each.name)
            if each.name == "quality":
                flat |= plain(value) if value else {part.name: None for part in fields(Quality)}
            else:
                flat[each.name] = plain(value)
        return json_text(flat)

    def write(self, path: Path | str) -> None:
        """Put ``summary.json`` in place."""
        write_text(path, self.to_json())


def _passed(times: NDArray[np.float64], detection: NDArray[np.float64], level: float) -> float | None:
    """Return when the curve first was at a level [s]."""
    reached = np.flatnonzero(detection >= level)
    return float(times[reached[0]]) if len(reached) else None

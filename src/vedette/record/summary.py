"""What the figures of all missions share: outcomes, traffic, and ``timing.json`` (wall clock)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

import numpy as np

from vedette.record.files import write_text
from vedette.record.plain import json_text

SCHEMA_VERSION = 2


class Outcome(StrEnum):
    """Why a mission ended."""

    COMPLETE = "complete"  # all agents agree that nothing reachable is worth seeing
    TIME_LIMIT = "time_limit"  # --max-time passed
    INTERRUPTED = "interrupted"  # Ctrl-C
    TEAM_LOST = "team_lost"  # no robot is alive
    NO_PROGRESS = "no_progress"  # living robots, work left, and no new route for anybody for too long


@dataclass(frozen=True)
class Traffic:
    """Messages or bytes that one robot sent, by kind: a field for each `vedette.agent.effects.Traffic`."""

    negotiation: int = 0
    fusion: int = 0
    beacons: int = 0
    overlay: int = 0  # hellos, acknowledgements, and what was sent again


@dataclass(frozen=True)
class Spread:
    """Order statistics of a set of durations."""

    p50: float
    p95: float
    max: float

    @classmethod
    def of(cls, samples: Sequence[float]) -> Spread | None:
        """Return the median, 95th percentile and maximum of the samples; ``None`` if there are none."""
        if not len(samples):
            return None
        p50, p95, top = np.percentile(samples, (50, 95, 100))
        return cls(float(p50), float(p95), float(top))


@dataclass(frozen=True)
class Timing:
    """Wall-clock figures of one mission: they differ from run to run, so they have a file of their own."""

    planning_ms: Spread | None  # all CPU time that one robot spends on one replan, all sweeps
    answer_ms: Spread | None  # CPU time to answer the token, a visit
    round_ms: Spread | None  # wall time of a round from end to end; None: rounds were simulated
    real_time_factor: float  # simulated / wall seconds
    wall_s: float

    def to_json(self) -> str:
        """Return the text of ``timing.json``."""
        return json_text(self)

    def write(self, path: Path | str) -> None:
        """Put ``timing.json`` in place."""
        write_text(path, self.to_json())

"""What the figures of all missions share: how they begin, traffic, and ``timing.json`` (wall clock)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal

import numpy as np

from vedette.outcome import Outcome
from vedette.record.files import write_text
from vedette.record.folder import OutputFolder
from vedette.record.plain import json_text

SCHEMA_VERSION: Final = 3  # of all JSON; goes up when a field changes its meaning or goes away


@dataclass(frozen=True, kw_only=True)
class Figures:
    """A file of figures, its fields in the order declared; ``docs/schemas`` says what may be in it."""

    schema_version: Literal[3] = SCHEMA_VERSION

    def to_json(self) -> str:
        """Return the text of the file: floats to 6 decimals."""
        return json_text(self)

    def write(self, path: Path | str) -> None:
        """Put the file in place."""
        write_text(path, self.to_json())


@dataclass(frozen=True, kw_only=True)
class MissionSummary(Figures):
    """What one mission achieved, in simulated time only: how every ``summary.json`` begins."""

    completed: bool
    outcome: Outcome
    lost: tuple[str, ...]  # robots that were lost on the way
    left: tuple[str, ...]  # robots that said goodbye before the end
    seed: int


@dataclass(frozen=True, kw_only=True)
class Setting:
    """How a mission was set up beside what its team agrees on, as ``summary.json`` tells it."""

    seed: int
    radio: str | None = None  # RANGE[,WALL_DB]; None: everybody hears everybody
    faults: str | None = None  # a file's name, or the seed of a schedule


@dataclass(frozen=True)
class Traffic:
    """Messages or bytes that one robot sent, by kind: a field for each `effects.TrafficKind`."""

    negotiation: int = 0
    fusion: int = 0
    beacons: int = 0
    overlay: int = 0  # hellos, acknowledgements, and what was sent again

    @property
    def total(self) -> int:
        """Of all kinds."""
        return self.negotiation + self.fusion + self.beacons + self.overlay


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


@dataclass(frozen=True, kw_only=True)
class Timing(Figures):
    """What one mission took, in wall and CPU time: it differs from run to run, so it has its own file."""

    planning_ms: Spread | None  # all CPU time that one robot spends on one replan, all sweeps
    answer_ms: Spread | None  # CPU time to answer the token, a visit
    round_ms: Spread | None  # wall time of a round from end to end; None: rounds were simulated
    real_time_factor: float  # simulated / wall seconds
    wall_s: float


def write_figures(summary: MissionSummary, timing: Timing, folder: OutputFolder) -> None:
    """Write ``summary.json`` and ``timing.json``."""
    summary.write(folder / "summary.json")
    timing.write(folder / "timing.json")

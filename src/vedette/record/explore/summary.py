"""The figures of an exploration: ``summary.json``, in simulated time only."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from vedette.outcome import Outcome
from vedette.record.files import write_text
from vedette.record.plain import json_text, plain
from vedette.record.summary import SCHEMA_VERSION, Traffic


@dataclass(frozen=True)
class ExploreSummary:
    """What one mission achieved, in simulated time only; the fields are explained in ``docs/outputs.md``."""

    completed: bool
    outcome: Outcome
    seed: int
    robots: int
    planner: str
    scheme: str
    fusion: str
    world: str
    radio: str | None
    faults: str | None
    time_s: float
    t50_s: float | None
    t90_s: float | None
    t95_s: float | None
    t99_s: float | None
    auc_s: float
    coverage: float
    map_errors: int
    map_error_share: float
    path_m: Mapping[str, float]
    overlap: float
    collisions: int
    min_clearance_m: float
    rounds: int
    sweeps: int
    bound_ratio: float | None
    apart_s: float
    messages: Mapping[str, Traffic]
    bytes: Mapping[str, Traffic]
    schema_version: int = field(default=SCHEMA_VERSION, init=False)

    def to_json(self) -> str:
        """Return the text of ``summary.json``: fields in the order declared, floats to 6 decimals."""
        return json_text({"schema_version": self.schema_version} | plain(self))

    def write(self, path: Path | str) -> None:
        """Put ``summary.json`` in place."""
        write_text(path, self.to_json())

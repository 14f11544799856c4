"""The figures of a tracking mission: ``summary.json``, in simulated time only."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vedette.outcome import Outcome
from vedette.record.files import write_text
from vedette.record.plain import json_text, plain
from vedette.record.summary import Traffic
from vedette.record.track.log import TrackLog

SCHEMA_VERSION = 2


@dataclass(frozen=True)
class Quality:
    """How well the targets were known; what the ways of coordination are compared by."""

    entropy_mean_nat: float
    entropy_final_nat: float
    position_rmse_m: float
    nees: float
    nees_in_band: float
    in_view: float

    @classmethod
    def of(cls, log: TrackLog) -> Quality:
        """Return the figures of a log that is not empty."""
        entropy, nees = log.curve(lambda s: s.entropy), log.curve(lambda s: s.nees)
        low, high = nees_band(dimensions(log))
        return cls(
            entropy_mean_nat=float(entropy.mean()),
            entropy_final_nat=float(entropy[-1]),
            position_rmse_m=float(np.sqrt(log.curve(lambda s: s.squared_error).mean())),
            nees=float(nees.mean()),
            nees_in_band=float(np.mean((low <= nees) & (nees <= high))),
            in_view=float(log.in_view().mean()),
        )


@dataclass(frozen=True)
class TrackSummary:
    """What one mission achieved; the fields are explained in ``docs/outputs.md``."""

    completed: bool
    outcome: Outcome
    seed: int
    scenario: str
    coordination: str
    scheme: str
    fusion: str
    objective: str
    continuous: bool
    radio: str | None
    faults: str | None
    vehicles: int
    targets: int
    time_s: float
    steps: int
    quality: Quality
    nees_band: tuple[float, float]
    in_view: Mapping[str, float]
    path_m: Mapping[str, float]
    rounds: int
    sweeps: int
    bound_ratio: float | None
    skipped: int
    messages: Mapping[str, Traffic]
    bytes: Mapping[str, Traffic]
    comparison: Mapping[str, Quality]
    schema_version: int = field(default=SCHEMA_VERSION, init=False)

    def to_json(self) -> str:
        """Return the text of ``summary.json``: the team's quality among the other fields, where it stands."""
        flat: dict[str, object] = {"schema_version": self.schema_version}
        for each in fields(self):
            value = plain(getattr(self, each.name))
            flat |= _of_team(value) if each.name == "quality" else {each.name: value}
        return json_text(flat)

    def write(self, path: Path | str) -> None:
        """Put ``summary.json`` in place."""
        write_text(path, self.to_json())


def dimensions(log: TrackLog) -> int:
    """Return how many numbers the states of all targets have."""
    return sum(4 if moving else 2 for moving in log.scene.moving)


def nees_band(dimensions: int) -> tuple[float, float]:
    """Return 2.5 % and 97.5 % quantiles of ``chi2_d / d`` for an even d: where a step's NEES lies.

    As ``P(chi2_d > x) = e^{-x/2} sum_{k < d/2} (x/2)^k / k!``, found by bisection.
    """
    k = np.arange(dimensions // 2)
    log_factorials = np.concatenate([[0.0], np.cumsum(np.log(k[1:]))])

    def above(ratio: float) -> float:
        half = ratio * dimensions / 2.0
        return float(np.exp(k * math.log(half) - half - log_factorials).sum())

    return _where(above, 0.975), _where(above, 0.025)


def _where(falling: Callable[[float], float], level: float) -> float:
    """Return where a falling function of a positive number passes a level."""
    low, high = 1e-9, 10.0
    for _ in range(60):
        middle = (low + high) / 2.0
        low, high = (middle, high) if falling(middle) > level else (low, middle)
    return (low + high) / 2.0


def squared_position_error(means: NDArray[np.float64], truth: NDArray[np.float64]) -> float:
    """Return the mean over targets of the squared error of the position [m^2]; both (T, 4)."""
    return float(np.square(means[:, :2] - truth[:, :2]).sum(axis=1).mean())


def _of_team(quality: dict[str, object]) -> dict[str, object]:
    """Name the share in view of all targets apart from that of each."""
    return {"in_view_mean" if name == "in_view" else name: value for name, value in quality.items()}

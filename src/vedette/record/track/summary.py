"""The figures of a tracking mission: ``summary.json``, in simulated time only."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from vedette.record.summary import MissionSummary, Traffic
from vedette.record.track.log import TrackLog, TrackScene

Consistency: TypeAlias = Literal["consistent", "overconfident", "cautious"]


@dataclass(frozen=True)
class TrackQuality:
    """How well the targets were known; what the ways of coordination are compared by.

    Scored from step 1 on: at step 0 there is the prior, which ways of fusion tell before its looks or after.
    """

    entropy_mean_nat: float
    entropy_final_nat: float
    position_rmse_m: float
    nees: float
    nees_in_band: float
    in_view: float

    @classmethod
    def of(cls, log: TrackLog) -> TrackQuality:
        """Return the figures of a log that is not empty."""
        first = min(1, len(log.snapshots) - 1)
        entropy, nees = log.curve(lambda s: s.entropy)[first:], log.curve(lambda s: s.nees)[first:]
        low, high = nees_band(dimensions(log.scene))
        return cls(
            entropy_mean_nat=float(entropy.mean()),
            entropy_final_nat=float(entropy[-1]),
            position_rmse_m=float(np.sqrt(log.curve(lambda s: s.squared_error)[first:].mean())),
            nees=float(nees.mean()),
            nees_in_band=float(np.mean((low <= nees) & (nees <= high))),
            in_view=float(log.in_view().mean()),
        )

    def of_team(self) -> dict[str, Any]:
        """Return the figures by name, the share in view of all targets told apart from that of each."""
        return {"in_view_mean" if name == "in_view" else name: each for name, each in vars(self).items()}


@dataclass(frozen=True, kw_only=True)
class TrackSummary(MissionSummary):
    """What one mission achieved; the fields are explained in ``docs/outputs.md``."""

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
    entropy_mean_nat: float
    entropy_final_nat: float
    position_rmse_m: float
    nees: float
    nees_in_band: float
    in_view_mean: float
    nees_band: tuple[float, float]
    consistency: Consistency
    in_view: Mapping[str, float]
    path_m: Mapping[str, float]
    rounds: int
    sweeps: int
    bound_ratio: float | None
    skipped: int
    messages: Mapping[str, Traffic]
    bytes: Mapping[str, Traffic]
    comparison: Mapping[str, TrackQuality] = field(default_factory=dict)


def consistency(nees: float, band: tuple[float, float]) -> Consistency:
    """Tell whether a mission's mean NEES lies where that of a single step does nineteen times in twenty."""
    low, high = band
    return "overconfident" if nees > high else "cautious" if nees < low else "consistent"


def dimensions(scene: TrackScene) -> int:
    """Return how many numbers the states of all targets have."""
    return sum(4 if moving else 2 for moving in scene.moving)


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

"""The log of monitoring: one snapshot a step, and at some of them what the field was taken to be."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil

import numpy as np
from numpy.typing import NDArray

from vedette.domains.monitoring.case import MonitorCase
from vedette.maps import GridFrame
from vedette.record.flights import FlightLog, FlightScene, FlightSnapshot
from vedette.record.log import Floats

_MEASURED = 60  # times at which the field is worked out: that takes a while


@dataclass(frozen=True, kw_only=True)
class MonitorScene(FlightScene):
    """What stays the same all through a mission."""

    frame: GridFrame
    sides: tuple[int, ...]  # of what each vehicle's sensor averages [cells]
    duration: float  # [s]
    blocked: NDArray[np.bool_]  # (R, C) where robots on the ground must not go
    ages: bool  # the field is nothing but how long ago a place was looked at

    each = ("vehicles", "ranges", "sides")

    @classmethod
    def of(cls, case: MonitorCase) -> MonitorScene:
        """Return the scene of a case."""
        sides = tuple(case.sensor(i).side for i in range(len(case.scenario.vehicles)))
        return cls(
            name=case.name,
            vehicles=tuple(case.names),
            ranges=tuple(0.5 * side * case.scenario.cell for side in sides),
            dt=case.scenario.step,
            frame=case.scenario.frame,
            sides=sides,
            duration=case.scenario.duration,
            blocked=case.blocked,
            ages=case.scenario.field.__struct_config__.tag == "age",
        )

    @property
    def every(self) -> int:
        """The field is worked out each so many steps."""
        return max(1, ceil(self.duration / self.dt / _MEASURED))


@dataclass(frozen=True, eq=False)
class MonitorSnapshot(FlightSnapshot):
    """Monitoring at one moment; the first living vehicle's belief."""

    way: float  # that a vehicle has gone in the mean [m]
    worst_age: float  # since a place was last looked at, at most [s]; NaN, as the next: not known
    mean_age: float  # the same in the mean over all cells [s]
    mean: NDArray[np.float32] | None = None  # (R, C) what the field is taken to be; None: not worked out
    rmse: float | None = None  # of that [unit]
    entropy: float | None = None  # of the field [nat]
    nees: float | None = None  # of that, a cell: 1 or less is not too sure


class MonitorLog(FlightLog[MonitorScene, MonitorSnapshot]):
    """Snapshots in order of time; each is forwarded to the sinks."""

    @property
    def measured(self) -> list[MonitorSnapshot]:
        """The snapshots at which the field was worked out."""
        return [snapshot for snapshot in self.snapshots if snapshot.rmse is not None]

    def against(self, of: str) -> tuple[Floats, Floats, Floats]:
        """Return times [s], ways [m] and a figure by its name, of all measured snapshots, (k,) each."""
        measured = self.measured
        rows = [(each.t, each.way, getattr(each, of)) for each in measured]
        times, ways, numbers = np.array(rows, np.float64).reshape(-1, 3).T
        return times, ways, numbers

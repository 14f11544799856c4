"""The log of a search: one snapshot a step, kept for the pictures and handed on to live outputs."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import ceil

import numpy as np
from numpy.typing import NDArray

from vedette.domains.search.bounds import sweep_width
from vedette.maps import GridFrame
from vedette.missions.search.case import SearchCase
from vedette.record.flights import FlightLog, FlightScene, FlightSnapshot
from vedette.record.log import Floats, VehicleSample, evenly

_BUDGET = 64 << 20  # bytes of pdfs that are kept


@dataclass(frozen=True, kw_only=True)
class SearchScene(FlightScene):
    """What stays the same all through a search."""

    frame: GridFrame  # of the pdf
    widths: tuple[float, ...]  # that the vehicles sweep [m]
    duration: float  # [s]
    false_alarms: bool  # so that a report of the target is not yet its finding

    each = ("vehicles", "ranges", "widths")

    @property
    def detection(self) -> str:
        """What the probability of detection is called: that some look has reported the target, truly."""
        return "some true report" if self.false_alarms else "probability of detection"

    @classmethod
    def of(cls, case: SearchCase, duration: float) -> SearchScene:
        """Return the scene of a search that may take so long [s]."""
        dt, vehicles = case.scenario.step, list(enumerate(case.scenario.vehicles))
        widths = (sweep_width(case.detectors[i], each.speed, dt / case.looks(i)) for i, each in vehicles)
        return cls(
            name=case.name,
            vehicles=tuple(case.names),
            ranges=tuple(detector.range for detector in case.detectors),
            dt=dt,
            frame=case.pdf.frame,
            widths=tuple(widths),
            duration=duration,
            false_alarms=case.false_alarms,
        )


@dataclass(frozen=True, eq=False)
class SearchSample(VehicleSample):
    """One vehicle at one moment."""

    goal: tuple[float, float] | None  # where it means to search afterwards [m]


@dataclass(frozen=True, eq=False)
class SearchSnapshot(FlightSnapshot):
    """The search at one moment."""

    vehicles: tuple[SearchSample, ...]
    mass: NDArray[np.float32]  # (R, C) probability of each cell, as the first living vehicle knows it
    entropy: float  # of that [nat]
    detection: float  # probability that the looks so far have detected the target, 0..1; NaN: not known
    target: tuple[float, float]  # where it truly is [m]; NaN: nobody here knows
    outside: float | None = None  # probability that it has left, as that vehicle knows it; None: it cannot
    declared: tuple[float, float] | None = (
        None  # where it is declared to be [m], as far as anybody here knows
    )


_NO_MASS = np.empty((0, 0), np.float32)


class SearchLog(FlightLog[SearchScene, SearchSnapshot]):
    """Snapshots in order of time; each is forwarded to the sinks.

    Pdfs take room: where all would not fit, those of every so many snapshots are kept, and the last.
    """

    def add(self, snapshot: SearchSnapshot) -> None:
        """Keep a snapshot and hand it on."""
        if self.snapshots and (len(self.snapshots) - 1) % self._stride:
            self.snapshots[-1] = replace(self.snapshots[-1], mass=_NO_MASS)
        super().add(snapshot)

    @property
    def _stride(self) -> int:
        steps = self.scene.duration / self.scene.dt + 1.0
        return max(1, ceil(4.0 * self.scene.frame.size * steps / _BUDGET))

    def targets(self, until: float) -> Floats:
        """Return where the target was up to a time, (k, 2) [m]."""
        return np.array([snapshot.target for snapshot in self.until(until)])

    def drawn(self) -> list[SearchSnapshot]:
        """Return the snapshots whose pdf is kept."""
        return [snapshot for snapshot in self.snapshots if snapshot.mass.size]

    def stages(self, count: int = 4) -> list[SearchSnapshot]:
        """Return the first snapshot, the last, and evenly spaced ones in between, of those with a pdf."""
        kept = self.drawn()
        return [kept[i] for i in evenly(len(kept), count)]

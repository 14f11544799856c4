"""The log of a search: one snapshot a step, kept for the pictures and handed on to live outputs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from math import ceil
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from vedette.maps import GridFrame

Floats = NDArray[np.float64]

_BUDGET = 64 << 20  # bytes of pdfs that are kept


@dataclass(frozen=True)
class Scene:
    """What stays the same all through a search."""

    name: str
    frame: GridFrame  # of the pdf
    vehicles: tuple[str, ...]
    ranges: tuple[float, ...]  # of the vehicles' sensors [m]
    widths: tuple[float, ...]  # that the vehicles sweep [m]
    duration: float  # [s]
    dt: float  # step [s]


@dataclass(frozen=True, eq=False)
class VehicleSample:
    """One vehicle at one moment."""

    x: float  # [m], team frame
    y: float
    heading: float  # [rad]
    state: str  # the agent's word for what it does, "dead" for one that was lost
    alive: bool
    path: Floats  # (k, 2) where its present plan takes it, from here on [m]
    goal: tuple[float, float] | None  # where it means to search afterwards [m]


@dataclass(frozen=True, eq=False)
class SearchSnapshot:
    """The search at one moment."""

    t: float  # [s]
    vehicles: tuple[VehicleSample, ...]
    mass: NDArray[np.float32]  # (R, C) probability of each cell, as the first living vehicle knows it
    entropy: float  # of that [nat]
    detection: float  # probability that the looks so far have detected the target, 0..1
    target: tuple[float, float]  # where it truly is [m]


class SearchSink(Protocol):
    """An output that follows the search while it runs."""

    def update(self, snapshot: SearchSnapshot) -> None:
        """Take in the next snapshot."""


_NO_MASS = np.empty((0, 0), np.float32)


@dataclass(eq=False)
class SearchLog:
    """Snapshots in order of time; each is forwarded to the sinks.

    Pdfs take room: where all would not fit, those of every so many snapshots are kept, and the last.
    """

    scene: Scene
    sinks: Sequence[SearchSink] = ()
    snapshots: list[SearchSnapshot] = field(default_factory=list)

    def add(self, snapshot: SearchSnapshot) -> None:
        """Keep a snapshot and hand it on."""
        if self.snapshots and (len(self.snapshots) - 1) % self._stride:
            self.snapshots[-1] = replace(self.snapshots[-1], mass=_NO_MASS)
        self.snapshots.append(snapshot)
        for sink in self.sinks:
            sink.update(snapshot)

    @property
    def _stride(self) -> int:
        steps = self.scene.duration / self.scene.dt + 1.0
        return max(1, ceil(4.0 * self.scene.frame.size * steps / _BUDGET))

    def curve(self, of: Callable[[SearchSnapshot], float]) -> Floats:
        """Return a number of every snapshot, (K,)."""
        return np.array([of(snapshot) for snapshot in self.snapshots], np.float64)

    @property
    def times(self) -> Floats:
        """``(K,)`` [s]."""
        return self.curve(lambda snapshot: snapshot.t)

    def trails(self, until: float) -> Floats:
        """Return where everybody was up to a time, (k, n, 2) [m]."""
        places = [[(v.x, v.y) for v in s.vehicles] for s in self.snapshots if s.t <= until + 1e-9]
        return np.array(places, np.float64).reshape(len(places), len(self.scene.vehicles), 2)

    def targets(self, until: float) -> Floats:
        """Return where the target was up to a time, (k, 2) [m]."""
        return np.array([s.target for s in self.snapshots if s.t <= until + 1e-9])

    def drawn(self) -> list[SearchSnapshot]:
        """Return the snapshots whose pdf is kept."""
        return [snapshot for snapshot in self.snapshots if snapshot.mass.size]

    def stages(self, count: int = 4) -> list[SearchSnapshot]:
        """Return the first snapshot, the last, and evenly spaced ones in between, of those with a pdf."""
        kept = self.drawn()
        chosen = np.unique(np.linspace(0, len(kept) - 1, count).round().astype(int))
        return [kept[i] for i in chosen]

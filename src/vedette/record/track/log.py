"""The log of a tracking mission: one snapshot a step, kept for the pictures and handed on to live outputs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Scene:
    """What stays the same all through a mission."""

    name: str
    area: tuple[float, float, float, float]  # lowest x, lowest y, highest x, highest y [m]
    vehicles: tuple[str, ...]
    ranges: tuple[float, ...]  # of the vehicles' sensors [m]
    views: tuple[float, ...]  # of the vehicles' sensors [deg]
    sensors: tuple[str, ...]  # kind of each vehicle's sensor
    targets: tuple[str, ...]
    moving: tuple[bool, ...]  # whether each target has a velocity
    dt: float  # step [s]


@dataclass(frozen=True, eq=False)
class VehicleSample:
    """One vehicle at one step."""

    x: float  # [m], team frame
    y: float
    heading: float  # [rad]
    state: str  # the agent's word for what it does, "dead" for one that was lost
    alive: bool
    path: Floats  # (k, 2) where its present plan takes it, from here on [m]
    seen: tuple[int, ...]  # targets that it has just seen


@dataclass(frozen=True, eq=False)
class TrackSnapshot:
    """The mission at one step: estimates with all evidence up to it that has gone round by the next step."""

    t: float  # [s]
    vehicles: tuple[VehicleSample, ...]
    holder: int  # the vehicle whose tracks these are: the first that lives
    truth: Floats  # (T, 4) x, y, vx, vy [m, m, m/s, m/s]
    means: Floats  # (T, 4)
    covariances: Floats  # (T, 4, 4)
    entropy: float  # of all targets together [nat], mean over the living vehicles' own tracks
    nees: float  # e' P^-1 e a dimension, mean likewise: 1 if consistent
    squared_error: float  # of a target's position [m^2], mean likewise


class TrackSink(Protocol):
    """An output that follows the mission while it runs."""

    def update(self, snapshot: TrackSnapshot) -> None:
        """Take in the next snapshot."""


@dataclass(eq=False)
class TrackLog:
    """Snapshots in order of time; each is forwarded to the sinks."""

    scene: Scene
    sinks: Sequence[TrackSink] = ()
    snapshots: list[TrackSnapshot] = field(default_factory=list)

    def add(self, snapshot: TrackSnapshot) -> None:
        """Keep a snapshot and hand it on."""
        self.snapshots.append(snapshot)
        for sink in self.sinks:
            sink.update(snapshot)

    def curve(self, of: Callable[[TrackSnapshot], float]) -> Floats:
        """Return a number of every snapshot, (K,)."""
        return np.array([of(snapshot) for snapshot in self.snapshots], np.float64)

    @property
    def times(self) -> Floats:
        """``(K,)`` [s]."""
        return self.curve(lambda snapshot: snapshot.t)

    def trails(self, until: float) -> Floats:
        """Return where everybody was up to a time, (k, n, 2) [m]."""
        poses = [[(v.x, v.y) for v in s.vehicles] for s in self.snapshots if s.t <= until + 1e-9]
        return np.array(poses, np.float64).reshape(len(poses), len(self.scene.vehicles), 2)

    def truths(self, until: float) -> Floats:
        """Return where the targets were up to a time, (k, T, 2) [m]."""
        return np.array([s.truth[:, :2] for s in self.snapshots if s.t <= until + 1e-9])

    def in_view(self) -> Floats:
        """Return the share of steps at which somebody saw each target, (T,)."""
        seen = np.zeros((len(self.snapshots), len(self.scene.targets)))
        for row, snapshot in zip(seen, self.snapshots, strict=True):
            row[[target for vehicle in snapshot.vehicles for target in vehicle.seen]] = 1.0
        return np.asarray(seen.mean(axis=0))

    def stages(self, shares: Sequence[float]) -> list[TrackSnapshot]:
        """Return the snapshots at these shares of the time, 0 to 1."""
        last = len(self.snapshots) - 1
        return [self.snapshots[round(last * share)] for share in shares]

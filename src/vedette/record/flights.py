"""What missions of vehicles with a bounded turn rate have in common: they are looked at once a step."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Generic, TypeVar

import numpy as np

from vedette.agent.body import TICK
from vedette.record.log import Floats, MissionScene, Sink, VehicleSample


@dataclass(frozen=True, kw_only=True)
class FlightScene(MissionScene):
    """What stays the same all through a mission of vehicles."""

    ranges: tuple[float, ...]  # of the vehicles' sensors [m]
    dt: float  # step [s]


@dataclass(frozen=True, eq=False)
class FlightSnapshot:
    """A mission at one step."""

    t: float  # [s]
    vehicles: Sequence[VehicleSample]  # by index in the team


SceneT = TypeVar("SceneT", bound=FlightScene)
SnapshotT = TypeVar("SnapshotT", bound=FlightSnapshot)


@dataclass(eq=False)
class FlightLog(Generic[SceneT, SnapshotT]):
    """Snapshots in order of time; each is forwarded to the sinks."""

    scene: SceneT
    sinks: Sequence[Sink[SnapshotT]] = ()
    snapshots: list[SnapshotT] = field(default_factory=list)

    def add(self, snapshot: SnapshotT) -> None:
        """Keep a snapshot and hand it on."""
        self.snapshots.append(snapshot)
        for sink in self.sinks:
            sink.update(snapshot)

    @property
    def step(self) -> int:
        """The step that is logged next."""
        return len(self.snapshots)

    def due(self, now: float) -> bool:
        """Tell whether to log it: at its last tick, when its evidence has had the most time to go round."""
        return now >= (self.step + 1) * self.scene.dt - TICK - 1e-6

    def curve(self, of: Callable[[SnapshotT], float]) -> Floats:
        """Return a number of every snapshot, (K,)."""
        return np.array([of(snapshot) for snapshot in self.snapshots], np.float64)

    @property
    def times(self) -> Floats:
        """``(K,)`` [s]."""
        return self.curve(lambda snapshot: snapshot.t)

    def until(self, time: float) -> list[SnapshotT]:
        """Return the snapshots up to a time [s]."""
        return [snapshot for snapshot in self.snapshots if snapshot.t <= time + 1e-9]

    def trails(self, until: float) -> Floats:
        """Return where everybody was up to a time, (k, n, 2) [m]."""
        places = [[(vehicle.x, vehicle.y) for vehicle in s.vehicles] for s in self.until(until)]
        return np.array(places, np.float64).reshape(len(places), len(self.scene.vehicles), 2)

"""What missions of vehicles have in common: they are looked at once a step."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar, Generic, Self, TypeVar

import numpy as np

from vedette.agent.body import TICK
from vedette.outcome import Outcome
from vedette.record.figures import RobotFigures
from vedette.record.log import Floats, MissionScene, Sink, VehicleSample
from vedette.record.summary import Timing


@dataclass(frozen=True, kw_only=True)
class FlightScene(MissionScene):
    """What stays the same all through a mission of vehicles."""

    ranges: tuple[float, ...]  # of the vehicles' sensors [m]
    dt: float  # step [s]

    each: ClassVar[tuple[str, ...]] = ("vehicles", "ranges")  # fields that have something of each vehicle

    def only(self, vehicle: int) -> Self:
        """Return the scene with one vehicle alone, by its index."""
        few: dict[str, Any] = {name: (getattr(self, name)[vehicle],) for name in self.each}
        return replace(self, **few)


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


ContentT = TypeVar("ContentT")
ReportT = TypeVar("ReportT")


@dataclass(frozen=True, eq=False)
class FlightView(Generic[ContentT]):
    """All that can be told of one vehicle from outside; nothing in it changes after it is made."""

    sample: VehicleSample
    content: ContentT | None  # what it tells of its mission, in the domain's own terms; None: nothing yet
    figures: RobotFigures


class FlightObserver(ABC, Generic[ContentT, SnapshotT, ReportT]):
    """Measures a mission from views of its vehicles, step by step: it knows the truth, the agents do not.

    Where the views come from makes no difference: from vehicles simulated in this process, or from what
    vehicles on a network report.
    """

    def __init__(self, log: FlightLog[Any, SnapshotT]) -> None:
        """Prepare to observe a mission that has not begun."""
        self.log = log
        self.views: tuple[FlightView[ContentT], ...] = ()  # of the last look

    def look(self, views: Sequence[FlightView[ContentT]]) -> None:
        """Log the next step from views of all vehicles at it, in the order of the team."""
        self.views = tuple(views)
        self.log.add(self.snapshot())

    def finish(self, now: float, views: Sequence[FlightView[ContentT]]) -> None:
        """Take what the team has counted in the end; log the step in which the mission ended."""
        self.views = tuple(views)
        if not self.log.snapshots or now >= self.log.step * self.log.scene.dt - 1e-6:
            self.look(views)

    @abstractmethod
    def snapshot(self) -> SnapshotT:
        """Return the step ``log.step`` by the present views."""

    @abstractmethod
    def report(self, outcome: Outcome, timing: Timing, now: float) -> ReportT:
        """Return what the mission leaves that ended at ``now`` [s]."""

"""Missions of vehicles from their ``run.mcap``: the snapshots that were recorded, for pictures and replay."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from math import hypot, nan
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vedette.record.flights import FlightScene, FlightSnapshot
from vedette.record.log import VehicleSample
from vedette.record.monitor.log import MonitorScene, MonitorSnapshot
from vedette.record.own.observer import OwnScene, OwnSnapshot
from vedette.record.read import Moment, Mover, facts_of, grid_of, metrics_of, moments
from vedette.record.scenes import KIND, scene_in
from vedette.record.search.log import SearchSample, SearchScene, SearchSnapshot
from vedette.record.track.log import TrackSample, TrackScene, TrackSnapshot

SCENES: Mapping[str, type[FlightScene]] = {
    "track": TrackScene,
    "search": SearchScene,
    "monitor": MonitorScene,
    "own": OwnScene,
}


def scene_of(path: Path) -> FlightScene | None:
    """Return what a record of vehicles is of; None: it is of another mission.

    Raises:
        InputError: it cannot be read.
    """
    facts = facts_of(path)
    kind = SCENES.get(facts.get(KIND, ""))
    return None if kind is None else scene_in(facts, kind, path)


def snapshots_of(path: Path, scene: FlightScene) -> Iterator[FlightSnapshot]:
    """Yield what was recorded; a pdf or a field stays until the next, and velocities of targets are not kept.

    Raises:
        InputError: it cannot be read.
    """
    facts = facts_of(path)
    movers = [Mover(facts.get(f"vehicle {name}", name)) for name in scene.vehicles]
    reader = _READERS[type(scene)](scene, facts)
    for moment in moments(path):
        for mover in movers:
            mover.hear(moment.messages)
        reader.hear(moment)
        if "/tf" in moment.messages:
            yield reader.snapshot(moment, movers)


class _Reader:
    """Makes snapshots of one kind of mission of what has been recorded up to a moment."""

    def __init__(self, scene: Any, facts: Mapping[str, str]) -> None:
        self.scene, self.facts = scene, facts

    def hear(self, moment: Moment) -> None:
        """Take what is told beside the vehicles."""

    def snapshot(self, moment: Moment, movers: list[Mover]) -> FlightSnapshot:
        """Return how it is now."""
        raise TypeError(f"no record of {type(self.scene).__name__}")


class _Tracks(_Reader):
    def __init__(self, scene: TrackScene, facts: Mapping[str, str]) -> None:
        super().__init__(scene, facts)
        count = len(scene.targets)
        self.means, self.truth = np.full((count, 4), nan), np.full((count, 4), nan)
        self.covariances = np.tile(np.eye(4), (count, 1, 1))

    def hear(self, moment: Moment) -> None:
        for t, name in enumerate(self.scene.targets):
            topic = f"/targets/{self.facts.get(f'target {name}', name)}"
            if (track := moment.messages.get(f"{topic}/track")) is not None:
                place = track.pose.pose.position
                self.means[t] = place.x, place.y, 0.0, 0.0
                self.covariances[t, :2, :2] = np.asarray(track.pose.covariance).reshape(6, 6)[:2, :2]
            if (truth := moment.messages.get(f"{topic}/truth")) is not None:
                self.truth[t] = truth.pose.position.x, truth.pose.position.y, 0.0, 0.0

    def snapshot(self, moment: Moment, movers: list[Mover]) -> TrackSnapshot:
        samples = tuple(TrackSample(**vars(mover.sample()), seen=mover.seen) for mover in movers)
        told = metrics_of(moment)
        alive = [i for i, sample in enumerate(samples) if sample.alive]
        return TrackSnapshot(
            moment.stamp / 1e9,
            samples,
            alive[0] if alive else 0,
            self.truth.copy(),
            self.means.copy(),
            self.covariances.copy(),
            *(told.get(name, nan) for name in ("entropy", "nees", "squared_error")),
        )


class _Pdf(_Reader):
    def __init__(self, scene: SearchScene, facts: Mapping[str, str]) -> None:
        super().__init__(scene, facts)
        self.mass, self.full = np.zeros(scene.frame.shape, np.float32), 1.0
        self.target = nan, nan

    def hear(self, moment: Moment) -> None:
        if (full := moment.messages.get("/pdf_full")) is not None:
            self.full = full.data
        if (pdf := moment.messages.get("/pdf")) is not None:
            self.mass = grid_of(pdf).astype(np.float32) * np.float32(self.full / 100.0)
        if (truth := moment.messages.get("/target/truth")) is not None:
            self.target = truth.pose.position.x, truth.pose.position.y

    def snapshot(self, moment: Moment, movers: list[Mover]) -> SearchSnapshot:
        told = metrics_of(moment)
        vehicles = tuple(SearchSample(**vars(mover.sample()), goal=mover.goal) for mover in movers)
        entropy, detection = told.get("entropy", nan), told.get("detection", nan)
        t = moment.stamp / 1e9
        return SearchSnapshot(t, vehicles, self.mass, entropy, detection, self.target, told.get("outside"))


@dataclass
class _Ways:
    """How far vehicles have come, by where they were."""

    gone: dict[int, float] = field(default_factory=dict)  # [m]
    at: dict[int, tuple[float, float]] = field(default_factory=dict)

    def mean(self, vehicles: list[VehicleSample]) -> float:
        for i, each in enumerate(vehicles):
            before = self.at.get(i, (each.x, each.y))
            self.gone[i] = self.gone.get(i, 0.0) + hypot(each.x - before[0], each.y - before[1])
            self.at[i] = each.x, each.y
        return float(np.mean(list(self.gone.values()))) if self.gone else 0.0


class _Field(_Reader):
    def __init__(self, scene: MonitorScene, facts: Mapping[str, str]) -> None:
        super().__init__(scene, facts)
        self.mean: NDArray[np.float32] | None = None
        self.ways = _Ways()

    def hear(self, moment: Moment) -> None:
        told = moment.messages
        self.mean = None
        if "/field" in told and "/field_low" in told and "/field_high" in told:
            low, high = told["/field_low"].data, told["/field_high"].data
            share = grid_of(told["/field"]).astype(np.float32) / np.float32(100.0)
            self.mean = np.float32(low) + np.float32(high - low) * share

    def snapshot(self, moment: Moment, movers: list[Mover]) -> MonitorSnapshot:
        told, vehicles = metrics_of(moment), [mover.sample() for mover in movers]
        return MonitorSnapshot(
            moment.stamp / 1e9,
            tuple(vehicles),
            self.ways.mean(vehicles),
            told.get("worst_age", nan),
            told.get("mean_age", nan),
            self.mean,
            told.get("rmse"),
            told.get("entropy"),
        )


class _Own(_Reader):
    def snapshot(self, moment: Moment, movers: list[Mover]) -> OwnSnapshot:
        return OwnSnapshot(moment.stamp / 1e9, tuple(mover.sample() for mover in movers), metrics_of(moment))


_READERS: Mapping[type[FlightScene], type[_Reader]] = {
    TrackScene: _Tracks,
    SearchScene: _Pdf,
    MonitorScene: _Field,
    OwnScene: _Own,
}

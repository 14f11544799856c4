"""The log of a tracking mission: one snapshot a step, kept for the pictures and handed on to live outputs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vedette.domains.tracking.sensors import SENSORS
from vedette.missions.track.scenario import TrackScenario
from vedette.record.flights import FlightLog, FlightScene, FlightSnapshot
from vedette.record.log import Floats, VehicleSample


@dataclass(frozen=True, kw_only=True)
class TrackScene(FlightScene):
    """What stays the same all through a mission."""

    area: tuple[float, float, float, float]  # lowest x, lowest y, highest x, highest y [m]
    views: tuple[float, ...]  # of the vehicles' sensors [deg]
    sensors: tuple[str, ...]  # kind of each vehicle's sensor
    targets: tuple[str, ...]
    moving: tuple[bool, ...]  # whether each target has a velocity

    each = ("vehicles", "ranges", "views", "sensors")

    @classmethod
    def of(cls, scenario: TrackScenario, name: str) -> TrackScene:
        """Return the scene of a scenario."""
        kinds = {kind: word for word, kind in SENSORS.items()}
        return cls(
            name=name,
            vehicles=tuple(scenario.vehicle_names),
            ranges=tuple(sensor.range for sensor in scenario.sensors),
            dt=scenario.step,
            area=scenario.area,
            views=tuple(sensor.view for sensor in scenario.sensors),
            sensors=tuple(kinds[type(sensor)] for sensor in scenario.sensors),
            targets=tuple(scenario.target_names),
            moving=tuple(model.d == 4 for model in scenario.prior().models),
        )


@dataclass(frozen=True, eq=False)
class TrackSample(VehicleSample):
    """One vehicle at one step."""

    seen: tuple[int, ...]  # targets that it has just seen


@dataclass(frozen=True, eq=False)
class TrackSnapshot(FlightSnapshot):
    """The mission at one step: estimates with all evidence up to it that has gone round by the next step."""

    vehicles: tuple[TrackSample, ...]
    holder: int  # the vehicle whose tracks these are: the first that lives
    truth: Floats  # (T, 4) x, y, vx, vy [m, m, m/s, m/s]; NaN, as what is measured by it: nobody here knows
    means: Floats  # (T, 4)
    covariances: Floats  # (T, 4, 4)
    entropy: float  # of all targets together [nat], mean over the living vehicles' own tracks
    nees: float  # e' P^-1 e a dimension, mean likewise: 1 if consistent
    squared_error: float  # of a target's position [m^2], mean likewise


class TrackLog(FlightLog[TrackScene, TrackSnapshot]):
    """Snapshots in order of time; each is forwarded to the sinks."""

    def truths(self, until: float) -> Floats:
        """Return where the targets were up to a time, (k, T, 2) [m]."""
        return np.array([snapshot.truth[:, :2] for snapshot in self.until(until)])

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

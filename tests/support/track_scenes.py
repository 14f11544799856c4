"""A small tracking scenario for the tests: two vehicles or three, three targets, half a minute."""

from __future__ import annotations

from typing import Any

from vedette.missions.track.scenario import TrackScenario, checked
from vedette.record.track.observer import TrackReport
from vedette.scenario import as_scenario
from vedette.sim.track.run import track
from vedette.sim.track.simulation import TrackSetup, TrackSimulation

POSITION = {"type": "position", "range": 120, "view": 200, "noise": 6, "detection": 0.9}
MIXED = (
    {"type": "range-bearing", "range": 120, "view": 180, "range_noise": 5, "bearing_noise": 3},
    {"type": "bearing", "range": 150, "view": 180, "bearing_noise": 3, "min_range": 20},
)


def content(**changes: Any) -> dict[str, Any]:
    """A scenario as plain data, with some fields changed."""
    vehicles = [
        {"start": [40 + 30 * i, 40, 45], "speed": 18, "turn_rate": 0.4, "sensor": MIXED[i % 2]}
        for i in range(3)
    ]
    targets = [
        {"model": "constant-velocity", "mean": [140, 80, 3, 1], "sd": [20, 20, 1, 1], "q": 0.05},
        {"model": "constant-velocity", "mean": [60, 200, 2, -1], "sd": [20, 20, 1, 1], "q": 0.05},
        {"model": "static", "mean": [220, 200], "sd": [25, 25]},
    ]
    return {
        "area": [0, 0, 300, 260],
        "duration": 30,
        "horizon": 4,
        "decisions": 2,
        "vehicles": vehicles,
        "targets": targets,
    } | changes


def scenario(**changes: Any) -> TrackScenario:
    """The scenario, checked."""
    return checked(as_scenario(content(**changes), TrackScenario, "test"), "test")


def with_sensor(sensor: dict[str, Any], **changes: Any) -> TrackScenario:
    """The scenario with the same sensor on every vehicle."""
    plain = content(**changes)
    return scenario(**(plain | {"vehicles": [each | {"sensor": sensor} for each in plain["vehicles"]]}))


def flown(of: TrackScenario, **setup: Any) -> tuple[TrackSimulation, TrackReport]:
    """Run a mission to its end."""
    simulation = TrackSimulation(of, TrackSetup(**setup))
    return simulation, track(simulation, "test")


def apart(**changes: Any) -> TrackScenario:
    """Two like vehicles that start together, and four targets in as many directions: to be divided up."""
    sensor = {"type": "range-bearing", "range": 70, "range_noise": 4, "bearing_noise": 3}
    vehicles = [{"start": [150, y, 0], "speed": 18, "turn_rate": 0.4, "sensor": sensor} for y in (125, 135)]
    means = [[40, 40, 1, 0], [260, 40, 0, 1], [260, 220, -1, 0], [40, 220, 0, -1]]
    targets = [
        {"model": "constant-velocity", "mean": mean, "sd": [15, 15, 1, 1], "q": 0.05} for mean in means
    ]
    return scenario(**({"vehicles": vehicles, "targets": targets, "duration": 25} | changes))

"""Targets that are far apart: three scenes in which it pays to look beyond the horizon."""

from __future__ import annotations

import math
from typing import Any

import msgspec
import pytest

from tests.support.track_scenes import flown, scenario
from vedette.errors import InputError
from vedette.missions.track.scenario import TrackScenario, default_scenario
from vedette.sim.track.simulation import TrackSetup, TrackSimulation

STEP = {"step": 4, "horizon": 4, "decisions": 2}
SEEING = {"type": "range-bearing", "range": 200}


def moving(x: float, y: float) -> dict[str, Any]:
    return {"model": "constant-velocity", "mean": [x, y, 0, 0], "sd": [20, 20, 0.1, 0.1], "q": 0.0005}


def vehicle(x: float, y: float, sensor: dict[str, Any] = SEEING) -> dict[str, Any]:
    return {"start": [x, y, 0], "speed": 20, "turn_rate": 0.2, "sensor": sensor}


def two_apart() -> TrackScenario:
    """One vehicle, and two targets 1.6 km apart: only one can be seen at a time."""
    targets = [moving(300, 300), moving(1900, 300) | {"sd": [60, 60, 0.1, 0.1]}]
    area = [0, 0, 2200, 600]
    return scenario(area=area, vehicles=[vehicle(200, 300)], targets=targets, duration=600, **STEP)


def three_corners() -> TrackScenario:
    """Two vehicles that start together at one of three targets in as many corners."""
    targets = [moving(300, 300), moving(2200, 400), moving(400, 2200)]
    vehicles = [vehicle(200, 200), vehicle(200, 260)]
    return scenario(area=[0, 0, 2500, 2500], vehicles=vehicles, targets=targets, duration=300, **STEP)


def a_round() -> TrackScenario:
    """One vehicle, and three targets in a row that diffuse: to be visited in turn."""
    targets = [{"model": "static", "mean": [x, 300], "sd": [20, 20], "q": 1.0} for x in (200, 1000, 1800)]
    sensor = {"type": "position", "range": 150, "noise": 10}
    area = [0, 0, 2000, 600]
    return scenario(area=area, vehicles=[vehicle(200, 300, sensor)], targets=targets, duration=600, **STEP)


@pytest.mark.parametrize("scene", [two_apart, three_corners, a_round])
def test_with_a_tail_more_targets_are_seen_and_less_is_unknown_on_average(scene: Any) -> None:
    of = scene()
    assert of.layers  # by itself, as it takes long to cross the area
    runs = [flown(msgspec.structs.replace(of, tail=tail), seed=0)[1].summary for tail in (0.0, None)]
    without, with_tail = ([share > 0.0 for share in run.in_view.values()] for run in runs)
    assert sum(without) < sum(with_tail)
    assert runs[1].entropy_mean_nat < runs[0].entropy_mean_nat
    assert runs[1].bound_ratio is not None
    assert 0.5 <= runs[1].bound_ratio <= 1.0 + 1e-9


def test_there_is_a_tail_only_where_the_area_takes_long_to_cross_or_one_is_given() -> None:
    assert default_scenario().layers == ()
    of = scenario(tail=120)
    assert of.layers[-1] == 120.0
    team = TrackSimulation(of, TrackSetup()).team
    assert team.prior.layers == of.layers
    metres = TrackSimulation(of, TrackSetup(objective="final-variance")).team
    assert metres.prior.layers == ()  # nats and square metres do not add up
    still = [each | {"speed": 0} for each in ({"start": [40, 40, 0], "sensor": SEEING},)]
    assert scenario(vehicles=still).layers == ()


def test_the_optimum_counts_the_ways_to_other_targets() -> None:
    of = scenario(tail=120, duration=4)
    _, report = flown(of, coordination="optimum")
    assert math.isfinite(report.summary.entropy_mean_nat)
    many = [moving(20.0 + 25.0 * k, 100.0) for k in range(9)]
    with pytest.raises(InputError, match="joint choices"):
        TrackSimulation(scenario(tail=120, targets=many, decisions=3), TrackSetup(coordination="optimum"))

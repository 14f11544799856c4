"""Declared domains in the window: the higher a field is taken to be in a cell, the deeper is its shade."""

from __future__ import annotations

import json

import numpy as np
import pytest

from tests.support.monitor_scenes import SMALL
from vedette.maps import FREE, OCCUPIED
from vedette.record.flights import FlightScene
from vedette.run import DomainMission
from vedette.sim.domains import domain_of
from vedette.window.declared import pictures
from vedette.window.picture import SHADES

YARD = [[10, 2], [14, 2], [14, 6], [10, 6]]


def test_the_higher_the_field_is_taken_to_be_the_deeper_the_shade_and_no_go_areas_are_black() -> None:
    mission = DomainMission(domain_of("monitor"), SMALL | {"no_go": [YARD]})
    draw = pictures(mission.scene)
    for _ in range(12):
        mission.step(ticks=10)
        shown = draw(mission.snapshot)
    told, blocked, mean = json.loads(shown.text), mission.scene.blocked, mission.snapshot.mean
    assert blocked.any()
    assert (shown.classes[blocked] == OCCUPIED).all()
    order = np.argsort(mean[~blocked])
    shades = shown.classes[~blocked][order].astype(int) - OCCUPIED
    assert (np.diff(shades) >= 0).all()
    assert shades[0] < shades[-1] <= SHADES
    assert dict(told["figures"])["error"] == f"{mission.snapshot.rmse:.3g}"
    assert [each["name"] for each in told["robots"]] == ["rover", "heron"]
    for robot, vehicle in zip(told["robots"], mission.snapshot.vehicles, strict=True):
        assert (robot["x"], robot["y"]) == pytest.approx((vehicle.x, vehicle.y), abs=1e-3)


def test_until_the_field_is_worked_out_again_its_last_picture_stays() -> None:
    mission = DomainMission(domain_of("monitor"), SMALL | {"duration": 240, "step": 1})
    assert mission.scene.every > 1
    draw = pictures(mission.scene)
    last = None
    for _ in range(3 * mission.scene.every):
        mission.step(ticks=10)
        shown = draw(mission.snapshot)
        if mission.snapshot.mean is None and last is not None:
            assert (shown.classes == last).all()
        last = shown.classes
    assert last is not None


def test_vehicles_of_a_domain_of_ones_own_are_shown_on_plain_ground_with_its_figures() -> None:
    mission = DomainMission(domain_of("vedette.missions.own.skeleton:Skeleton"))
    mission.step(ticks=20)
    shown = pictures(mission.scene)(mission.snapshot)
    told = json.loads(shown.text)
    assert (shown.classes == FREE).all()
    x0, y0, x1, y1 = mission.scene.area
    assert shown.frame.extent == pytest.approx((x0, x1, y0, y1), abs=shown.frame.resolution)
    assert [name for name, _ in told["figures"]] == list(mission.snapshot.figures)
    assert [each["name"] for each in told["robots"]] == list(mission.scene.vehicles)


def test_of_missions_on_ground_that_nobody_knows_there_is_no_picture() -> None:
    with pytest.raises(TypeError, match="no picture of FlightScene"):
        pictures(FlightScene(name="x", vehicles=(), ranges=(), dt=1.0))

"""Vehicles in the window: targets lie where their tracks say, and the pdf is as deep as it is likely."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.support.track_scenes import content
from vedette.agent.orders import Pause
from vedette.cli.windows import beside_of
from vedette.record.log import VehicleSample
from vedette.record.search.log import SearchSnapshot
from vedette.record.space import LITTLE
from vedette.record.track.log import TrackSnapshot
from vedette.run import Search, Track
from vedette.sim.orders import OrderAt
from vedette.window.explore import Shower
from vedette.window.flights import search_picture, track_picture
from vedette.window.hub import Hub
from vedette.window.picture import SHADES, Picture, size


def last_of(mission: Any, draw: Any) -> tuple[Any, Picture, dict[str, Any]]:
    """A mission's last snapshot but a few, its picture and what that tells."""
    mission.step(ticks=60)
    shown = draw(mission.scene, mission.snapshot)
    return mission.snapshot, shown, json.loads(shown.text)


def places(vehicles: tuple[VehicleSample, ...]) -> list[tuple[float, float]]:
    """Where vehicles are [m]."""
    return [(pytest.approx(each.x, abs=1e-3), pytest.approx(each.y, abs=1e-3)) for each in vehicles]


def test_trackers_are_shown_with_their_targets_over_the_scenarios_area() -> None:
    snapshot, shown, told = last_of(Track(content()), track_picture)
    assert isinstance(snapshot, TrackSnapshot)
    assert shown.frame.extent == pytest.approx((0.0, 300.0, 0.0, 260.0), abs=2.0)
    assert [(each["x"], each["y"]) for each in told["robots"]] == places(snapshot.vehicles)
    for mark, mean, covariance in zip(told["marks"], snapshot.means, snapshot.covariances, strict=True):
        assert mark[:2] == pytest.approx(mean[:2].tolist())
        variances = np.linalg.eigvalsh(covariance[:2, :2])
        assert (mark[3], mark[2]) == pytest.approx(2.0 * 2.4477 * np.sqrt(variances), rel=1e-3)


def test_orders_and_a_disk_that_is_nearly_full_are_told_beside_vehicles_too(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    mission = Track(orders=[OrderAt(0.0, Pause(robot=2))], max_time=2.0)
    names = mission.scene.vehicles
    mission.run()
    told = beside_of(mission, names, tmp_path)
    assert list(told.orders) == [("pause robot 2", list(names))]
    assert told.alerts == []
    shown = json.loads(track_picture(mission.scene, mission.snapshot, told).text)
    rounds, sent = zip(*mission.counts, strict=True)
    assert min(*rounds, *sent) > 0
    assert [each["rounds"] for each in shown["robots"]] == list(rounds)
    assert [each["sent"] for each in shown["robots"]] == [size(each) for each in sent]
    assert shown["figures"][-2:] == [["rounds", str(max(rounds))], ["sent", size(sum(sent))]]
    monkeypatch.setattr(shutil, "disk_usage", lambda path: SimpleNamespace(free=LITTLE - 1))
    assert list(beside_of(mission, names, tmp_path).alerts) == [f"disk full: 67 MB left for {tmp_path}"]


def test_the_likelier_the_target_is_in_a_cell_the_deeper_is_its_shade() -> None:
    snapshot, shown, told = last_of(Search(), search_picture)
    assert isinstance(snapshot, SearchSnapshot)
    assert told["share"] == pytest.approx(snapshot.detection)
    order = np.argsort(snapshot.mass, axis=None)
    shades = shown.classes.flat[order].astype(int)
    assert (np.diff(shades) >= 0).all()
    assert shown.classes.flat[order[-1]] == 2 + SHADES
    assert (shades[snapshot.mass.flat[order] < snapshot.mass.max() / (2.1 * SHADES)] == 0).all()


def test_what_is_watched_goes_no_faster_than_asked() -> None:
    time, slept = [0.0], list[float]()

    def sleep(seconds: float) -> None:
        slept.append(seconds)
        time[0] += seconds

    mission = Track(content())
    hub = Hub("fleet", clock=lambda: time[0])
    shower = Shower[TrackSnapshot](
        hub, lambda each: track_picture(mission.scene, each), 5.0, clock=lambda: time[0], sleep=sleep
    )
    mission.play([shower])
    first, last = hub.history.span
    assert sum(slept) == pytest.approx((last - first) / 5.0, rel=0.1)

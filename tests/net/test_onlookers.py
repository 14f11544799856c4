"""What an operator sees of teams on a network whose truth it does not know: as the robots tell of it."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import yaml
from msgspec import structs

from tests.fuzz.decoders import conditions
from tests.support import search_missions, track_scenes
from tests.support.monitor_scenes import SMALL, case
from vedette.agent.events import Pose, Sensed
from vedette.errors import InputError
from vedette.maps import FREE, OCCUPIED
from vedette.missions.flights import TeamOptions
from vedette.missions.flying import RoundTimes
from vedette.missions.monitor.assemble import MonitorTeam
from vedette.missions.monitor.monitoring import FieldLook, Monitoring
from vedette.missions.search.assemble import SearchTeam
from vedette.missions.search.options import SearchOptions
from vedette.missions.track.assemble import TrackTeam
from vedette.missions.track.options import TrackOptions
from vedette.net.config import load_config
from vedette.net.domain import DomainTeller
from vedette.net.domain_picture import DomainOnlooker
from vedette.net.feed import Onlooker, TeamFeed
from vedette.net.gather import UNHEARD
from vedette.net.onlookers import onlooker_of
from vedette.net.report import Report
from vedette.net.search.content import SearchTeller
from vedette.net.search.picture import SearchOnlooker
from vedette.net.track.content import TrackTeller
from vedette.net.track.picture import TrackOnlooker
from vedette.record.space import LITTLE
from vedette.sim.domains import domain_of
from vedette.window.picture import NOTHING, SHADES

TIMES = RoundTimes(0.02, 0.03)


def report(robot: int, content: bytes, time: float = 0.0) -> Report:
    """A vehicle's, that flies at 10, 20 m."""
    (told,) = conditions()
    return Report(structs.replace(told, robot=robot, x=10.0, y=20.0, time=time, state="flying"), content)


def drawn(onlooker: Onlooker[Any, Any], reports: dict[int, Report], **states: str) -> tuple[Any, Any, Any]:
    """What is seen, its picture, and what that tells."""
    named = {int(robot[1:]): state for robot, state in states.items()}
    scene, snapshot = onlooker.see(reports, named)
    shown = onlooker.draw(scene, snapshot, replace(NOTHING, numbers=onlooker.numbers(reports)))
    return snapshot, shown, json.loads(shown.text)


def test_targets_lie_where_the_first_vehicle_that_is_heard_has_them() -> None:
    scenario = track_scenes.scenario()
    team = TrackTeam(scenario, TrackOptions(), TIMES)
    other = track_scenes.scenario(
        targets=[{"model": "static", "mean": [9 * k, 9], "sd": [2, 2]} for k in (1, 2, 3)]
    )
    contents = [
        TrackTeller(TrackTeam(each, TrackOptions(), TIMES).assemble(0, 1), each).content(0.0)
        for each in (other, scenario)
    ]
    onlooker = TrackOnlooker(scenario, "fleet")
    reports = {0: report(0, contents[0]), 1: report(1, contents[1])}
    snapshot, _, told = drawn(onlooker, reports, _0="silent, was flying")
    np.testing.assert_allclose(snapshot.means, team.prior.means)
    np.testing.assert_allclose([mark[:2] for mark in told["marks"]], team.prior.means[:, :2])
    assert [each["name"] for each in told["robots"]] == scenario.vehicle_names
    assert [each["state"] for each in told["robots"]] == ["silent, was flying", "flying", UNHEARD]
    assert [each["alive"] for each in told["robots"]] == [False, True, True]
    assert (told["robots"][2]["x"], told["robots"][2]["y"]) == scenario.vehicles[2].start[:2]
    assert [name for name, _ in told["figures"]] == ["entropy"]  # nobody here knows the error


def test_tracks_are_shown_as_they_are_by_now() -> None:
    scenario = track_scenes.scenario()
    team = TrackTeam(scenario, TrackOptions(), TIMES)
    content = TrackTeller(team.assemble(0, 1), scenario).content(0.0)
    snapshot, *_ = drawn(TrackOnlooker(scenario, "fleet"), {0: report(0, content, 5.0)})
    moved = team.prior.means[0, :2] + 5.0 * team.prior.means[0, 2:]
    np.testing.assert_allclose(snapshot.means[0, :2], moved)


def test_a_pdf_is_as_deep_as_the_vehicle_takes_it_to_be_likely() -> None:
    known = search_missions.case()
    team = SearchTeam(known, SearchOptions(), TIMES)
    content = SearchTeller(team.assemble(1, 1), known).content(0.0)
    _, shown, told = drawn(SearchOnlooker(known), {1: report(1, content)})
    order = np.argsort(known.pdf.mass, axis=None)
    assert (np.diff(shown.classes.flat[order].astype(int)) >= 0).all()
    assert shown.classes.max() == OCCUPIED + SHADES
    assert told["share"] is None  # nobody here knows what has been detected
    assert [each["state"] for each in told["robots"]] == [UNHEARD, "flying", UNHEARD]


def test_a_field_is_shown_as_it_is_taken_to_be() -> None:
    team, monitor = MonitorTeam(case(), TeamOptions(), TIMES), domain_of("monitor")
    agent = team.assemble(0, 1)
    mission = agent.mission
    assert isinstance(mission, Monitoring)
    mission.observe(Sensed(FieldLook(50, 26.0), 1.0), Pose(2.0, 3.0, 0.0), (), 1.0)
    mission.publish(1.0)
    content = DomainTeller(agent, monitor, team.case).content(3.0)
    snapshot, shown, told = drawn(DomainOnlooker(monitor, team.case), {0: report(0, content, 3.0)})
    np.testing.assert_allclose(snapshot.mean, mission.known(3).mean, rtol=1e-6)
    assert np.argmax(shown.classes) == np.argmax(mission.known(3).mean) == 50
    assert [name for name, _ in told["figures"]] == ["entropy"]


def test_of_a_domain_of_ones_own_it_is_seen_who_moves_where() -> None:
    own = domain_of("vedette.missions.own.skeleton:Skeleton")
    known = own.case(None)
    team = own.team(known, TeamOptions(), TIMES)
    content = DomainTeller(team.assemble(0, 1), own, known).content(0.0)
    _, shown, told = drawn(DomainOnlooker(own, known), {0: report(0, content)})
    assert (shown.classes == FREE).all()
    assert (told["robots"][0]["x"], told["robots"][0]["y"]) == (10.0, 20.0)


@pytest.mark.parametrize("damage", [b"", b"\xff" * 40, b"\x93\x01\x02\x03"])
def test_what_makes_no_sense_is_told_apart(damage: bytes) -> None:
    monitor = domain_of("monitor")
    onlookers: list[Onlooker[Any, Any]] = [
        TrackOnlooker(track_scenes.scenario(), "fleet"),
        SearchOnlooker(search_missions.case()),
        DomainOnlooker(monitor, case()),
    ]
    for onlooker in onlookers:
        with pytest.raises(ValueError, match="report"):
            onlooker.see({0: report(0, damage)}, {})


@pytest.mark.parametrize(
    ("mission", "scenario", "kind"),
    [
        ("track", track_scenes.content(), TrackOnlooker),
        ("search", search_missions.SMALL, SearchOnlooker),
        ("domain", SMALL, DomainOnlooker),
    ],
)
def test_who_looks_knows_the_scenario_from_a_robots_file(
    mission: str, scenario: dict[str, Any], kind: type, tmp_path: Path
) -> None:
    (tmp_path / "scene.yaml").write_text(yaml.safe_dump(scenario))
    options = {"name": "monitor"} if mission == "domain" else {}
    robot = {"team": "t", "robot": 1, mission: options, "begins": "2027-01-31T12:00:00Z"}
    file = tmp_path / "robot.yaml"
    file.write_text(yaml.safe_dump(robot | {"scenario": "scene.yaml"}))
    assert isinstance(onlooker_of(load_config(file), tmp_path), kind)
    (tmp_path / "scene.yaml").unlink()
    with pytest.raises(InputError, match=r"scene\.yaml"):
        onlooker_of(load_config(file), tmp_path)


def test_what_a_team_has_sent_is_told_and_that_the_disk_for_its_record_is_nearly_full(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    operator: Any = SimpleNamespace(subscribe=lambda *what: None)
    access: Any = SimpleNamespace()
    feed = TeamFeed(operator, access, TrackOnlooker(track_scenes.scenario(), "six"), tmp_path)
    monkeypatch.setattr(shutil, "disk_usage", lambda path: SimpleNamespace(free=LITTLE - 1))
    feed.hearing.reports[0] = report(0, b"")
    feed.hearing._times[0] = 0.0
    beside, condition = feed._beside(), feed.hearing.reports[0].condition
    assert f"disk full: 67 MB left for {tmp_path}" in beside.alerts
    assert beside.counts == {1: (condition.rounds, sum(condition.bytes.values()))}

"""Records of vehicles, and of agents: looked at and drawn again, and their figures side by side."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.image import imread
from msgspec import structs

from tests.fuzz.decoders import conditions
from tests.support import search_missions, track_scenes
from tests.support.commands import Command
from tests.support.monitor_scenes import SMALL, case
from vedette.errors import InputError
from vedette.maps import FREE, OCCUPIED, GridFrame
from vedette.missions.flights import TeamOptions
from vedette.missions.flying import RoundTimes
from vedette.missions.search.assemble import SearchTeam
from vedette.missions.search.options import SearchOptions
from vedette.missions.track.assemble import TrackTeam
from vedette.missions.track.options import TrackOptions
from vedette.net.domain import DomainTeller
from vedette.net.domain_picture import DomainOnlooker
from vedette.net.explore.content import content
from vedette.net.keeping import PERIOD, Keeper
from vedette.net.report import Report
from vedette.net.search.content import SearchTeller
from vedette.net.search.picture import SearchOnlooker
from vedette.net.track.content import TrackTeller
from vedette.net.track.picture import TrackOnlooker
from vedette.record.flown import scene_of, snapshots_of
from vedette.record.folder import OutputFolder
from vedette.record.monitor.log import MonitorScene
from vedette.run import DomainMission, Search, Track
from vedette.sim.domains import domain_of
from vedette.window.flights import search_picture, track_picture
from vedette.window.recorded import recorded

OWN = "vedette.missions.own.skeleton:Skeleton"
TIMES = RoundTimes(0.02, 0.03)


@pytest.fixture
def vedette(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Command:
    """The command, run in this process."""
    return Command(monkeypatch, capsys)


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """Missions that were run and recorded, each with its folder."""
    folder = tmp_path_factory.mktemp("runs")
    missions: dict[str, Any] = {
        "track": Track(track_scenes.content(duration=12), kills=[(3, 6.0)], record=folder / "track"),
        "search": Search(search_missions.SMALL | {"duration": 16}, record=folder / "search"),
        "monitor": DomainMission(
            domain_of("monitor"), SMALL | {"no_go": [[[10, 2], [14, 2], [14, 6]]]}, record=folder / "monitor"
        ),
        "own": DomainMission(domain_of(OWN), record=folder / "own"),
    }
    for name, mission in missions.items():
        report = mission.play()
        report.summary.write(folder / name / "summary.json")
    return {name: (mission, folder / name) for name, mission in missions.items()}


def again(runs: dict[str, Any], name: str) -> tuple[Any, list[Any], list[Any]]:
    """A mission's scene as it is recorded, and its snapshots as they were and as they are read."""
    mission, folder = runs[name]
    scene = scene_of(folder / "run.mcap")
    assert scene is not None
    log = mission._watched.report.log
    return scene, list(log.snapshots), list(snapshots_of(folder / "run.mcap", scene))


@pytest.mark.parametrize("name", ["track", "search", "monitor", "own"])
def test_a_record_gives_back_the_vehicles_that_were_recorded(runs: dict[str, Any], name: str) -> None:
    scene, told, read = again(runs, name)
    mine = runs[name][0].scene
    for field in scene.__dataclass_fields__:
        np.testing.assert_array_equal(getattr(scene, field), getattr(mine, field))
    assert [each.t for each in read] == pytest.approx([each.t for each in told])
    for mine, theirs in zip(read, told, strict=True):
        for a, b in zip(mine.vehicles, theirs.vehicles, strict=True):
            assert (a.state, a.alive) == (b.state, b.alive)
            if b.alive:
                assert (a.x, a.y) == pytest.approx((b.x, b.y))
                assert np.cos(a.heading - b.heading) == pytest.approx(1.0)
                assert a.path[-1] == pytest.approx(b.path[-1]) if len(b.path) else not len(a.path)


def test_targets_are_recorded_with_what_is_known_of_their_places(runs: dict[str, Any]) -> None:
    _, told, read = again(runs, "track")
    for mine, theirs in zip(read, told, strict=True):
        np.testing.assert_allclose(mine.means[:, :2], theirs.means[:, :2])
        np.testing.assert_allclose(mine.covariances[:, :2, :2], theirs.covariances[:, :2, :2])
        np.testing.assert_allclose(mine.truth[:, :2], theirs.truth[:, :2])
        assert (mine.entropy, mine.nees) == pytest.approx((theirs.entropy, theirs.nees))
        assert [each.seen for each in mine.vehicles if each.alive] == [
            each.seen for each in theirs.vehicles if each.alive
        ]


def test_a_pdf_and_a_field_are_recorded_in_per_cent(runs: dict[str, Any]) -> None:
    _, told, read = again(runs, "search")
    full = told[0].mass.max()
    np.testing.assert_allclose(read[0].mass, told[0].mass, atol=0.006 * full)
    assert [each.detection for each in read] == pytest.approx([each.detection for each in told])
    scene, told, read = again(runs, "monitor")
    assert isinstance(scene, MonitorScene)
    assert scene.blocked.any()
    measured = [(a, b) for a, b in zip(read, told, strict=True) if b.mean is not None]
    assert measured
    for mine, theirs in measured:
        span = float(np.ptp(theirs.mean))
        np.testing.assert_allclose(mine.mean, theirs.mean, atol=0.006 * span)
        assert mine.rmse == pytest.approx(theirs.rmse)
    assert read[-1].way == pytest.approx(told[-1].way, rel=0.2)


@pytest.mark.parametrize(
    ("name", "pictures"),
    [
        ("track", {"tracks.png", "entropy-recorded.png", "mission.gif"}),
        ("search", {"pdf.png", "mission.gif"}),
        ("monitor", {"field-recorded.png", "curves-recorded.png", "mission.gif"}),
        ("own", {"ways-recorded.png", "curves-recorded.png", "mission.gif"}),
    ],
)
def test_pictures_of_vehicles_are_drawn_anew(
    vedette: Command, runs: dict[str, Any], name: str, pictures: set[str], tmp_path: Path
) -> None:
    ran = vedette("plot", runs[name][1], "--out", tmp_path / "again", "--animate")
    assert ran.status == 0, ran.err
    assert {each.name for each in (tmp_path / "again").iterdir()} == pictures
    assert all(each.stat().st_size > 3000 for each in (tmp_path / "again").iterdir())


def test_the_redrawn_tracks_are_those_that_the_mission_drew(
    vedette: Command, runs: dict[str, Any], tmp_path: Path
) -> None:
    from vedette.record.track.tracks import tracks_png

    mission, folder = runs["track"]
    tracks_png(mission._watched.report.log, tmp_path / "tracks.png")
    vedette("plot", folder, "--out", tmp_path / "again")
    mine, theirs = (imread(folder / "tracks.png") for folder in (tmp_path / "again", tmp_path))
    assert mine.shape == theirs.shape
    assert (
        np.mean(np.abs(mine - theirs).max(axis=2) > 0.02) < 0.002
    )  # ways' points on straight lines are left out


def test_the_page_plays_records_of_vehicles(runs: dict[str, Any]) -> None:
    for name, draw in (("track", track_picture), ("search", search_picture)):
        mission, folder = runs[name]
        hub = recorded(folder / "run.mcap")
        last = mission._watched.report.log.snapshots[-1]
        shown = hub.history.at(last.t)
        assert shown is not None
        mine, theirs = json.loads(shown.text), json.loads(draw(mission.scene, last).text)
        assert [each["name"] for each in mine["robots"]] == [each["name"] for each in theirs["robots"]]
        assert [mark[:2] for mark in mine["marks"]] == [mark[:2] for mark in theirs["marks"]]
        assert not hub.live
    for name in ("monitor", "own"):
        assert recorded(runs[name][1] / "run.mcap").history.span[1] > 10.0


def test_a_record_whose_scene_makes_no_sense_is_told_of(
    runs: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from vedette.record import flown

    for scene in ("{", "{}", '{"vehicles": 3}'):
        monkeypatch.setattr(flown, "facts_of", lambda path, told=scene: {"kind": "track", "scene": told})
        with pytest.raises(InputError, match="what it tells of its mission makes no sense"):
            scene_of(tmp_path / "run.mcap")


def test_figures_of_vehicles_are_compared(vedette: Command, runs: dict[str, Any]) -> None:
    ran = vedette("compare", runs["track"][1], runs["search"][1], "--json")
    told = json.loads(ran.out)
    assert told["vehicles"] == [3, 3]
    assert told["targets"] == [3, None]


# -- what agents keep -----------------------------------------------------------------------------------


def kept(folder: Path, mission: str) -> Path:
    """The folder of an agent that has reported for 40 s, and left."""
    (told,) = conditions()
    frame = GridFrame(0.1, 30, 40, -1.0, 2.0)
    scenario, search, field = track_scenes.scenario(), search_missions.case(), case()
    own = domain_of(OWN)
    monitor, known = domain_of("monitor"), own.case(None)
    tellers: dict[str, Any] = {
        "track": TrackTeller(TrackTeam(scenario, TrackOptions(), TIMES).assemble(1, 1), scenario),
        "search": SearchTeller(SearchTeam(search, SearchOptions(), TIMES).assemble(1, 1), search),
        "monitor": DomainTeller(monitor.team(field, TeamOptions(), TIMES).assemble(1, 1), monitor, field),
        "own": DomainTeller(own.team(known, TeamOptions(), TIMES).assemble(1, 1), own, known),
    }
    onlookers: dict[str, Any] = {
        "track": TrackOnlooker(scenario, "fleet", only=1),
        "search": SearchOnlooker(search, only=1),
        "monitor": DomainOnlooker(monitor, field, only=1),
        "own": DomainOnlooker(own, known, only=1),
    }
    name = {"monitor": "domain", "own": "domain"}.get(mission, mission)
    folder.mkdir()
    keeper = Keeper(OutputFolder(folder), "t", name, lambda line: None, onlookers.get(mission))
    for t in range(0, 41, 4):
        if mission == "explore":
            rows = slice(0, 10 + t // 4)
            classes = np.full((rows.stop, 40), FREE, np.uint8)
            classes[0] = OCCUPIED
            packed = content(frame, (rows, slice(0, 40)), classes, classes > 0, None)
        else:
            packed = tellers[mission].content(0.0)
        state = "flying" if t < 40 else "left"
        condition = structs.replace(told, robot=1, time=float(t), began=0.0, x=1.0 + t, y=30.0, state=state)
        keeper.take(Report(condition, packed), 1.01 * PERIOD * t / 4.0)
    return folder


@pytest.mark.parametrize(
    ("mission", "picture"),
    [
        ("explore", "progress.png"),
        ("track", "tracks.png"),
        ("search", "pdf.png"),
        ("monitor", "field-recorded.png"),
        ("own", "ways-recorded.png"),
    ],
)
def test_what_an_agent_kept_is_drawn_played_and_compared(
    vedette: Command, mission: str, picture: str, tmp_path: Path
) -> None:
    folder = kept(tmp_path / "kept", mission)
    ran = vedette("plot", folder, "--out", tmp_path / "again")
    assert ran.status == 0, ran.err
    assert (tmp_path / "again" / picture).stat().st_size > 3000
    shown = recorded(folder / "run.mcap").history.at(20.0)
    assert shown is not None
    (robot,) = json.loads(shown.text)["robots"]
    assert (robot["x"], robot["y"]) == (21.0, 30.0)
    if mission == "explore":
        assert np.count_nonzero(shown.classes == FREE) == 40 * 14
    told = json.loads(vedette("compare", folder, folder, "--json").out)
    assert told["time_s"] == [40.0, 40.0]

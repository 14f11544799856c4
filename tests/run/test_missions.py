"""Missions from Python are those of the commands, whole or step by step, looked into or not."""

from __future__ import annotations

import os
import signal
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from tests.support.commands import FILES, Command
from tests.support.track_scenes import content
from vedette import run
from vedette.agent.events import Pose, Scan, Sensed
from vedette.maps import FREE, OCCUPIED, UNKNOWN, read_map
from vedette.outcome import Outcome
from vedette.record.explore.log import ExploreSnapshot
from vedette.run.mission import StepwiseMission

SOLID = np.zeros((40, 60), bool)  # two rooms of 3 x 4 m
SOLID[[0, -1], :] = SOLID[:, [0, -1]] = SOLID[:25, 30] = True
ROOMS = (SOLID, 0.1)
RADAR = content(duration=6)
SEA: dict[str, Any] = {
    "area": [0, 0, 600, 400],
    "cell": 40,
    "duration": 20,
    "step": 2,
    "prior": [{"type": "gaussian", "mean": [300, 200], "sigma": 100}],
    "target": {"drift": [0.5, 0.2], "diffusion": 4, "start": [520, 360]},
    "detector": {"type": "definite", "detection": 0.8, "range": 60},
    "vehicles": [{"name": name, "start": [60 * k, 60, 45], "speed": 20} for k, name in ((1, "a"), (2, "b"))],
}


@pytest.fixture
def vedette(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Command:
    """The command, run in a folder with scenarios."""
    monkeypatch.chdir(tmp_path)
    Path("scenario.yaml").write_text(yaml.safe_dump(RADAR))
    Path("sea.yaml").write_text(yaml.safe_dump(SEA))
    return Command(monkeypatch, capsys)


def missions() -> list[StepwiseMission[Any, Any, Any, Any]]:
    """One of each domain."""
    return [run.Explore(ROOMS, 2, 1), run.Track(RADAR, 1), run.Search(SEA, 1)]


# -- the same as the commands -----------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("name", ["explore", "track", "search"])
def test_without_arguments_a_mission_is_that_of_the_command(name: str, vedette: Command) -> None:
    assert vedette(name, "--json").out == getattr(run, name)().to_json()


def test_a_whole_mission_is_that_of_the_command_to_the_byte(vedette: Command) -> None:
    ran = vedette("track", "scenario.yaml", "--seed", 3, "--json", "--kill", "2@3", "--link-loss", 0.1)
    assert run.track("scenario.yaml", 3, kills=[(2, 3.0)], link_loss=0.1).to_json() == ran.out
    ran = vedette("search", "sea.yaml", "--seed", 3, "--json", "--radio", 300, "--trials", 50)
    assert run.search("sea.yaml", 3, radio=300, trials=50).to_json() == ran.out
    vedette("world", "maze", "--seed", 1, "--width", 10, "--height", 10, "--out", "maze")
    options = ("--robots", 2, "--seed", 3, "--planner", "rate", "--max-time", 9, "--json", "--out", "out")
    ran = vedette("explore", "maze/map.yaml", *options)
    result = run.explore("maze/map.yaml", 2, 3, planner="rate", max_time=9, record="recorded")
    assert result.to_json() == ran.out
    result.save("recorded")
    assert {path.name for path in Path("recorded").iterdir()} == FILES["explore"]
    for file in FILES["explore"] - {"timing.json"}:
        assert Path("out", file).read_bytes() == Path("recorded", file).read_bytes(), file


def test_every_figure_of_the_summary_is_an_attribute() -> None:
    result = run.Search(SEA, 1).run(trials=20)
    for name, value in vars(result.report.summary).items():
        assert getattr(result, name) is value
    assert result.timing.wall_s > 0.0


# -- step by step -----------------------------------------------------------------------------------------


def look_at(mission: StepwiseMission[Any, Any, Any, Any]) -> None:
    """Look at everything there is."""
    n = len(mission.poses)
    assert mission.poses.shape == (n, 3)
    assert len(mission.observed) == len(mission.deciding) == len(mission.states) == len(mission.alive) == n
    match mission:
        case run.Explore():
            assert mission.map.shape == SOLID.shape
        case run.Track():
            assert (mission.means.shape, mission.covariances.shape) == ((3, 4), (3, 4, 4))
        case run.Search():
            assert mission.pdf.shape == (10, 15)
            assert mission.pdf.sum() == pytest.approx(1.0, abs=1e-6)


def test_stepping_and_looking_is_the_mission_run_at_once() -> None:
    for stepped, whole in zip(missions(), missions(), strict=True):
        assert (stepped.now, stepped.over, stepped.snapshot) == (0.0, None, None)
        while stepped.step() is None:
            look_at(stepped)
        whole.play()
        assert stepped.over is whole.over is not None
        assert stepped.result().to_json() == whole.result().to_json()  # type: ignore[attr-defined]
        over = stepped.now
        assert stepped.step(5) is stepped.over
        assert stepped.now == over


def test_a_step_is_a_tenth_of_a_second_and_shows_what_has_been_observed() -> None:
    explore, track, search = missions()
    explore.step()
    assert explore.now == pytest.approx(0.1)
    explore.step(9)
    assert explore.now == pytest.approx(1.0)
    for pose, events in zip(explore.poses, explore.observed, strict=True):
        told, scan = events
        assert isinstance(told, Pose)
        assert (told.x, told.y, told.heading) == pytest.approx(pose)
        assert isinstance(scan, Scan)
        assert scan.ranges.shape == (360,)
    track.step(20)
    assert all(isinstance(events[-1], Sensed) for events in track.observed)
    search.step(20)
    assert all(isinstance(events[-1], Sensed) for events in search.observed)
    search.step()
    assert all(len(events) == 1 for events in search.observed)  # between two looks there is the pose alone


def test_decisions_are_seen_while_they_are_pending_and_when_they_are_made() -> None:
    mission = run.Explore(ROOMS, 2, 1)
    pending, proposed = False, False
    while mission.step() is None:
        for deciding in mission.deciding:
            pending |= deciding.pending
            proposed |= deciding.proposed is not None
            assert (deciding.impact is None) == (deciding.rounds == 0)
    assert pending
    assert proposed
    assert sum(deciding.rounds for deciding in mission.deciding) >= mission.result().rounds > 0


def test_a_mission_that_is_asked_for_its_result_is_interrupted() -> None:
    for mission in missions():
        mission.step(20)
        result = mission.result()
        assert isinstance(result, run.ExploreResult | run.TrackResult | run.SearchResult)
        assert (result.outcome, result.time_s) == (Outcome.INTERRUPTED, pytest.approx(2.0))
        assert mission.step() is Outcome.INTERRUPTED
        assert mission.now == pytest.approx(2.0)


def test_ctrl_c_ends_a_run_in_good_order_and_what_was_to_be_compared_too() -> None:
    before = signal.getsignal(signal.SIGINT)
    for mission in (run.Explore(ROOMS, 2, 1), run.Track(RADAR, 1), run.Search(SEA, 1)):
        result = mission.run(lambda snapshot: snapshot.t < 2.0 or os.kill(os.getpid(), signal.SIGINT))
        assert result.outcome is Outcome.INTERRUPTED
        assert 2.0 <= result.time_s < 4.0
        assert signal.getsignal(signal.SIGINT) is before


# -- what there is to see in the end ----------------------------------------------------------------------


def test_progress_comes_in_order_of_time_and_the_last_snapshot_stays() -> None:
    mission, seen = run.Explore(ROOMS, 2, 1), list[ExploreSnapshot]()
    result = mission.run(seen.append)
    times = [snapshot.t for snapshot in seen]
    assert times == sorted(times)
    assert times[-1] == result.time_s
    assert mission.snapshot is seen[-1]
    assert seen[-1].coverage == result.coverage


def test_results_hold_maps_tracks_and_pdf_as_arrays(tmp_path: Path) -> None:
    explored = run.explore(ROOMS, 2, 1)
    assert set(np.unique(explored.map).tolist()) <= {UNKNOWN, FREE, OCCUPIED}
    assert explored.map.shape == explored.frame.shape == SOLID.shape
    known = explored.map != UNKNOWN
    assert np.mean(known) > 0.9
    assert np.mean((explored.map == OCCUPIED)[known] == SOLID[known]) > 0.99
    explored.save(tmp_path)
    assert np.array_equal(read_map(tmp_path / "map.yaml")[1], explored.map)
    tracked = run.track(RADAR, 1, compare=False)
    error = np.square(tracked.means - tracked.truth)[:, :2].sum(axis=1).mean()
    assert error == pytest.approx(tracked.log.snapshots[-1].squared_error)
    assert np.all(np.linalg.eigvalsh(tracked.covariances[:, :2, :2]) > 0.0)
    searched = run.search(SEA, 1, compare=False, trials=0)
    assert searched.pdf.shape == searched.frame.shape
    assert searched.pdf.sum() == pytest.approx(1.0, abs=1e-5)


def test_a_record_is_whole_however_its_mission_is_left(tmp_path: Path) -> None:
    from mcap.reader import make_reader

    with run.Explore(ROOMS, 2, 1, record=tmp_path) as mission:
        mission.step(30)
    with (tmp_path / "run.mcap").open("rb") as file:
        stamps = [message.log_time for _, _, message in make_reader(file).iter_messages()]
    assert max(stamps) == 3_000_000_000
    assert [path.name for path in tmp_path.iterdir()] == ["run.mcap"]

"""After the fact: pictures drawn anew, runs compared, a mission gone on with."""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest

from tests.support.commands import Command
from tests.support.small_missions import small_office
from vedette.agent.orders import Pause
from vedette.cli.compare import figures_side_by_side
from vedette.maps import UNKNOWN, read_map
from vedette.record.explore.details import RobotDetails, encode
from vedette.record.explore.log import RobotSample
from vedette.record.explore.read import read_scene, read_snapshots
from vedette.run import Explore
from vedette.sim.orders import OrderAt

SHORT = 40.0  # a mission of so long leaves something to do [s]
TROUBLED: dict[str, Any] = {
    "max_time": SHORT,
    "link_loss": 0.1,
    "kills": [(2, 6.0)],
}


def _told(robot: RobotSample) -> RobotDetails:
    """What is told of a robot, numbers as they are read."""
    return msgspec.json.decode(encode(RobotDetails.of(robot)), type=RobotDetails)


@pytest.fixture
def vedette(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Command:
    """The command, run in this process."""
    return Command(monkeypatch, capsys)


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A short mission's folder, of two robots whose links may fail."""
    folder = tmp_path_factory.mktemp("after")
    small_office().save(folder)
    mission = Explore(folder / "map.yaml", 2, **TROUBLED, record=folder / "run")
    mission.run().save(folder / "run")
    return folder / "run"


def test_a_record_gives_back_the_snapshots_that_were_recorded(run: Path) -> None:
    mission = Explore(run.parent / "map.yaml", 2, **TROUBLED)
    log = mission.run().log
    told = list(log.snapshots())
    scene = read_scene(run / "run.mcap")
    again = list(read_snapshots(run / "run.mcap", scene))
    assert scene.vehicles == log.scene.vehicles
    assert scene.frame == log.scene.frame
    assert [each.t for each in again] == pytest.approx(log.times.tolist())
    assert [each.coverage for each in again] == pytest.approx(log.coverage.tolist())
    assert [each.known_m2 for each in again] == pytest.approx(log.known_m2.tolist())
    poses = [[(robot.x, robot.y, robot.heading) for robot in each.robots] for each in again]
    away = np.array(poses) - log.poses
    away[..., 2] = np.remainder(away[..., 2] + np.pi, 2 * np.pi) - np.pi
    living = [[robot.alive for robot in each.robots] for each in again]
    np.testing.assert_allclose(away[np.array(living)], 0.0, atol=1e-9)
    for mine, theirs in zip(again, told, strict=True):
        assert [robot.state for robot in mine.robots] == [robot.state for robot in theirs.robots]
        assert [robot.alive for robot in mine.robots] == [robot.alive for robot in theirs.robots]
        assert [robot.driven for robot in mine.robots] == [robot.driven for robot in theirs.robots]
        assert [RobotDetails.of(robot) for robot in mine.robots] == list(map(_told, theirs.robots))
        assert mine.left_out == theirs.left_out
        assert mine.links is not None
        assert theirs.links is not None
        assert [(link.a, link.b, link.on_tree) for link in mine.links] == [
            (link.a, link.b, link.on_tree) for link in theirs.links
        ]
        assert [link.loss for link in mine.links] == pytest.approx(
            [link.loss for link in theirs.links], abs=1e-6
        )
    np.testing.assert_array_equal(again[-1].classes, told[-1].classes)


def test_pictures_are_drawn_anew_from_the_record(vedette: Command, run: Path, tmp_path: Path) -> None:
    ran = vedette("plot", run, "--out", tmp_path / "again")
    assert ran.status == 0
    assert (tmp_path / "again" / "curves.png").read_bytes() == (run / "curves.png").read_bytes()
    assert (tmp_path / "again" / "progress.png").stat().st_size > 0


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("summary.json", "{", "summary.json: not a summary"),
        ("summary.json", '{"schema_version": 2}', "schema_version is 2, not 3"),
        ("summary.json", '{"schema_version": 3}', "is missing: it is of another kind of mission"),
        ("run.mcap", "x", "run.mcap: not a whole MCAP file"),
    ],
)
def test_what_is_no_run_is_told_of_in_one_line(
    vedette: Command, run: Path, tmp_path: Path, name: str, content: str, message: str
) -> None:
    for file in ("summary.json", "run.mcap"):
        (tmp_path / file).write_bytes((run / file).read_bytes())
    (tmp_path / name).write_text(content)
    ran = vedette("plot", tmp_path)
    assert ran.status == 2
    assert len(ran.err.splitlines()) == 1
    assert message in ran.err


def test_runs_are_compared_by_what_differs(vedette: Command, run: Path, tmp_path: Path) -> None:
    other = tmp_path / "other"
    other.mkdir()
    figures = json.loads((run / "summary.json").read_text())
    figures["time_s"] *= 2.0
    figures["path_m"]["robot-1"] += 3.0
    (other / "summary.json").write_text(json.dumps(figures))
    told = json.loads(vedette("compare", run, other, "--json").out)
    assert told["time_s"] == [SHORT, 2 * SHORT]
    assert told["path_m"][1] - told["path_m"][0] == pytest.approx(3.0, abs=1e-5)
    shown = vedette("compare", run, other).out
    assert "80 (x2.00)" in shown
    assert "coverage" not in shown
    assert "coverage" in vedette("compare", run, other, "--all").out
    assert vedette("compare", run, run).out == "the runs have the same figures\n"
    assert vedette("compare", run).status == 2


@pytest.mark.parametrize("terminal", [True, False])
def test_no_name_and_no_value_of_a_table_is_cut(
    vedette: Command, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, terminal: bool
) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    monkeypatch.setattr(sys.stdout, "isatty", lambda: terminal)
    refused = {"they look alike in more than one way": 1}
    for name, more in (("one", 1), ("two", 2)):
        (tmp_path / name).mkdir()
        figures = {"schema_version": 3, "frames": {"refused": refused}, "min_clearance_m": 0.013 * more}
        (tmp_path / name / "summary.json").write_text(json.dumps(figures))
    runs = [tmp_path / name for name in ("one", "two", "two", "two", "two")]
    shown = vedette("compare", *runs, "--all").out
    assert "…" not in shown
    assert "min_clearance_m" in shown
    lines = [re.split("[│┃]", line)[1:-1] for line in shown.splitlines()]
    columns = ["".join(line[k].strip() for line in lines if line) for k in (0, 5)]  # unfolded
    assert "frames.refused.theylookalikeinmorethanoneway" in columns[0].replace(" ", "")
    assert "0.026(x2.00)" in columns[1].replace(" ", "")
    assert (len(shown.splitlines()[0]) <= 80) == terminal  # of the border, which has no colours


def test_of_errors_by_robot_the_largest_is_compared_and_no_sum_of_them() -> None:
    off = {"path_m": {"a": 1.0, "b": 2.0}, "pose_error_m": {"a": 0.25, "b": 0.5}}
    figures = {
        each.name: each.values
        for each in figures_side_by_side([off, off | {"pose_error_m": {"a": None, "b": None}}])
    }
    assert figures == {"path_m": (3.0, 3.0), "pose_error_m": (0.5, None)}


def test_of_what_is_not_by_robot_nothing_is_added_up() -> None:
    team = {"path_m": {"a": 1.0, "b": 2.0}, "bytes": {"a": {"fusion": 3}, "b": {"fusion": 4}}}
    told = {
        "schema_version": 3,
        **team,
        "left_out": [{"x": 9.0}],
        "comparison": {"shared": {"rmse": 5.0, "nees": 1.0}},
        "expected": {"ended": {"low": 1.0, "middle": 2.0}},
    }
    figures = {each.name: each.values[0] for each in figures_side_by_side([told])}
    assert figures == {
        "path_m": 3.0,
        "bytes": 7,
        "left_out": 1,
        "comparison.shared.rmse": 5.0,
        "comparison.shared.nees": 1.0,
        "expected.ended.low": 1.0,
        "expected.ended.middle": 2.0,
    }
    kept = {
        "time_s": 4.0,
        "condition": {"boot": 96, "x": 1.0, "rounds": 5, "bytes": {"fusion": 1, "overlay": 2}},
    }
    figures = {each.name: each.values[0] for each in figures_side_by_side([kept])}
    assert figures == {"time_s": 4.0, "rounds": 5, "bytes": 3}


def test_what_is_of_teams_alone_is_refused_with_a_record(vedette: Command, run: Path) -> None:
    for option, value in (("--foxglove", 0), ("--keys", "keys")):
        ran = vedette("watch", run, option, value)
        assert (ran.status, ran.out) == (2, "")
        assert ran.err.startswith(f"vedette: {option} is of teams on a network, and ")


def test_a_record_has_the_orders_that_robots_held(tmp_path: Path) -> None:
    order = OrderAt(2.0, Pause(robot=2))
    Explore(small_office(), 2, max_time=5.0, orders=(order,), record=tmp_path / "run").run()
    record = tmp_path / "run" / "run.mcap"
    held = [[robot.orders for robot in each.robots] for each in read_snapshots(record, read_scene(record))]
    assert held[0] == [(), ()]
    assert held[-1] == [(order.what,), (order.what,)]


def test_a_mission_goes_on_from_a_map_that_was_left(vedette: Command, run: Path, tmp_path: Path) -> None:
    world = run.parent / "map.yaml"
    fresh = json.loads(vedette("explore", world, "--robots", 2, "--out", tmp_path / "a", "--json").out)
    on = "--continue", run, "--robots", 2
    again = json.loads(vedette("explore", world, *on, "--out", tmp_path / "b", "--json").out)
    assert again["outcome"] == "complete"
    assert again["coverage"] >= fresh["coverage"] - 0.01
    assert again["time_s"] < fresh["time_s"]
    first = next(read_snapshots(tmp_path / "b" / "run.mcap", read_scene(tmp_path / "b" / "run.mcap")))
    left = read_map(run / "map.yaml")[1]
    assert np.count_nonzero(first.classes) >= np.count_nonzero(left)


def test_a_map_that_cannot_be_gone_on_with_is_refused(vedette: Command, run: Path, tmp_path: Path) -> None:
    frame, _ = read_map(run / "map.yaml")
    (tmp_path / "map.pgm").write_bytes(
        b"P5\n%d %d\n255\n" % (frame.cols, frame.rows) + bytes([205]) * frame.size
    )
    (tmp_path / "map.yaml").write_bytes((run / "map.yaml").read_bytes())
    ran = vedette("explore", run.parent / "map.yaml", "--continue", tmp_path)
    assert ran.status == 2
    assert "nothing is known in it" in ran.err
    assert np.all(read_map(tmp_path / "map.yaml")[1] == UNKNOWN)
    ran = vedette("explore", "--seed", 5, "--continue", run)
    assert ran.status == 2
    assert "is of the office of seed 0; add --seed 0" in ran.err

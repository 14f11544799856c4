"""What a robot finds out is kept: its folder holds whole files whenever it is looked at."""

from __future__ import annotations

import errno
import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from mcap.reader import make_reader
from msgspec import structs

from tests.fuzz.decoders import conditions
from tests.support.commands import Command
from tests.support.net_team import issue, real_time, wait_until
from tests.support.schemas import valid
from tests.support.small_missions import TWO_ROOMS, drawn
from vedette.errors import InputWarning
from vedette.maps import FREE, OCCUPIED, GridFrame, read_map
from vedette.net.endpoints import free_port
from vedette.net.explore.content import Spot, content
from vedette.net.keeping import PERIOD, Keeper, folder_of_a_start
from vedette.net.report import Report
from vedette.record.folder import OutputFolder
from vedette.record.robot import RobotRecorder
from vedette.record.space import LITTLE

FRAME = GridFrame(0.1, 30, 40, -1.0, 2.0)


def report(state: str, cells: int, time: float = 10.0) -> Report:
    """A robot's report of a map whose first cells are free, and one wall."""
    (condition,) = conditions()
    classes = np.zeros(FRAME.shape, np.uint8)
    classes.flat[:cells] = FREE
    classes[-1, -1] = OCCUPIED
    left = (Spot(1.0, 2.5, 7, "unseeable"),)
    known = slice(0, FRAME.rows), slice(0, FRAME.cols)
    told = content(FRAME, known, classes, classes > 0, None, left)
    return Report(structs.replace(condition, state=state, time=time, began=0.0), told)


def known(folder: Path) -> int:
    """How many cells the map in a folder knows."""
    frame, classes = read_map(folder / "map.yaml")
    assert (frame.origin_x, frame.origin_y) == pytest.approx((-1.0, 2.0))
    return int(np.count_nonzero(classes))


def messages(folder: Path) -> int:
    """How many messages the record in a folder has."""
    with (folder / "run.mcap").open("rb") as stream:
        summary = make_reader(stream).get_summary()
    assert summary is not None
    assert summary.statistics is not None
    return summary.statistics.message_count


def test_every_30_s_whole_files_are_in_place_and_the_end_is_told_with_what_is_left_out(
    tmp_path: Path,
) -> None:
    said: list[str] = []
    keeper = Keeper(OutputFolder(tmp_path), "office", "explore", said.append)
    keeper.take(report("driving", 10), 0.0)
    assert not (tmp_path / "map.yaml").exists()
    keeper.take(report("driving", 20), PERIOD)
    assert known(tmp_path) == 21
    first = messages(tmp_path)
    summary = valid("robot-summary", (tmp_path / "summary.json").read_text())
    assert summary["outcome"] is None
    assert said == []
    keeper.take(report("done", 30, time=341.0), PERIOD + 1.0)
    assert known(tmp_path) == 31
    assert messages(tmp_path) > first
    (line,) = said
    assert line.startswith("complete: ")
    assert "341 s" in line
    assert "frontiers left out: 1 unseeable" in line
    keeper.take(report("left", 30, time=342.0), PERIOD + 2.0)
    summary = valid("robot-summary", (tmp_path / "summary.json").read_text())
    assert summary["outcome"] == "complete"
    assert summary["left_out"] == [
        {"x": 1.0, "y": 2.5, "unknown_cells": 7, "why": "unseeable", "by": "robot-1"}
    ]
    assert [path.name for path in tmp_path.iterdir() if path.name.startswith(".part")] == []


def test_a_robot_that_is_stopped_before_the_end_says_that_it_was_interrupted(tmp_path: Path) -> None:
    said: list[str] = []
    keeper = Keeper(OutputFolder(tmp_path), "office", "explore", said.append)
    keeper.take(report("driving", 10), 0.0)
    keeper.take(report("left", 12), 1.0)
    assert known(tmp_path) == 13
    assert said[0].startswith("interrupted: ")
    assert valid("robot-summary", (tmp_path / "summary.json").read_text())["outcome"] == "interrupted"


def test_a_folder_that_takes_nothing_is_told_of_once_and_the_robot_goes_on(tmp_path: Path) -> None:
    said: list[str] = []
    keeper = Keeper(OutputFolder(tmp_path), "office", "explore", said.append)
    keeper.take(report("driving", 10), 0.0)
    (tmp_path / ".part-map.pgm").mkdir()
    keeper.take(report("driving", 10), PERIOD)
    keeper.take(report("driving", 10), 2 * PERIOD)
    assert len(said) == 1
    assert "cannot write" in said[0]
    (alert,) = keeper.alerts
    assert alert in said[0]
    (tmp_path / ".part-map.pgm").rmdir()
    keeper.take(report("driving", 10), 3 * PERIOD)
    assert known(tmp_path) == 11
    assert keeper.alerts == ()


def test_a_disk_that_is_nearly_full_is_an_alert_and_a_full_one_ends_no_mission(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    said: list[str] = []
    keeper = Keeper(OutputFolder(tmp_path), "office", "explore", said.append)
    free = [LITTLE]
    monkeypatch.setattr(shutil, "disk_usage", lambda path: SimpleNamespace(free=free[0]))
    assert keeper.alerts == ()
    free[0] -= 1
    assert keeper.alerts == (f"disk full: 67 MB left for {tmp_path}",)

    def full(*told: object, **more: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(RobotRecorder, "add", full)
    keeper.take(report("driving", 10), 0.0)
    assert said == ["[Errno 28] No space left on device; the mission goes on"]
    assert keeper.alerts[0] == "[Errno 28] No space left on device"


def test_what_an_earlier_start_left_stays_as_it_is(tmp_path: Path) -> None:
    out = tmp_path / "kept"
    out.mkdir()
    assert folder_of_a_start(out).path == out
    (out / "map.yaml").write_text("old")
    with pytest.warns(InputWarning, match="kept has what an earlier start left"):
        beside = folder_of_a_start(out).path
    assert beside == tmp_path / "kept-001"
    assert (out / "map.yaml").read_text() == "old"


@real_time
def test_an_agent_keeps_its_map_and_an_operator_fetches_it_while_it_goes_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    drawn(TWO_ROOMS).save(tmp_path)
    issue(tmp_path / "keys", 1)
    path = tmp_path / "robot.yaml"
    path.write_text(
        f"team: office\nrobot: 1\nout: kept\nlinks: {{listen: ['tls/127.0.0.1:{free_port()}'], "
        "keys: keys/robot-1}\nbody: {map: map.yaml, start: [1.0, 1.0, 0.0]}\n"
    )
    command = [sys.executable, "-m", "vedette", "agent", str(path), "--speed", "5"]
    log = (tmp_path / "log").open("w")
    agent = subprocess.Popen(command, stdout=log, stderr=log)
    vedette = Command(monkeypatch, capsys)
    try:
        fetch = (
            "map",
            path,
            "--keys",
            tmp_path / "keys" / "operator",
            "--out",
            tmp_path / "fetched",
            "--force",
        )
        wait_until(lambda: vedette(*fetch, "--wait", 5).status == 0, 60.0)
        assert np.count_nonzero(read_map(tmp_path / "fetched" / "map.yaml")[1]) > 0
        valid("robot-summary", (tmp_path / "fetched" / "summary.json").read_text())
        wait_until(lambda: "complete: " in (tmp_path / "log").read_text(), 60.0)
    finally:
        agent.send_signal(signal.SIGTERM)
        assert agent.wait(30.0) == 0
    kept = valid("robot-summary", (tmp_path / "kept" / "summary.json").read_text())
    assert kept["outcome"] == "complete"
    assert kept["condition"]["state"] == "left"
    assert messages(tmp_path / "kept") > 0
    ran = vedette(*fetch, "--wait", 0.5)
    assert ran.status == 1
    assert "nobody answered within 0.5 s" in ran.err

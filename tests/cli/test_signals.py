"""Whatever ends a command, it ends in good order; who reads what it says may leave."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from tests.support.commands import check_files, start
from tests.support.net_team import wait_until
from tests.support.schemas import valid

MANY = 60  # runs
STUDY = f"""
planners: [nearest]
worlds: [{{kind: maze, seeds: {list(range(MANY))}, width: 10, height: 10}}]
robots: [1]
platform: {{beams: 90, rate: 2}}
setup: {{max_time: 25}}
"""
CODE = "from vedette.__main__ import main; main()"


def under_way(process: subprocess.Popen[bytes]) -> None:
    assert process.stdout is not None
    next(line for line in process.stdout if b"10." in line)


@pytest.fixture(scope="module")
def maze(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("maze") / "maze"
    process = start(
        ["world", "maze", "--seed", "1", "--width", "10", "--height", "10", "--out", str(folder)],
        folder.parent,
    )
    assert process.wait(timeout=60) == 0
    return folder / "map.yaml"


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP], ids=lambda n: n.name)
def test_a_signal_ends_a_mission_as_ctrl_c_does(tmp_path: Path, number: signal.Signals) -> None:
    process = start(["explore", "--out", "out"], tmp_path)
    under_way(process)
    process.send_signal(number)
    out, err = process.communicate(timeout=60)
    assert (process.returncode, err) == (130, b"")
    assert b"interrupted" in out
    check_files(tmp_path / "out", "explore")
    assert json.loads((tmp_path / "out" / "summary.json").read_text())["outcome"] == "interrupted"


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP], ids=lambda n: n.name)
def test_a_signal_ends_a_study_which_keeps_what_is_done_and_goes_on(
    tmp_path: Path, number: signal.Signals
) -> None:
    (tmp_path / "tiny.yaml").write_text(STUDY)
    process = start(["study", "tiny.yaml", "--jobs", "2", "--out", "out"], tmp_path)
    results = tmp_path / "out" / "runs"
    wait_until(lambda: process.poll() is not None or len(list(results.glob("[!.]*.json"))) > 0, 60.0)
    process.send_signal(number)
    out, err = process.communicate(timeout=60)
    assert process.returncode == 130, err
    assert b"Traceback" not in err
    assert b"interrupted; what is done is kept" in out
    done = {path.name: path.read_bytes() for path in results.glob("[!.]*.json")}
    assert 0 < len(done) < MANY
    assert f"{MANY - len(done)} runs to go".encode() in out
    assert (tmp_path / "out" / "report.html").exists()
    for content in done.values():
        valid("study-run", content)


def test_a_signal_ends_a_reproduction_whose_report_is_written(tmp_path: Path) -> None:
    process = start(["reproduce", "--quick", "--out", "out"], tmp_path)
    assert process.stderr is not None
    next(line for line in process.stderr if b"[ 1/" in line)
    process.send_signal(signal.SIGTERM)
    out, err = process.communicate(timeout=60)
    assert process.returncode == 130, err
    assert b"interrupted; missing: " in out
    assert (tmp_path / "out" / "report.html").exists()


def test_under_nohup_a_terminal_that_closes_ends_nothing(maze: Path, tmp_path: Path) -> None:
    hung_up = "import os, signal; signal.signal(signal.SIGHUP, signal.SIG_IGN); "
    process = subprocess.Popen(
        [sys.executable, "-c", hung_up + CODE, "explore", str(maze), "--robots", "2", "--out", "out"],
        cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    )  # fmt: skip
    under_way(process)
    process.send_signal(signal.SIGHUP)
    assert process.communicate(timeout=60)[1] == b""
    assert process.returncode == 0
    assert json.loads((tmp_path / "out" / "summary.json").read_text())["outcome"] == "complete"


def test_a_second_signal_aborts_and_says_what_is_not_written(tmp_path: Path) -> None:
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "summary.json").write_text("of an earlier mission")
    twice = (
        "import os, signal, vedette.record.explore.outputs as outputs\n"
        "def write_map(*_):\n"
        "    for _ in range(2): os.kill(os.getpid(), signal.SIGTERM)\n"
        "outputs.write_map = write_map\n"  # summary and timing are written by then
    )
    ran = subprocess.run(
        [sys.executable, "-c", twice + CODE, "explore", "--max-time", "1", "--out", "out", "--force"],
        cwd=tmp_path, capture_output=True, timeout=60, check=False,
    )  # fmt: skip
    assert ran.returncode == 130
    assert ran.stderr.decode().splitlines()[0] == (
        "vedette: aborted; not written to out: map.yaml, map.pgm, progress.png, curves.png"
    )
    assert json.loads((tmp_path / "out" / "summary.json").read_text())["outcome"] == "time_limit"


@pytest.mark.parametrize("part", ["click", "numpy", "vedette.cli", "vedette.cli.explore"])
def test_ctrl_c_while_a_command_is_being_loaded_shows_no_traceback(tmp_path: Path, part: str) -> None:
    at = (
        "import os, signal, sys\n"
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"  # a background job inherits none
        "class Finder:\n"
        "    def find_spec(self, name, *_):\n"
        f"        if name == {part!r}: os.kill(os.getpid(), signal.SIGINT)\n"
        "sys.meta_path.insert(0, Finder())\n"
    )
    ran = subprocess.run(
        [sys.executable, "-c", at + CODE, "explore"],
        cwd=tmp_path,
        capture_output=True,
        timeout=60,
        check=False,
    )
    assert (ran.returncode, ran.stdout, ran.stderr.strip()) == (130, b"", b"")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("unbuffered", ["", "1"])
def test_a_reader_that_leaves_does_not_end_a_mission(maze: Path, tmp_path: Path, unbuffered: str) -> None:
    process = start(
        ["explore", str(maze), "--robots", "2", "--out", "out"], tmp_path, PYTHONUNBUFFERED=unbuffered
    )
    assert process.stdout is not None
    assert process.stdout.readline().startswith(b"    0.0 s")
    process.stdout.close()
    assert process.stderr is not None
    said = process.stderr.read()
    assert process.wait(timeout=60) == 0
    assert said == b"vedette: nobody reads standard output any more; going on without\n"
    check_files(tmp_path / "out", "explore")


def test_without_any_reader_a_mission_is_finished_all_the_same(maze: Path, tmp_path: Path) -> None:
    reading, writing = os.pipe()
    os.close(reading)
    command = [sys.executable, "-c", CODE, "explore", str(maze), "--robots", "2", "--out", "out"]
    ran = subprocess.run(command, cwd=tmp_path, stdout=writing, stderr=writing, timeout=60, check=False)
    os.close(writing)
    assert ran.returncode == 0
    check_files(tmp_path / "out", "explore")


@pytest.mark.parametrize("unbuffered", ["", "1"])
def test_a_full_disk_behind_standard_output_is_told_in_a_line(tmp_path: Path, unbuffered: str) -> None:
    with Path("/dev/full").open("wb") as full:
        ran = subprocess.run(
            [sys.executable, "-c", CODE, "world", "maze", "--out", "maze"],
            cwd=tmp_path, stdout=full, stderr=subprocess.PIPE, timeout=60, check=False,
            env=os.environ | {"PYTHONUNBUFFERED": unbuffered},
        )  # fmt: skip
    assert ran.returncode == 2
    assert ran.stderr == b"vedette: cannot write to standard output: No space left on device\n"

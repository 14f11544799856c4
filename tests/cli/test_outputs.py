"""No command writes over what it reads, into a folder that another run has, or into nothing."""

from __future__ import annotations

import errno
import os
import shutil
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap.writer import Writer
from PIL import Image

from vedette.cli import main
from vedette.maps import GridFrame, write_map
from vedette.record.display import Display
from vedette.record.explore.log import ExploreSnapshot
from vedette.record.lock import LOCK, locked

Vedette = Callable[..., tuple[int, str, str]]

TRACK = """
area: [0, 0, 400, 300]
duration: 4
vehicles: [{start: [100, 100, 0], speed: 20, sensor: {type: bearing, range: 300}}]
targets: [{model: static, mean: [200, 150], sd: [20, 20]}]
"""
SEARCH = """
area: [0, 0, 400, 300]
duration: 10
prior: [{type: uniform}, {type: image, file: ../images/heat.png}]
vehicles: [{start: [100, 100, 0], speed: 20}]
"""
STUDY = """
planners: [nearest]
maps: [{file: ../maps/room.yaml}]
robots: [1]
setup: {max_time: [1.0]}
"""
FAULTS = "faults: [{at: 1, fault: heal}]"


@pytest.fixture
def vedette(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Vedette:
    """The command, run in a folder with a folder for each kind of input."""
    solid = np.ones((42, 52), np.uint8) * 2
    solid[1:-1, 1:-1] = 1
    for name in ("maps", "images", "specs"):
        (tmp_path / name).mkdir()
    write_map(tmp_path / "maps" / "room", GridFrame(0.1, 42, 52), solid)
    Image.new("L", (4, 3), 200).save(tmp_path / "images" / "heat.png")
    elsewhere = (tmp_path / "maps" / "room.yaml").read_text().replace("room.pgm", "../images/room.pgm")
    (tmp_path / "maps" / "apart.yaml").write_text(elsewhere)
    shutil.copy(tmp_path / "maps" / "room.pgm", tmp_path / "images" / "room.pgm")
    (tmp_path / "specs" / "team.yaml").write_text("platforms: [{}]")
    (tmp_path / "specs" / "faults.yaml").write_text(FAULTS)
    (tmp_path / "specs" / "track.yaml").write_text(TRACK)
    (tmp_path / "specs" / "search.yaml").write_text(SEARCH)
    (tmp_path / "specs" / "study.yaml").write_text(STUDY)
    monkeypatch.chdir(tmp_path)

    def run(*arguments: object) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["vedette", *map(str, arguments)])
        with pytest.raises(SystemExit) as ended:
            main()
        said = capsys.readouterr()
        assert isinstance(ended.value.code, int)
        return ended.value.code, said.out, said.err

    return run


def everything(folder: Path) -> dict[str, bytes]:
    return {str(path): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


@pytest.mark.parametrize(
    ("command", "out", "held"),
    [
        ("explore maps/room.yaml", "maps", "room.yaml"),
        ("explore maps/room.pgm --resolution 0.1", "maps", "room.pgm"),
        ("explore maps/apart.yaml", "images", "room.pgm"),
        ("explore --team specs/team.yaml", "specs", "team.yaml"),
        ("explore --faults specs/faults.yaml", "specs", "faults.yaml"),
        ("team explore maps/room.yaml", "maps", "room.yaml"),
        ("team explore --team specs/team.yaml", "specs", "team.yaml"),
        ("track specs/track.yaml", "specs", "track.yaml"),
        ("track --faults specs/faults.yaml", "specs", "faults.yaml"),
        ("search specs/search.yaml", "specs", "search.yaml"),
        ("search specs/search.yaml", "images", "heat.png"),
        ("search --faults specs/faults.yaml", "specs", "faults.yaml"),
    ],
)
def test_force_never_writes_into_a_folder_that_an_input_lies_in(
    vedette: Vedette, tmp_path: Path, command: str, out: str, held: str
) -> None:
    before = everything(tmp_path)
    for force in ([], ["--force"]):
        status, said, error = vedette(*command.split(), "--out", out, *force)
        assert (status, said) == (2, "")
        assert error == f"vedette: {out} holds {held}, which this command reads; choose another folder\n"
    assert everything(tmp_path) == before


def test_a_study_is_not_left_where_its_maps_are_but_goes_on_from_its_own_copy_of_the_spec(
    vedette: Vedette, tmp_path: Path
) -> None:
    (tmp_path / "maps" / "runs").mkdir()
    status, _, error = vedette("study", "specs/study.yaml", "--out", "maps", "--jobs", 1)
    assert status == 2
    assert error == "vedette: maps holds room.yaml, which this command reads; choose another folder\n"
    assert vedette("study", "specs/study.yaml", "--out", "results", "--jobs", 1)[0] == 0
    copy = (tmp_path / "results" / "spec.yaml").read_bytes()
    status, said, error = vedette("study", "results/spec.yaml", "--out", "results", "--jobs", 1)
    assert (status, error) == (0, "")
    assert "1 run, 1 of them done" in said
    assert (tmp_path / "results" / "spec.yaml").read_bytes() == copy
    assert not (tmp_path / "results" / LOCK).exists()


@pytest.mark.parametrize(
    "command",
    [
        "explore maps/room.yaml --force",
        "track specs/track.yaml --force",
        "search specs/search.yaml --force",
        "study specs/study.yaml --jobs 1",
        "world maze --width 10 --height 10 --force",
    ],
)
def test_a_folder_that_another_run_has_is_refused_and_left_as_it_is(
    vedette: Vedette, tmp_path: Path, command: str
) -> None:
    (tmp_path / "out" / "runs").mkdir(parents=True)
    with locked(tmp_path / "out"):
        before = everything(tmp_path)
        status, said, error = vedette(*command.split(), "--out", "out")
        assert (status, said) == (2, "")
        assert error.startswith("vedette: out is in use by another run, process ")
        assert len(error.splitlines()) == 1
        assert everything(tmp_path) == before


def test_where_the_disk_is_full_at_a_records_end_the_map_and_the_figures_are_kept_all_the_same(
    vedette: Vedette, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(writer: Writer) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(Writer, "finish", full)
    options = "--robots", 1, "--max-time", 2, "--out", "out"
    status, _, error = vedette("explore", "maps/room.yaml", *options)
    assert (status, error) == (
        2,
        "vedette: cannot write out/run.mcap: No space left on device; choose another folder\n",
    )
    assert {path.name for path in (tmp_path / "out").iterdir()} == {
        "summary.json", "timing.json", "map.yaml", "map.pgm", "progress.png", "curves.png",
    }  # fmt: skip


def test_a_mission_whose_folder_vanishes_says_so_and_leaves_all_results_beside_it(
    vedette: Vedette, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    removed: list[float] = []

    def update(view: Display[ExploreSnapshot], snapshot: ExploreSnapshot) -> None:
        if snapshot.t >= 2.0 and not removed:
            removed.append(snapshot.t)
            shutil.rmtree(tmp_path / "out")
        if removed and snapshot.t > removed[0]:
            assert (tmp_path / "out-001").is_dir()

    monkeypatch.setattr(Display, "update", update)
    status, said, error = vedette("explore", "maps/room.yaml", "--robots", 1, "--out", "out")
    assert removed
    assert status == 0
    assert error == "vedette: out has vanished; results go to out-001\n"
    assert "out-001/progress.png" in said
    assert not (tmp_path / "out").exists()
    left = {path.name for path in (tmp_path / "out-001").iterdir()}
    assert left == {
        "summary.json", "timing.json", "map.yaml", "map.pgm", "progress.png", "curves.png", "run.mcap",
    }  # fmt: skip
    with (tmp_path / "out-001" / "run.mcap").open("rb") as file:
        stamps = [message.log_time for *_, message in make_reader(file).iter_messages()]
    assert min(stamps) == 0
    assert max(stamps) > 2e9

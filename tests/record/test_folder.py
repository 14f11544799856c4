"""Results survive their folder: that it vanishes is noticed, and another beside it takes its place."""

from __future__ import annotations

import resource
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from vedette.errors import InputError, InputWarning
from vedette.record.files import write_text
from vedette.record.folder import OutputFolder
from vedette.record.lock import locked
from vedette.record.mcap import atomic_stream


def _remove(path: Path) -> None:
    shutil.rmtree(path)


def _move(path: Path) -> None:
    path.rename(path.with_name("elsewhere"))


def _replace(path: Path) -> None:
    _move(path)
    path.mkdir()


def _remove_parent(path: Path) -> None:
    shutil.rmtree(path.parent)


WAYS = [_remove, _move, _replace, _remove_parent]


@pytest.fixture
def out(tmp_path: Path) -> Path:
    return tmp_path / "runs" / "out"


def test_a_folder_is_one_runs_at_a_time_and_holds_what_is_written_alone(out: Path) -> None:
    with OutputFolder.make(out, False, "x") as folder:
        assert folder.path == out
        write_text(folder / "a.txt", "a")
        folder.update(None)
        with pytest.raises(InputError, match="in use by another run"), OutputFolder.make(out, True, "x"):
            pytest.fail("both are in")
    assert [path.name for path in out.iterdir()] == ["a.txt"]


def test_without_a_name_runs_are_numbered(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.chdir(tmp_path)
    with OutputFolder.make(None, False, "x") as one, OutputFolder.make(None, False, "x") as other:
        assert (one.path, other.path) == (Path("runs/x-001"), Path("runs/x-002"))


@pytest.mark.parametrize("there", [False, True])
def test_a_run_that_comes_to_nothing_leaves_no_folder_that_was_not_there(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, there: bool
) -> None:
    monkeypatch.chdir(tmp_path)
    if there:
        (tmp_path / "runs").mkdir()
    with pytest.raises(InputError, match=r"^nothing$"), OutputFolder.make(None, False, "x"):
        raise InputError("nothing")
    assert [path.name for path in tmp_path.iterdir()] == ["runs"] * there


def test_where_not_even_a_lock_finds_room_no_folder_is_left(out: Path) -> None:
    out.parent.mkdir()
    least, most = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (0, most))  # no file may hold a byte
    try:
        with pytest.raises(
            InputError, match=r"cannot write .*/\.lock: File too large; choose another folder"
        ):
            OutputFolder.make(out, False, "x").__enter__()
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (least, most))
    assert list(out.parent.iterdir()) == []


@pytest.mark.parametrize("vanish", WAYS)
def test_a_folder_that_vanishes_is_told_once_and_another_beside_it_is_used(
    out: Path, vanish: Callable[[Path], None]
) -> None:
    with OutputFolder.make(out, False, "x") as folder:
        vanish(out)
        with pytest.warns(InputWarning) as told:
            folder.update(None)
        folder.update(None)
        write_text(folder / "a.txt", "a")
        beside = out.with_name("out-001")
        assert [str(line.message) for line in told] == [f"{out} has vanished; results go to {beside}"]
        assert folder.path == beside
        with pytest.raises(InputError, match="in use"), locked(beside):
            pytest.fail("the new folder is somebody else's too")
    assert [path.name for path in beside.iterdir()] == ["a.txt"]


@pytest.mark.filterwarnings("ignore::vedette.errors.InputWarning")
@pytest.mark.parametrize("vanish", WAYS)
def test_what_a_stream_has_taken_so_far_goes_along(out: Path, vanish: Callable[[Path], None]) -> None:
    with OutputFolder.make(out, False, "x") as folder:
        with atomic_stream(lambda: folder / "run.mcap") as stream:
            stream.write(b"before, ")
            vanish(out)
            stream.write(b"after")
        beside = out.with_name("out-001")
        assert (beside / "run.mcap").read_bytes() == b"before, after"
    assert [path.name for path in beside.iterdir()] == ["run.mcap"]


def test_a_folder_that_vanishes_twice_is_told_twice(out: Path) -> None:
    with OutputFolder.make(out, False, "x") as folder:
        for _ in range(2):
            shutil.rmtree(folder.path)
            with pytest.warns(InputWarning, match="has vanished"):
                folder.update(None)
        write_text(folder / "a.txt", "a")
    assert [path.name for path in folder.path.iterdir()] == ["a.txt"]


def test_where_nothing_can_be_made_beside_it_that_is_one_line(out: Path) -> None:
    with OutputFolder.make(out, False, "x") as folder:
        shutil.rmtree(out.parent)
        out.parent.write_text("a file now")
        with pytest.raises(InputError, match="runs is a file; give the name of a folder"):
            folder.update(None)


def test_a_stream_in_a_folder_that_is_not_watched_is_one_line(tmp_path: Path) -> None:
    def lose(folder: Path) -> None:
        with atomic_stream(folder / "run.mcap") as stream:
            stream.write(b"data")
            shutil.rmtree(folder)

    (tmp_path / "out").mkdir()
    with pytest.raises(InputError, match=r"cannot write .*run\.mcap: No such file or directory"):
        lose(tmp_path / "out")

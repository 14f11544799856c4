"""Output folders are never overwritten by accident, and files are put in place whole."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from vedette.errors import InputError
from vedette.record.files import atomic_path, new_directory, output_directory, write_text


def test_a_missing_folder_is_created_with_its_parents(tmp_path: Path) -> None:
    assert output_directory(tmp_path / "a" / "b").is_dir()


def test_an_existing_folder_is_refused_without_force_and_kept_with_it(tmp_path: Path) -> None:
    (tmp_path / "note").write_text("mine")
    with pytest.raises(InputError, match="--force"):
        output_directory(tmp_path)
    assert output_directory(tmp_path, force=True) == tmp_path
    assert (tmp_path / "note").read_text() == "mine"


@pytest.mark.parametrize("force", [False, True])
def test_a_folder_that_holds_an_input_is_refused_however_it_is_named(
    tmp_path: Path, force: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder, other = tmp_path / "m", tmp_path / "other"
    folder.mkdir()
    other.mkdir()
    (folder / "map.yaml").write_text("mine")
    (other / "team.yaml").write_text("mine")
    (other / "linked.yaml").symlink_to(folder / "map.yaml")
    (folder / "team.yaml").symlink_to(other / "team.yaml")
    (tmp_path / "also-m").symlink_to(folder)
    monkeypatch.chdir(folder)
    for place in (folder, Path("."), Path("../m"), tmp_path / "also-m"):
        for file in (folder / "map.yaml", Path("map.yaml"), other / "linked.yaml", folder / "team.yaml"):
            with pytest.raises(InputError) as caught:
                output_directory(place, force, [other / "team.yaml", file])
            assert (
                str(caught.value)
                == f"{place} holds {file.name}, which this command reads; choose another folder"
            )
    assert sorted(path.name for path in folder.iterdir()) == ["map.yaml", "team.yaml"]


def test_inputs_elsewhere_and_those_that_are_none_are_no_hindrance(tmp_path: Path) -> None:
    (tmp_path / "map.yaml").write_text("mine")
    (tmp_path / "out").mkdir()
    inputs = [tmp_path / "map.yaml", Path("7"), tmp_path / "out" / "gone.yaml", tmp_path / "no" / "such.yaml"]
    assert output_directory(tmp_path / "out", True, inputs) == tmp_path / "out"
    assert output_directory(tmp_path / "new", False, inputs) == tmp_path / "new"


@pytest.mark.parametrize("force", [False, True])
def test_a_file_in_the_place_of_the_folder_is_refused(tmp_path: Path, force: bool) -> None:
    (tmp_path / "out").write_text("")
    with pytest.raises(InputError, match="is a file"):
        output_directory(tmp_path / "out", force)
    with pytest.raises(InputError, match=r"^cannot create .*below: Not a directory; choose another folder$"):
        output_directory(tmp_path / "out" / "below", force)


def test_a_name_that_no_file_system_takes_is_bad_input(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot create"):
        output_directory(tmp_path / ("x" * 300))


@pytest.mark.skipif(not Path("/proc/self").is_dir(), reason="needs Linux")
def test_a_folder_that_takes_no_file_is_bad_input_even_for_root() -> None:
    with pytest.raises(InputError, match="cannot"):
        output_directory("/proc/self", force=True)


@pytest.mark.skipif(os.geteuid() == 0, reason="root writes anywhere")
def test_a_folder_without_permission_is_bad_input(tmp_path: Path) -> None:
    tmp_path.chmod(0o500)
    with pytest.raises(InputError, match="cannot"):
        output_directory(tmp_path, force=True)


def test_numbered_folders_count_up_and_never_collide(tmp_path: Path) -> None:
    made = [new_directory(tmp_path / "runs", "explore") for _ in range(3)]
    assert [path.name for path in made] == ["explore-001", "explore-002", "explore-003"]


def test_a_failed_write_leaves_the_old_file_and_no_scrap(tmp_path: Path) -> None:
    target = tmp_path / "summary.json"
    write_text(target, "old")

    def fail_half_way() -> None:
        with atomic_path(target) as temporary:
            temporary.write_text("half")
            raise RuntimeError("the disk is full")

    with pytest.raises(RuntimeError, match="the disk is full"):
        fail_half_way()
    assert target.read_text() == "old"
    assert [path.name for path in tmp_path.iterdir()] == ["summary.json"]


def test_a_write_into_a_missing_folder_is_bad_input(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot write"):
        write_text(tmp_path / "no" / "file.txt", "text")

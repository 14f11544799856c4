"""Tests lie where what they test lies; ``support`` has what they share, ``project`` what is of the whole."""

from __future__ import annotations

import re

from tests.support.places import ROOT

TESTS = ROOT / "tests"
PACKAGE = ROOT / "src" / "vedette"
OWN = {"fuzz", "mutants", "project", "support"}  # mirror no sources


def test_every_folder_of_tests_is_named_as_one_of_sources() -> None:
    folders = {path.parent.relative_to(TESTS) for path in TESTS.rglob("test_*.py")}
    unlike = [folder for folder in folders if not ((PACKAGE / folder).is_dir() or (ROOT / folder).is_dir())]
    assert {str(folder) for folder in unlike} <= OWN


def test_every_module_of_tests_beside_the_folders_is_named_as_one_of_the_package() -> None:
    for path in TESTS.glob("test_*.py"):
        assert (PACKAGE / path.name.removeprefix("test_")).is_file(), path.name


def test_what_tests_share_lies_in_support() -> None:
    shared = {path.relative_to(TESTS) for path in TESTS.rglob("*.py") if not path.name.startswith("test_")}
    assert {path.parts[0] for path in shared} == {"conftest.py", "fuzz", "mutants", "support"}
    assert not list((TESTS / "support").rglob("test_*.py"))
    for path in TESTS.rglob("*.py"):
        assert not re.search(r"^from tests\..*\btest_", path.read_text(encoding="utf-8"), re.MULTILINE), path

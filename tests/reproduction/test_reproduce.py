"""A whole reproduction: its report, its data, and how it ends."""

from __future__ import annotations

import csv
import re
from html.parser import HTMLParser
from pathlib import Path

import pytest

from tests.support.reproductions import SMALL, SOURCE, Quiet, interrupted, some_section
from vedette_reproduction.content import Section, table, write_csv
from vedette_reproduction.report import About, report_html
from vedette_reproduction.reproduce import Made, Reproduction, reproduce, verdicts
from vedette_reproduction.run import FULL, QUICK, ReproductionRun


def test_csv_has_what_the_table_has(tmp_path: Path) -> None:
    path = tmp_path / "t.csv"
    rows = [("a, b", 1, 0.1, True, None), ("c", 2, 1e-12, False, 3.0)]
    write_csv(table("t", "T", ("w", "n", "x", "y", "z"), rows), path)
    with path.open(newline="", encoding="utf-8") as file:
        assert list(csv.reader(file)) == [
            ["w", "n", "x", "y", "z"], ["a, b", "1", "0.1", "yes", ""], ["c", "2", "1e-12", "no", "3"],
        ]  # fmt: skip


def folder_of(path: Path, contents: dict[str, Made], seed: int = 0) -> Reproduction:
    """Reproduce some parts in a new folder."""
    path.mkdir()
    return reproduce(path, SMALL, seed, SOURCE, Quiet(), contents)


class Tags(HTMLParser):
    """Collects what a page would fetch, and whether its tags close."""

    def __init__(self) -> None:
        super().__init__()
        self.fetched: list[str] = []
        self.open: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Note sources and open tags."""
        self.fetched += [str(value) for name, value in attrs if name in ("src", "href")]
        if tag not in ("meta", "img", "br"):
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        """Close a tag."""
        assert self.open.pop() == tag


def test_the_report_needs_no_other_file_and_no_script(tmp_path: Path) -> None:
    result = folder_of(tmp_path / "out", {"Some": some_section, "Other": some_section})
    page = result.report.read_text(encoding="utf-8")
    tags = Tags()
    tags.feed(page)
    assert tags.open == []
    assert all(link.startswith(("data:image/png;base64,", "#")) for link in tags.fetched)
    assert sum(link.startswith("data:") for link in tags.fetched) == 2
    assert "<script" not in page
    assert "C1" in page
    assert "&lt;b&gt;" in page
    assert SOURCE.command in page
    assert result.complete


def test_the_same_seed_gives_the_same_data(tmp_path: Path) -> None:
    def data(name: str, seed: int) -> dict[str, bytes]:
        folder_of(tmp_path / name, {"Some": some_section}, seed)
        return {path.name: path.read_bytes() for path in sorted((tmp_path / name / "data").iterdir())}

    first = data("a", 1)
    assert first == data("b", 1)
    assert first["some.csv"] != data("c", 2)["some.csv"]
    assert set(first) == {"claims.csv", "some.csv"}
    assert {path.name for path in (tmp_path / "a" / "timing").iterdir()} == {"clock.csv", "parts.csv"}
    assert not (tmp_path / "a" / ".part").exists()


def test_an_interrupted_run_keeps_what_is_done_and_names_the_rest(tmp_path: Path) -> None:
    parts: dict[str, Made] = {"Some": some_section, "C9": interrupted, "C10": some_section}
    result = folder_of(tmp_path / "out", parts)
    assert result.missing == ("C9", "C10")
    page = result.report.read_text(encoding="utf-8")
    assert re.search(r"Incomplete.*Missing: C9, C10", page)
    assert (tmp_path / "out" / "data" / "claims.csv").exists()
    assert not (tmp_path / "out" / ".part").exists()


def test_a_failed_run_leaves_nothing_behind(tmp_path: Path) -> None:
    def broken(run: ReproductionRun) -> Section:
        raise RuntimeError("broken")

    with pytest.raises(RuntimeError, match="broken"):
        folder_of(tmp_path / "out", {"Some": some_section, "Broken": broken})
    assert list((tmp_path / "out").iterdir()) == []


def test_progress_hears_of_every_part(tmp_path: Path) -> None:
    heard: list[str] = []

    class Listener(Quiet):
        def begin(self, number: int, of: int, name: str) -> None:
            heard.append(f"{number}/{of} {name}")

    reproduce(tmp_path, SMALL, 0, SOURCE, Listener(), {"A": some_section, "B": some_section})
    assert heard == ["1/2 A", "2/2 B"]


def test_an_empty_report_says_so() -> None:
    page = report_html([], About(SOURCE, 0, 1.0, ("Figure 1",)), Path())
    assert "Missing: Figure 1" in page
    assert verdicts([]).rows == ()


def test_the_full_reproduction_is_no_smaller_than_the_quick_one() -> None:
    assert set(QUICK.teams) < set(FULL.teams)
    assert QUICK.trials < FULL.trials
    assert len(QUICK.mission_seeds) < len(FULL.mission_seeds)
    assert set(QUICK.mission_planners) < set(FULL.mission_planners)
    assert FULL.office == QUICK.office == (30.0, 20.0)

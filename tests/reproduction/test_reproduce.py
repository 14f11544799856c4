"""``vedette reproduce``: figures against other computations, the report, the data, and how a run ends."""

from __future__ import annotations

import csv
import dataclasses
import re
import sys
from html.parser import HTMLParser
from pathlib import Path

import click
import numpy as np
import pytest
from PIL import Image

from vedette.cli.reproduce import reproduce as command
from vedette.domains.mapping.planners import DEFAULT
from vedette.errors import InputError
from vedette.problem import exhaustive
from vedette.study.provenance import Provenance
from vedette_reproduction import reproduce as module
from vedette_reproduction.claims.mapping import c11, c12
from vedette_reproduction.content import Section, Table, Verdict, table, wall_table, write_csv
from vedette_reproduction.contest import OBJECTIVE, make_scenes, selfish_choice
from vedette_reproduction.figures.figure_1 import figure_1
from vedette_reproduction.figures.figure_2 import MOST, NOISY, PERFECT, PRIOR, figure_2, posteriors
from vedette_reproduction.figures.figure_3 import analytic, figure_3
from vedette_reproduction.figures.figure_4 import figure_4
from vedette_reproduction.figures.figure_6 import figure_6
from vedette_reproduction.missions import Case, Mission, Missions
from vedette_reproduction.report import About, report_html
from vedette_reproduction.reproduce import Made, reproduce, verdicts
from vedette_reproduction.run import FULL, QUICK, Run

SMALL = dataclasses.replace(
    QUICK, teams=(2, 4), largest_dense=4, trials=2, scan_offices=2, scans=4, office=(10.0, 10.0), targets=1000
)
SOURCE = Provenance("vedette reproduce --quick", "2026-01-01", "0", "abc", "a machine", "3.11")


def silent(text: str) -> None:
    """Say nothing."""


class Quiet:
    """Shows nothing."""

    def begin(self, number: int, of: int, name: str) -> None:
        """Show nothing."""

    def tell(self, text: str) -> None:
        """Show nothing."""

    def end(self, seconds: float) -> None:
        """Show nothing."""


class FewMissions(Missions):
    """Runs no mission for yardsticks: the paper's planner stands in for the nearest frontier."""

    def get(self, case: Case) -> Mission:
        """Return a mission."""
        return super().get(dataclasses.replace(case, planner="rate") if case.planner == "nearest" else case)


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    """A reproduction in a very small office; its missions are run once."""
    return Run(SMALL, 0, tmp_path_factory.mktemp("figures"), FewMissions(silent), silent)


def named(section: Section, name: str) -> Table:
    """Return a table of a section."""
    return next(table for table in section.tables if table.name == name)


def is_picture(path: Path) -> bool:
    """Tell whether a file is a PNG of some size that is not of one colour."""
    with Image.open(path) as image:
        return image.format == "PNG" and min(image.size) > 300 and bool(np.ptp(np.asarray(image)) > 0)


def test_figure_1_shows_what_the_paper_says_each_message_holds(run: Run) -> None:
    section = figure_1(run)
    rows = named(section, "figure_1_messages").rows
    steps = [(row[2], row[3], row[5]) for row in rows]
    up = [(1, 2, "1"), (2, 3, "1,2")]
    assert steps[:4] == [*up, (3, 2, "1,2,3"), (2, 1, "1,2,3")]
    assert steps[4:] == [*up, (3, 2, "3"), (2, 1, "2,3")]
    for row in named(section, "figure_1_division").rows:
        assert row[1] == pytest.approx(row[2], abs=1e-12)
        assert row[3] == "0/0" or row[3] == pytest.approx(row[1])
    assert is_picture(run.figures / section.pictures[0])


def test_figure_2_has_three_posteriors_or_one_for_every_count_of_reports(run: Run) -> None:
    for n in range(1, MOST + 1):
        assert posteriors(PERFECT, n) == pytest.approx([0.0, PRIOR, 1.0])
        odds = {
            round(PRIOR / (1 - PRIOR) * 4.0**a * (0.1 / 0.55) ** b, 9)
            for a in range(n + 1)
            for b in range(n + 1 - a)
        }
        assert len(posteriors(NOISY, n)) == len(odds)
    section = figure_2(run)
    assert all(row[1] == row[2] and row[3] == row[4] for row in named(section, "figure_2_counts").rows)
    assert is_picture(run.figures / section.pictures[0])


def test_figure_3_sees_far_more_than_the_grid_predicts_and_counts_it(run: Run) -> None:
    assert analytic(np.array([0.1, 1.0])) == pytest.approx([0.5, 2.0**-10])
    section = figure_3(run)
    rows = named(section, "figure_3").rows
    assert len(rows) == 32
    for row in rows:
        assert row[4] == pytest.approx(float(row[2] or 0) / float(row[3] or 1))
    at_one_metre = rows[4]
    assert float(at_one_metre[4] or 0) > 100 * float(at_one_metre[1] or 0)
    shares = [float(row[2]) for row in named(section, "figure_3_models").rows if row[2] is not None]
    assert np.all(np.diff(shares) <= 1e-12)
    assert is_picture(run.figures / section.pictures[0])


def test_figure_4_compares_with_the_optimum_over_all_joint_choices(run: Run) -> None:
    section = figure_4(run)
    rows = named(section, "figure_4_schemes").rows
    assert max(float(row[3] or 0) for row in rows) <= 1.0 + 1e-6
    scene = next(iter(make_scenes(run)))
    values = [
        OBJECTIVE.value(scene.belief, OBJECTIVE.combine(a, b))
        for a in scene.candidates[0]
        for b in scene.candidates[1]
    ]
    assert exhaustive(OBJECTIVE, scene.belief, scene.candidates).value == pytest.approx(max(values))
    assert selfish_choice(scene)[1] <= max(values) + 1e-9
    assert is_picture(run.figures / section.pictures[0])


def test_figure_6_shows_growing_coverage_and_both_planners(run: Run) -> None:
    section = figure_6(run)
    assert [row[0] for row in named(section, "figure_6_missions").rows] == ["rate", DEFAULT]
    log = run.missions.get(Case("rate", 0, *SMALL.office)).report.log
    covered = [stage.coverage for stage in log.stages()]
    assert covered == sorted(covered)
    assert covered[-1] == log.last.coverage
    assert is_picture(run.figures / section.pictures[0])


def test_missions_end_and_leave_little(run: Run) -> None:
    section = c12(run)
    assert section.verdict is Verdict.HOLDS
    assert all(float(row[4] or 0) > 0.99 for row in section.tables[0].rows)
    assert c11(run).verdict is Verdict.HOLDS


def test_csv_has_what_the_table_has(tmp_path: Path) -> None:
    path = tmp_path / "t.csv"
    rows = [("a, b", 1, 0.1, True, None), ("c", 2, 1e-12, False, 3.0)]
    write_csv(table("t", "T", ("w", "n", "x", "y", "z"), rows), path)
    with path.open(newline="", encoding="utf-8") as file:
        assert list(csv.reader(file)) == [
            ["w", "n", "x", "y", "z"], ["a, b", "1", "0.1", "yes", ""], ["c", "2", "1e-12", "no", "3"],
        ]  # fmt: skip


def some_section(run: Run) -> Section:
    """A claim with a picture and tables, at once."""
    Image.new("RGB", (4, 4)).save(run.figures / "some.png")
    chance = [("<b>", float(run.rng(1).random()))]
    tables = (table("some", "Some", ("k", "x"), chance), wall_table("clock", "Clock", ("s",), [(1.0,)]))
    return Section("c1", "C1: a < b", "said", ("found",), Verdict.IN_PART, "1 & 2", tables, ("some.png",))


def interrupted(run: Run) -> Section:
    """Be interrupted."""
    raise KeyboardInterrupt


def folder_of(path: Path, contents: dict[str, Made], seed: int = 0) -> module.Result:
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
    def broken(run: Run) -> Section:
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


def test_the_command_writes_where_it_is_told_and_ends_with_130_when_interrupted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(module, "CONTENTS", {"Some": some_section, "C9": interrupted})
    monkeypatch.setattr(sys, "argv", ["vedette", "reproduce", "--quick"])
    out = tmp_path / "out"

    def status(*arguments: str) -> object:
        with pytest.raises(SystemExit) as ended:
            command.main(args=["--quick", "--out", str(out), *arguments], standalone_mode=False)
        return ended.value.code

    assert status() == 130
    said = capsys.readouterr()
    assert "1 claims tried: 1 hold in part" in said.out
    assert "missing: C9" in said.out
    assert "[ 1/2]" in said.err
    monkeypatch.setattr(module, "CONTENTS", {"Some": some_section})
    with pytest.raises(InputError, match="--force"):
        command.main(args=["--out", str(out)], standalone_mode=False)
    assert status("--force") == 0
    assert "Incomplete" not in (out / "report.html").read_text(encoding="utf-8")


def test_a_bad_seed_is_refused() -> None:
    with pytest.raises(click.BadParameter, match="range"):
        command.main(args=["--seed", "-1"], standalone_mode=False)


def test_the_full_reproduction_is_no_smaller_than_the_quick_one() -> None:
    assert set(QUICK.teams) < set(FULL.teams)
    assert QUICK.trials < FULL.trials
    assert len(QUICK.mission_seeds) < len(FULL.mission_seeds)
    assert set(QUICK.mission_planners) < set(FULL.mission_planners)
    assert FULL.office == QUICK.office == (30.0, 20.0)

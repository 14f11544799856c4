"""The documents' figures and pictures are those of recorded missions; missions run again give the same."""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest

from bench import machine
from bench.figures.claims import README, Claim, claims
from bench.figures.missions import MISSIONS
from bench.figures.record import IMAGES, load, picture_hash
from bench.figures.report import cell
from bench.figures.run import carry_out
from tests.support.places import ROOT
from vedette.errors import InputError

RECORDS = load()
CLAIMS = claims(RECORDS)
MAPS = Path(os.environ.get("MAPS", ROOT.parent / "shared" / "maps"))
ELSEWHERE = 1e-3  # relative, on other machines and versions: they may round the last bits otherwise
GIVEN = (  # numbers of the README that are asked for, chosen or told with their machine, and not results
    "Python 3.11",
    "Rust 1.85",
    "generated office of 30 x 20 m at 0.1 m",
    "dies after 10 s",
    "radios reach 6 m",
    "entropy / (time + 5 s)",
)
RUN_BY_TEST_DOCS = re.compile(
    r"^```(?:sh|python)\n.*?^```\n(?:\n```text\n.*?^```\n)?", re.MULTILINE | re.DOTALL
)
FIGURE = re.compile(r"(?<![\w.,:/-])\d+(?:\.\d+|(?= (?:%|s|m|m²|nat|kB|MB|GHz|collisions)(?!\w)))")


def text_of(document: str) -> str:
    return (ROOT / document).read_text(encoding="utf-8")


# -- the documents ----------------------------------------------------------------------------------


@pytest.mark.parametrize("claim", CLAIMS, ids=lambda claim: f"{claim.document}: {claim.text[:60]}")
def test_a_document_says_what_the_figures_say(claim: Claim) -> None:
    assert claim.places(text_of(claim.document)), (
        f"{claim.document} should say: {claim.text}\nFigures are recorded and put there by `make figures`."
    )


def test_every_figure_of_the_readme_is_recorded_or_given() -> None:
    text = RUN_BY_TEST_DOCS.sub(lambda block: " " * len(block[0]), text_of(README))
    said = [
        *(claim for claim in CLAIMS if claim.document == README),
        *(Claim(README, part) for part in GIVEN),
    ]
    spans = [span for claim in said for span in claim.places(text)]
    assert not [claim.text for claim in said if not claim.places(text)]
    for figure in FIGURE.finditer(text):
        assert any(start <= figure.start() < end for start, end in spans), (
            f"README.md: where does {text[figure.start() - 40 : figure.end() + 20]!r} come from? "
            "Let bench.figures record it and claim it, or add it to GIVEN."
        )


def test_every_mission_is_recorded_at_a_commit_as_it_would_be_run_now() -> None:
    assert list(RECORDS) == list(MISSIONS)
    for name, mission in MISSIONS.items():
        record = RECORDS[name]
        assert (record["command"], tuple(record["figures"])) == (mission.command, mission.figures)
        assert re.fullmatch(r"[0-9a-f]{7,}", record["commit"])
        assert record["machine"]
        assert re.match(r"\d{4}-\d\d-\d\dT", record["commit_date"])


def test_every_picture_is_a_recorded_missions_or_stands_in_a_dated_report() -> None:
    recorded = {name: digest for record in RECORDS.values() for name, digest in record["pictures"].items()}
    assert set(recorded) == {name for mission in MISSIONS.values() for name in mission.pictures}
    reports = "".join(path.read_text(encoding="utf-8") for path in (ROOT / "docs" / "reports").glob("*.md"))
    for path in IMAGES.iterdir():
        if path.name in recorded:
            assert recorded[path.name] == picture_hash(path), f"{path.name} is not the one of its record"
        else:
            assert f"images/{path.name}" in reports, f"{path.name}: which command makes it?"


# -- the missions -----------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("name", MISSIONS)
def test_a_mission_run_again_gives_the_recorded_figures(name: str, tmp_path: Path) -> None:
    recorded, mission = RECORDS[name], MISSIONS[name]
    try:
        found = carry_out(mission, tmp_path, MAPS)
    except InputError:
        pytest.skip(f"no {mission.map} in {MAPS}")
    about = machine.describe()
    same = all(about[part] == recorded[part] for part in ("machine", "python", *machine.PACKAGES))
    for key, value in recorded["figures"].items():
        wanted = value if same or not isinstance(value, float) else pytest.approx(value, rel=ELSEWHERE)
        assert found["figures"][key] == wanted, f"{key}: record anew with `make figures`"
    if same:
        assert found["closing"] == recorded["closing"]
        assert found.get("left_out") == recorded.get("left_out")
    assert found.get("robots") == recorded.get("robots")


# -- how it is done ---------------------------------------------------------------------------------


def test_a_claim_is_found_and_replaced_across_lines() -> None:
    old, new = (
        Claim("x.md", "90 % after 506 s, all after 1023 s"),
        Claim("x.md", "90 % after 400 s, all after 875 s"),
    )
    text = "It knows\n90 % after\n506 s, all  after 1023 s, in sum."
    assert old.replaced(new, text) == "It knows\n90 % after\n400 s, all  after 875 s, in sum."
    assert old.replaced(Claim("x.md", "everything"), text) == "It knows\neverything, in sum."
    assert new.replaced(old, text) == text
    assert new.places(text) == []


def test_a_report_is_read_by_heading_column_and_row(tmp_path: Path) -> None:
    path = tmp_path / "report.md"
    path.write_text("# R\n## A\n| n | x | y |\n|---|---|---|\n| `a` (b) | 1.5 (1-2) | 2 |\n\n## B\ntext\n")
    assert cell(path, "A", "x", "`a`") == "1.5 (1-2)"
    wrong = [
        ("B", "x", "`a`", "no table under 'B'"),
        ("C", "x", "`a`", "no table under 'C'"),
        ("A", "z", "`a`", "A: no 'z' of "),
        ("A", "x", "`b`", "A: no 'x' of "),
    ]
    for heading, column, row, said in wrong:
        with pytest.raises(LookupError, match=said):
            cell(path, heading, column, row)

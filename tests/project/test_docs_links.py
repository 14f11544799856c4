"""Links between the documents lead to files that are there, and to headings that are in them."""

from __future__ import annotations

import re
from collections import Counter
from pathlib import Path

import pytest

from tests.support.places import ROOT

DOCUMENTS = [*sorted(ROOT.glob("*.md")), *sorted((ROOT / "docs").rglob("*.md"))]
LINK = re.compile(r"\]\((?!https?:|mailto:)([^)#\s]*)(?:#([^)\s]+))?\)")
FENCED = re.compile(r"^(```+).*?^\1", re.MULTILINE | re.DOTALL)
CLAIM = re.compile(r"\\tag\{(V\d+)\}")
HEADING = re.compile(r"^#+ +(.+?) *$", re.MULTILINE)


def anchors(text: str) -> set[str]:
    """Return the names by which links reach the headings of a document: as GitHub makes them."""
    titles = [re.sub(r"[*`]|\]\([^)]*\)", "", title) for title in HEADING.findall(FENCED.sub("", text))]
    return {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in titles}


@pytest.mark.parametrize("path", DOCUMENTS, ids=lambda path: path.relative_to(ROOT).as_posix())
def test_every_link_leads_somewhere(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    for file, anchor in LINK.findall(FENCED.sub("", text)):
        target = (path.parent / file).resolve() if file else path
        assert target.exists(), f"{file}: no such file"
        if anchor:
            assert anchor in anchors(target.read_text(encoding="utf-8")), f"{file}#{anchor}: no such heading"


def test_no_two_claims_and_no_two_decisions_have_one_number() -> None:
    claims = Counter(tag for path in DOCUMENTS for tag in CLAIM.findall(path.read_text(encoding="utf-8")))
    decisions = Counter(path.name[:4] for path in (ROOT / "docs" / "decisions").glob("[0-9]*.md"))
    assert len(claims) > 100
    assert [each for numbers in (claims, decisions) for each, count in numbers.items() if count > 1] == []


def test_anchors_are_the_headings_in_lower_case_with_hyphens_and_without_marks() -> None:
    text = "# 1 A `b`, (c)\n\n```sh\n# no heading\n```\n## What's *up*? [x](y.md)\n"
    assert anchors(text) == {"1-a-b-c", "whats-up-x"}

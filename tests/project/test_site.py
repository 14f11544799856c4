"""The documentation site: built without a warning, whole, and readable without a network."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.support.places import ROOT

SITE = ROOT / "tools" / "site"
TEXT = re.compile(r"<[^>]+>")

pytestmark = pytest.mark.slow


def run(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    """Run Python on these arguments."""
    command = [sys.executable, *arguments]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False, timeout=3600)


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of the whole site."""
    folder = tmp_path_factory.mktemp("site") / "docs"
    done = run(SITE / "build.py", folder)
    assert (done.returncode, done.stderr) == (0, ""), done.stderr
    return folder


def test_the_readme_is_the_front_page_and_every_document_has_a_page(site: Path) -> None:
    assert (site / "index.html").read_bytes() == (site / "README.html").read_bytes()
    for document in [*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md")]:
        title = document.read_text(encoding="utf-8").partition("\n")[0].removeprefix("# ")
        page = (site / document.relative_to(ROOT)).with_suffix(".html").read_text(encoding="utf-8")
        heading = TEXT.sub("", page.partition("<h1>")[2].partition("<a ")[0])
        assert re.sub(r"\W", "", heading) == re.sub(r"\W", "", title)


def test_the_first_picture_is_a_page_that_plays(site: Path) -> None:
    front = (site / "index.html").read_text(encoding="utf-8").partition("<h1>")[2]
    first = re.search(r"<(img|iframe)[^>]* src=\"([^\"]+)\"", front)
    assert first is not None
    assert first[1] == "iframe"
    assert (site / first[2]).read_bytes() == (ROOT / "docs" / "theatre.html").read_bytes()


def test_every_module_is_in_the_reference_with_its_own_words_and_its_fields_comments(site: Path) -> None:
    pages = {path.stem: path.read_text(encoding="utf-8") for path in (site / "api").glob("*.html")}
    for folder in (ROOT / "src" / "vedette", ROOT / "reproduction" / "vedette_reproduction"):
        for source in folder.rglob("*.py"):
            module = ".".join(source.relative_to(folder.parent).with_suffix("").parts).removesuffix(
                ".__init__"
            )
            package = module if source.stem == "__init__" else module.rpartition(".")[0]
            assert f'id="module-{module}"' in pages[package], f"{module} is not in the reference"
    negotiation = TEXT.sub("", pages["vedette.negotiation"])
    assert "Let every platform choose one of its candidates" in negotiation
    assert "each (lower, higher)" in negotiation  # the comment beside Tree.edges


def test_formulas_and_diagrams_are_drawn(site: Path) -> None:
    theory = (site / "docs" / "theory.html").read_text(encoding="utf-8")
    numbers = set(re.findall(r"\\tag\{(V\d+)\}", (ROOT / "docs" / "theory.md").read_text(encoding="utf-8")))
    assert len(numbers) > 10
    assert numbers <= set(re.findall(r"\((V\d+)\)", TEXT.sub("", theory)))
    assert theory.count("<math") > 100
    assert "\\psi" not in theory
    assert (site / "docs" / "concepts.html").read_text(encoding="utf-8").count('<svg id="diagram-') == 2


def test_no_page_loads_anything_from_elsewhere(site: Path) -> None:
    elsewhere = r'[^>]*="(?:https?:)?//'
    loaded = re.compile(rf'<(?:script|img|iframe){elsewhere}|<link(?=[^>]* rel="stylesheet"){elsewhere}')
    assert {path.suffix for path in site.rglob("*")} >= {".html", ".css"}
    for page in site.rglob("*.html"):
        assert not loaded.search(page.read_text(encoding="utf-8")), page.name
    for style in site.rglob("*.css"):
        assert not re.search(r"(?:url\(|@import\s*)[\"']?(?:https?:)?//", style.read_text(encoding="utf-8"))


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("[there](missing.md)", "missing.md"),
        ("[there](#no-heading)", "no-heading"),
        (r"$\nosuchcommand{x}$", "nosuchcommand"),
    ],
)
def test_a_broken_link_or_formula_fails_the_build(tmp_path: Path, text: str, complaint: str) -> None:
    pages = tmp_path / "pages"
    pages.mkdir()
    (pages / "README.md").write_text(f"# Title\n\n{text}\n")
    done = run("-m", "sphinx", "--fail-on-warning", "--quiet", "-c", SITE, pages, tmp_path / "site")
    assert done.returncode != 0
    assert complaint in done.stderr

"""Build the documentation site: ``build.py FOLDER``.

Its pages are the repository's Markdown as it stands, the README in front. Around them come the navigation and
the API reference, a page a package. The pages are laid out anew in ``FOLDER-pages``: Sphinx warns only of
what it reads, so nothing is remembered.
"""

from __future__ import annotations

import os
import pkgutil
import re
import shutil
import sys
from importlib import import_module
from pathlib import Path

from sphinx.cmd.build import build_main

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
PACKAGES = ("vedette", "vedette_reproduction")
COMPILED = "vedette._kernels"
LINK = re.compile(r"\]\(([^):#]+)")  # to a place in the repository
PLAYED = re.compile(r"\[!\[([^]]*)\]\([^)]*\)\]\(([^)]*\.html)\)")  # a picture of a page that plays by itself
NAVIGATION = {  # what the sidebar shows under a page: caption -> pages, a pattern for those not named before
    "README.md": {
        "How it works": ["docs/concepts", "docs/theory", "docs/*"],
        "How to": ["docs/how-to/install", "docs/how-to/explore-your-map", "docs/how-to/*"],
        "Reference": ["api/vedette", "api/vedette_reproduction"],
        "Background": ["docs/decisions/README", "docs/reports/README", "CONTRIBUTING", "CHANGELOG"],
    },
    "docs/decisions/README.md": {"": ["*"]},
    "docs/reports/README.md": {"": ["*"]},
}


def main(site: Path) -> int:
    """Lay out the pages and build the site; return the exit status, which a warning too makes 1."""
    pages = site.with_name(f"{site.name}-pages")
    for folder in (site, pages):
        shutil.rmtree(folder, ignore_errors=True)
    copy_documents(pages)
    write_reference(pages / "api")
    options = ["--fail-on-warning", "--keep-going", "--quiet", "--jobs", "auto"]
    status = build_main([*options, "-c", str(HERE), "-d", str(pages / ".doctrees"), str(pages), str(site)])
    if status == 0:
        shutil.copyfile(site / "README.html", site / "index.html")
        for played in (ROOT / "docs").rglob("*.html"):
            shutil.copyfile(played, site / played.relative_to(ROOT))
    return status


def copy_documents(pages: Path) -> None:
    """Copy the documents and the files that they link to; a link to a folder leads to the README in it."""
    shutil.copytree(ROOT / "docs", pages / "docs")
    for document in ROOT.glob("*.md"):
        shutil.copy2(document, pages)
    for path in [*pages.rglob("*.md")]:
        text = path.read_text(encoding="utf-8")
        for link in LINK.findall(text):
            linked = Path(os.path.normpath(path.parent / link))
            source = ROOT / linked.relative_to(pages)
            if source.is_file() and not linked.exists():
                linked.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy2(source, linked)
        tree = NAVIGATION.get(path.relative_to(pages).as_posix(), {})
        text = PLAYED.sub(r'<iframe class="played" src="\2" title="\1"></iframe>', text)
        text = re.sub(r"\]\(([^):]*/)\)", r"](\1README.md)", text)
        path.write_text(text + "".join(map(toctree, tree, tree.values())), encoding="utf-8")


def toctree(caption: str, entries: list[str]) -> str:
    """Return a part of the sidebar as Markdown."""
    lines = ["", "```{toctree}", ":hidden:", ":glob:", f":caption: {caption}", "", *entries, "```", ""]
    return "\n".join(line for line in lines if line != ":caption: ")


def write_reference(folder: Path) -> None:
    """Write a page for each package: its own words, its modules' one after the other, the packages in it."""
    folder.mkdir()
    for top in PACKAGES:
        found = [*pkgutil.walk_packages(import_module(top).__path__, f"{top}.")]
        packages = [top, *(module.name for module in found if module.ispkg)]
        modules = [module.name for module in found if not module.ispkg and module.name != COMPILED]
        for package in packages:
            inner = [name for name in packages if name.rpartition(".")[0] == package]
            own = [name for name in modules if name.rpartition(".")[0] == package]
            (folder / f"{package}.rst").write_text(page(package, own, inner), encoding="utf-8")


def page(package: str, modules: list[str], packages: list[str]) -> str:
    """Return the page of a package."""
    lines = [f"``{package}``", "=" * 80, "", f".. automodule:: {package}", "", *offered(package), ""]
    lines += [".. toctree::", "   :maxdepth: 1", "", *(f"   {name}" for name in packages), ""]
    for name in modules:
        lines += [f"``{name.removeprefix(package)}``", "-" * 80, "", f".. automodule:: {name}", ""]
    return "\n".join(lines)


def offered(package: str) -> list[str]:
    """Return lines that lead to what a package offers from its modules."""
    module = import_module(package)
    words = []
    for word in getattr(module, "__all__", ()):
        thing = getattr(module, word)
        home, name = getattr(thing, "__module__", package), getattr(thing, "__qualname__", None)
        if home != package and name is not None:
            words.append(f":py:obj:`{word} <{home}.{name}>`")
    return [f"Offers {', '.join(words)}.", ""] if words else []


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))

"""The API reference: a page a module, from its docstrings."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from pathlib import Path

import pytest

from tests.support.places import ROOT

SOURCES = (ROOT / "src" / "vedette", ROOT / "reproduction" / "vedette_reproduction")


@pytest.mark.slow
@pytest.mark.skipif(importlib.util.find_spec("pdoc") is None, reason="needs pdoc")
def test_every_module_has_its_page_with_its_own_words(tmp_path: Path) -> None:
    command = [sys.executable, str(ROOT / "tools" / "api_reference.py"), str(tmp_path)]
    subprocess.run(command, check=True, capture_output=True, timeout=600)
    assert "negotiate" in (tmp_path / "index.html").read_text() + (tmp_path / "vedette.html").read_text()
    sources = [(path, folder.parent) for folder in SOURCES for path in folder.rglob("*.py")]
    for source, parent in sources:
        name = source.relative_to(parent).with_suffix("")
        if name.name == "__init__" or "stonesoup" in name.parts:
            continue
        page = (tmp_path / name).with_suffix(".html")
        assert page.is_file(), f"{name} has no page"
    page = (tmp_path / "vedette" / "negotiation" / "negotiate.html").read_text()
    assert "Let every platform choose one of its candidates" in page
    assert "belongs to scheme" not in page  # docstrings, not sources

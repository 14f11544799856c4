"""Parts of somebody's own as modules in a folder, with names that no other test has."""

from __future__ import annotations

from itertools import count
from pathlib import Path

import pytest

from tests.support.places import ROOT

_NUMBERS = count()


def module(folder: Path, code: str) -> str:
    """Write a module into a folder; return its name."""
    name = f"own_part_{next(_NUMBERS)}"
    (folder / f"{name}.py").write_text(code, encoding="utf-8")
    return name


def example(name: str, folder: Path) -> str:
    """Write one of the examples into a folder as a module of another name; return that."""
    return module(folder, (ROOT / "examples" / f"{name}.py").read_text(encoding="utf-8"))


def installed(folder: Path, group: str, monkeypatch: pytest.MonkeyPatch, **entries: str) -> None:
    """Let a folder be that of an installed package, with entry points by name in a group."""
    info = folder / "ownparts-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: ownparts\nVersion: 1.0\n")
    lines = [f"{name} = {reference}" for name, reference in entries.items()]
    (info / "entry_points.txt").write_text("\n".join([f"[vedette.{group}]", *lines, ""]))
    monkeypatch.syspath_prepend(str(folder))
    monkeypatch.setenv("PYTHONPATH", str(folder))

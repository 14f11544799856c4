"""The examples of missions from Python: short, and they run."""

from __future__ import annotations

import runpy
from pathlib import Path

import pytest

from tests.support.places import ROOT


@pytest.mark.parametrize("name", ["explore", "track", "search"])
def test_an_example_takes_at_most_forty_lines_and_runs(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    example = ROOT / "examples" / f"{name}.py"
    assert len(example.read_text(encoding="utf-8").splitlines()) <= 40
    names = runpy.run_path(str(example))
    assert names["mission"].over is not None
    assert len(capsys.readouterr().out.splitlines()) > 3

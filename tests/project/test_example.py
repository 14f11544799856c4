"""The example of an own problem: short, runs, and keeps the laws."""

from __future__ import annotations

import runpy

import pytest

from tests.support.places import ROOT
from vedette.testing import check_objective

EXAMPLE = ROOT / "examples" / "own_problem.py"
MODEL = ROOT / "examples" / "own_model.py"


def test_own_problem_takes_at_most_forty_lines_and_reports_choice_value_and_bound(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert len(EXAMPLE.read_text().splitlines()) <= 40
    names = runpy.run_path(str(EXAMPLE))
    out = capsys.readouterr().out
    assert [line.split()[0] for line in out.splitlines()] == ["posts", "value", "optimum"]
    assert names["agreed"].value <= names["best"].value + 1e-9 <= names["agreed"].bound + 2e-9
    check_objective(names["Watch"](), names["worth"], [own[0] for own in names["candidates"]])


def test_own_model_takes_at_most_forty_lines_and_agrees_on_nearly_the_optimum(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert len(MODEL.read_text().splitlines()) <= 40
    names = runpy.run_path(str(MODEL))
    out = capsys.readouterr().out
    assert [line[:11] for line in out.splitlines()] == ["best places", "by samples ", "agreed on  "]
    model, best, guess = names["model"], names["best"], names["guess"]
    assert guess.low <= best.value <= guess.high
    assert 0.9 * best.value <= model.value(names["agreed"].choice) <= best.value

"""docs/schemas describe the JSON that is written: they are those of the code, and refuse anything else."""

from __future__ import annotations

import copy
import json
from pathlib import Path
from typing import Any

import pytest

from tests.support.schemas import FOLDER, validator
from tests.support.small_missions import robots, run, small_maze
from tools import schemas


def test_the_documented_schemas_are_those_of_the_code() -> None:
    """``make schemas`` writes them."""
    assert {path.stem for path in FOLDER.iterdir()} == set(schemas.KINDS)
    for name, kind in schemas.KINDS.items():
        assert (FOLDER / f"{name}.json").read_text(encoding="utf-8") == schemas.text(kind), name


def test_outputs_md_names_every_schema() -> None:
    text = (Path(FOLDER).parent / "outputs.md").read_text(encoding="utf-8")
    assert [name for name in schemas.KINDS if f"schemas/{name}.json" not in text] == []


@pytest.fixture(scope="module")
def summary() -> dict[str, Any]:
    figures: dict[str, Any] = json.loads(run(small_maze(), robots(2), max_time=5.0)[1].summary.to_json())
    return figures


def test_a_summary_is_by_its_schema(summary: dict[str, Any]) -> None:
    assert validator("explore-summary").is_valid(summary)
    assert not validator("track-summary").is_valid(summary)


@pytest.mark.parametrize(
    ("where", "value"),
    [
        (("schema_version",), 2),
        (("outcome",), "failed"),
        (("coverage",), "all"),
        (("rounds",), 1.5),
        (("bound_ratio",), "0.7"),
        (("path_m", "robot-1"), "far"),
        (("messages", "robot-1", "fusion"), -0.5),
        (("left_out",), [{"x": 1.0, "y": 2.0, "unknown_cells": 3, "why": "bored", "by": "robot-1"}]),
        (("left_out",), [{"x": 1.0, "y": 2.0}]),
        (("more",), 1),
    ],
)
def test_a_summary_with_anything_else_is_refused(
    summary: dict[str, Any], where: tuple[str, ...], value: object
) -> None:
    changed = copy.deepcopy(summary)
    inner = changed
    for name in where[:-1]:
        inner = inner[name]
    inner[where[-1]] = value
    assert not validator("explore-summary").is_valid(changed)


def test_a_summary_without_a_field_is_refused(summary: dict[str, Any]) -> None:
    for name in summary:
        assert not validator("explore-summary").is_valid({k: v for k, v in summary.items() if k != name})

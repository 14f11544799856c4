"""summary.json and timing.json: complete, documented, the same for the same mission."""

from __future__ import annotations

import json
import re
from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest

from tests.support.places import ROOT
from vedette.outcome import Outcome
from vedette.record.explore.summary import ExploreSummary, LeftOut
from vedette.record.summary import Spread, Timing, Traffic

DOCS = ROOT / "docs" / "outputs.md"


def _summary(**changes: object) -> ExploreSummary:
    figures: dict[str, object] = {
        "completed": True, "outcome": Outcome.COMPLETE, "lost": (), "left": (), "seed": 3, "robots": 2,
        "planner": "tours",
        "scheme": "token", "fusion": "evidence", "world": "office-3", "radio": "12,3", "faults": None,
        "time_s": 0.1 + 0.2, "t50_s": 10.0,
        "t90_s": 20.0, "t95_s": 25.0, "t99_s": None, "auc_s": 12.3456789, "coverage": 0.999,
        "known_m2": 95.5, "rate_m2_s": 0.75, "frontiers": 2, "beyond": 0, "no_go_m2": 0.0, "cut_off_m2": 0.0,
        "expected": None,
        "turned_back": (),
        "map_errors": 4,
        "map_error_share": 1e-5, "pose_error_m": {"robot-1": 0.0, "robot-2": 0.25},
        "path_m": {"robot-1": 12.0, "robot-2": -0.0}, "overlap": 0.25,
        "collisions": 0,
        "min_clearance_m": 0.06, "rounds": 12, "sweeps": 30, "bound_ratio": None, "apart_s": 1.5,
        "messages": {"robot-1": Traffic(10, 5, 2, 1), "robot-2": Traffic(9, 5, 2)},
        "bytes": {"robot-1": Traffic(1000, 500, 20), "robot-2": Traffic(900, 500, 20)},
        "maps": (("robot-1",), ("robot-2",)),
        "left_out": (LeftOut(3.0, -0.25, 12, "unseeable", "robot-1"),),
    }  # fmt: skip
    return ExploreSummary(**(figures | changes))  # type: ignore[arg-type]


def _timing() -> Timing:
    spread = Spread(1.0, 2.0, 3.0)
    return Timing(planning_ms=spread, answer_ms=None, round_ms=None, real_time_factor=31.5, wall_s=6.0)


def _documented(heading: str) -> list[str]:
    """Return the first column of the table under a heading of docs/outputs.md."""
    section = DOCS.read_text(encoding="utf-8").split(f"## `{heading}`\n")[1].split("\n## ")[0]
    return re.findall(r"^\| `(\w+)` \|", section, flags=re.MULTILINE)


def test_the_documentation_lists_exactly_the_fields_in_order() -> None:
    assert _documented("summary.json") == list(json.loads(_summary().to_json()))
    assert set(_documented("summary.json")) == {field.name for field in fields(ExploreSummary)}
    assert _documented("timing.json") == [field.name for field in fields(Timing)]


def test_the_documentation_lists_every_outcome_with_its_exit_status() -> None:
    section = DOCS.read_text(encoding="utf-8").split("## How a mission ends\n")[1].split("\n## ")[0]
    listed = re.findall(r"^\| `(\w+)` \| (\d+) \|", section, flags=re.MULTILINE)
    assert listed == [(outcome.value, str(outcome.status)) for outcome in Outcome]


def test_the_text_is_deterministic_json_of_plain_values() -> None:
    text = _summary().to_json()
    assert text == _summary(time_s=np.float64(0.3), seed=np.int64(3), completed=np.True_).to_json()
    assert text.endswith("}\n")
    figures = json.loads(text)
    assert figures["schema_version"] == 3
    assert figures["outcome"] == "complete"
    assert figures["time_s"] == 0.3
    assert figures["auc_s"] == 12.345679
    assert figures["messages"]["robot-1"] == {
        "negotiation": 10, "fusion": 5, "beacons": 2, "overlay": 1
    }  # fmt: skip
    assert (figures["radio"], figures["faults"], figures["apart_s"]) == ("12,3", None, 1.5)
    assert "-0.0" not in text


@pytest.mark.parametrize("value", [float("nan"), float("inf"), None])
def test_what_has_no_finite_value_is_null(value: float | None) -> None:
    assert json.loads(_summary(bound_ratio=value).to_json())["bound_ratio"] is None


def test_a_spread_holds_the_percentiles_of_its_samples() -> None:
    spread = Spread.of(list(range(101)))
    assert spread == Spread(50.0, 95.0, 100.0)
    assert Spread.of([]) is None


def test_files_hold_the_text(tmp_path: Path) -> None:
    _summary().write(tmp_path / "summary.json")
    _timing().write(tmp_path / "timing.json")
    assert (tmp_path / "summary.json").read_text(encoding="utf-8") == _summary().to_json()
    timing = json.loads((tmp_path / "timing.json").read_text(encoding="utf-8"))
    assert timing == {
        "schema_version": 3,
        "planning_ms": {"p50": 1.0, "p95": 2.0, "max": 3.0},
        "answer_ms": None,
        "round_ms": None,
        "real_time_factor": 31.5,
        "wall_s": 6.0,
    }

"""One small mission, frozen: its figures change only when somebody means them to.

``python -m tests.missions.test_golden`` prints the figures anew, to be put in place of those below.
"""

from __future__ import annotations

import json
from typing import Any

import pytest

from tests.support.small_missions import check_complete, robots, run, small_office
from vedette.record.explore.observer import ExploreReport

GOLDEN: dict[str, Any] = {
    "schema_version": 3,
    "completed": True,
    "outcome": "complete",
    "lost": [],
    "left": [],
    "seed": 7,
    "robots": 2,
    "planner": "tours",
    "scheme": "token",
    "fusion": "replicated",
    "world": "office",
    "radio": None,
    "faults": None,
    "time_s": 80.3,
    "t50_s": 5.0,
    "t90_s": 29.0,
    "t95_s": 30.5,
    "t99_s": 60.5,
    "auc_s": 11.704078,
    "coverage": 0.999666,
    "known_m2": 101.04,
    "rate_m2_s": 1.258281,
    "frontiers": 3,
    "beyond": 0,
    "no_go_m2": 0.0,
    "cut_off_m2": 0.0,
    "turned_back": [],
    "map_errors": 0,
    "map_error_share": 0.0,
    "pose_error_m": {"robot-1": 0.0, "robot-2": 0.0},
    "path_m": {"robot-1": 34.767065, "robot-2": 34.618248},
    "overlap": 0.578187,
    "collisions": 0,
    "min_clearance_m": 0.025248,
    "rounds": 28,
    "sweeps": 42,
    "bound_ratio": 0.690222,
    "apart_s": 0.0,
    "messages": {
        "robot-1": {"negotiation": 98, "fusion": 65, "beacons": 270, "overlay": 0},
        "robot-2": {"negotiation": 96, "fusion": 67, "beacons": 270, "overlay": 0},
    },
    "bytes": {
        "robot-1": {"negotiation": 19470, "fusion": 9588, "beacons": 7155, "overlay": 0},
        "robot-2": {"negotiation": 23880, "fusion": 9259, "beacons": 7201, "overlay": 0},
    },
    "maps": [["robot-1", "robot-2"]],
    "left_out": [
        {"x": 1.55, "y": 9.65, "unknown_cells": 33, "why": "unseeable", "by": "robot-1"},
        {"x": 9.65, "y": 1.35, "unknown_cells": 69, "why": "unseeable", "by": "robot-2"},
    ],
    "expected": None,
    "frames": None,
}

APPROXIMATE = 1e-3  # relative: other machines may round the last bits otherwise


def golden_mission() -> ExploreReport:
    """Two robots in a small office."""
    _, report = run(small_office(seed=1), robots(2), seed=7)
    return report


def figures(report: ExploreReport) -> dict[str, Any]:
    """All of ``summary.json``."""
    plain: dict[str, Any] = json.loads(report.summary.to_json())
    return plain


def test_the_frozen_mission_has_its_figures() -> None:
    report = golden_mission()
    check_complete(report)
    measured = figures(report)
    assert list(measured) == list(GOLDEN)
    for name, value in measured.items():
        wanted = GOLDEN[name]
        if isinstance(wanted, float) or name == "path_m":
            assert value == pytest.approx(wanted, rel=APPROXIMATE), name
        else:
            assert value == wanted, name


if __name__ == "__main__":
    print("GOLDEN: dict[str, Any] =", figures(golden_mission()))

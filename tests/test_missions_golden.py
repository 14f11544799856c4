"""One small mission, frozen: its figures change only when somebody means them to.

``python tests/test_missions_golden.py`` prints the figures anew, to be put in place of those below.
"""

from __future__ import annotations

import json
from typing import Any

import pytest

from small_missions import check_complete, robots, run, small_office
from vedette.sim.explore import Report

GOLDEN: dict[str, Any] = {
    "schema_version": 1,
    "completed": True,
    "outcome": "complete",
    "seed": 7,
    "robots": 2,
    "planner": "tours",
    "scheme": "token",
    "fusion": "replicated",
    "world": "office",
    "time_s": 81.4,
    "t50_s": 5.0,
    "t90_s": 60.0,
    "t95_s": 61.0,
    "t99_s": 62.5,
    "auc_s": 20.179519,
    "coverage": 1.0,
    "map_errors": 0,
    "map_error_share": 0.0,
    "path_m": {"robot-1": 33.784232, "robot-2": 34.411093},
    "overlap": 0.706045,
    "collisions": 0,
    "min_clearance_m": 0.025656,
    "rounds": 30,
    "sweeps": 43,
    "bound_ratio": 0.816143,
    "messages": {
        "robot-1": {"negotiation": 103, "fusion": 64, "beacons": 274},
        "robot-2": {"negotiation": 103, "fusion": 68, "beacons": 274},
    },
    "bytes": {
        "robot-1": {"negotiation": 26452, "fusion": 7699, "beacons": 7244},
        "robot-2": {"negotiation": 29163, "fusion": 8285, "beacons": 7007},
    },
}

APPROXIMATE = 1e-3  # relative: other machines may round the last bits otherwise


def golden_mission() -> Report:
    """Two robots in a small office."""
    _, report = run(small_office(seed=1), robots(2), seed=7)
    return report


def figures(report: Report) -> dict[str, Any]:
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

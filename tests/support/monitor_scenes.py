"""A small field and those who measure it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from vedette.domains.monitoring.case import MonitorCase, made
from vedette.domains.monitoring.scenario import MonitorScenario
from vedette.scenario import as_scenario

SMALL: dict[str, Any] = {
    "area": [0, 0, 16, 12],
    "cell": 1,
    "field": {"type": "drawn"},
    "model": {"mean": 20.0, "deviation": 3.0, "length": 5.0, "lasting": 60.0},
    "sensor": {"noise": 0.5},
    "vehicles": [
        {"name": "rover", "start": [2, 2], "speed": 1},
        {"name": "heron", "start": [3, 9], "speed": 2, "flies": True, "sensor": {"noise": 1.0, "side": 3}},
    ],
    "duration": 24,
    "step": 1,
    "horizon": 8,
    "replan": 4,
}


def case(**changes: Any) -> MonitorCase:
    """The small field, with other fields of its scenario."""
    return made(as_scenario(SMALL | changes, MonitorScenario, "small"), Path("small.yaml"))

"""Teams over real rclpy, in bodies that are none of ours; `make test-ros2` has an environment for it."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.support.small_missions import TWO_ROOMS, drawn
from vedette.maps import UNKNOWN, read_map

pytest.importorskip("rclpy", reason="`make test-ros2` has rclpy", exc_type=ImportError)


def explored(world: Path, out: Path, robots: int, speed: float = 3.0) -> dict[str, Any]:
    """Let a team explore a world over ROS 2; return its summary."""
    command = [sys.executable, "-m", "vedette", "team", "explore", str(world), "--ros2", "--json"]
    options = ["--robots", str(robots), "--speed", str(speed), "--max-time", "300", "--out", str(out)]
    ended = subprocess.run(
        [*command, *options], capture_output=True, text=True, timeout=200, check=False, env=dict(os.environ)
    )
    assert ended.returncode in (0, 1), ended.stderr
    summary: dict[str, Any] = json.loads(ended.stdout)
    return summary


def test_robots_on_real_rclpy_explore_two_rooms_and_map_them_as_they_are(tmp_path: Path) -> None:
    drawn(TWO_ROOMS).save(tmp_path)
    summary = explored(tmp_path / "map.yaml", tmp_path / "out", 2)
    assert summary["outcome"] == "complete", summary
    assert summary["coverage"] >= 0.99
    _, told = read_map(tmp_path / "out" / "map.yaml")
    _, true = read_map(tmp_path / "map.yaml")
    known = told != UNKNOWN
    assert np.mean(told[known] != true[known]) <= 0.005
    said = (tmp_path / "out" / "agents" / "robots.log").read_text()
    assert said.count("collided: False") == 2, said

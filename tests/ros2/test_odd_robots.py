"""Robots with one oddity each, over real rclpy: they map the building as it is all the same."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from tests.support.ros2_teams import plan, sound, tried
from tests.support.small_missions import TWO_ROOMS, drawn

pytest.importorskip("rclpy", reason="`make test-ros2` has rclpy", exc_type=ImportError)
pytestmark = pytest.mark.slow


@pytest.mark.parametrize(
    "odd",
    [
        {"upside_down": True, "mount": [0.1, 0.05, 20.0]},
        {"clockwise": True, "speckle": 0.1},
        {"rolling": True, "mount": [0.1, 0.0, 0.0], "beams": 180},
        {"rolling": True, "clockwise": True, "beams": 180},
        {"view": 180.0, "mount": [0.12, 0.0, 0.0]},
        {"rate": 2.0, "beams": 90},
    ],
    ids=[
        "upside down and off centre",
        "clockwise, some beams no measurement",
        "beams one after another while it turns",
        "the same clockwise",
        "half a view",
        "few beams",
    ],
)
def test_an_odd_lidar_maps_two_rooms_as_they_are(tmp_path: Path, odd: Mapping[str, Any]) -> None:
    sound(tried(plan(drawn(TWO_ROOMS), 1, oddities={0: odd}), tmp_path), 1)


@pytest.mark.parametrize(
    "odd",
    [{"prefix": "robot1/"}, {"late": 0.7}, {"prefix": "robot1/", "late": 0.3}],
    ids=["prefixed frames", "late transforms", "both"],
)
def test_odd_frames_map_two_rooms_as_they_are(tmp_path: Path, odd: Mapping[str, Any]) -> None:
    sound(tried(plan(drawn(TWO_ROOMS), 1, oddities={0: odd}), tmp_path), 1)


@pytest.mark.parametrize(
    "odd",
    [
        {"active_from": 20.0},
        {"fails": ["reject", "reject", "", "reject"]},
        {"fails": ["abort", "", "abort"]},
        {"fails": ["ignore", "", "ignore"]},
    ],
    ids=["inactive for 20 s", "rejects some goals", "aborts some goals", "never answers some goals"],
)
def test_an_odd_navigator_is_put_up_with(tmp_path: Path, odd: Mapping[str, Any]) -> None:
    sound(tried(plan(drawn(TWO_ROOMS), 1, oddities={0: odd}), tmp_path), 1)


@pytest.mark.parametrize("updates", [False, True], ids=["whole maps", "updates of a map"])
def test_a_map_of_slam_that_jumps_by_half_a_metre_and_five_degrees_is_taken_as_it_is_then(
    tmp_path: Path, updates: bool
) -> None:
    odd = {"slam": True, "updates": updates, "lost": [15.0, 0.4, 0.3, 5.0]}
    team = plan(drawn(TWO_ROOMS), 2, oddities={0: odd}, settings={0: {"evidence": "map"}})
    sound(tried(team, tmp_path), 2)

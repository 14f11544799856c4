"""A robot's own map through the door: when it is told, where it lies, and its patches."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest

from tests.support.ros2_doors import FakeDoor, at, scan
from vedette.agent.events import Pose, Scan, Sensed
from vedette.maps import FREE, OCCUPIED, UNKNOWN
from vedette.missions.explore.own_map import OwnMap
from vedette.ros2.body import Ros2Body
from vedette.ros2.door import Grid, Patch
from vedette.ros2.grids import AGAIN, Grids, classes_of_occupancy
from vedette.ros2.settings import Ros2Settings
from vedette.ros2.transforms import planar
from vedette.team import PlatformSpec


def grid(value: int = 0, frame: str = "map") -> Grid:
    return Grid(frame, 0.05, planar(-1.0, -2.0, 0.0), np.full((4, 6), value, np.int8))


def test_only_what_is_sure_has_a_class() -> None:
    told = classes_of_occupancy(np.array([[-1, 0, 25, 26, 64, 65, 100]], np.int8))
    assert told.tolist() == [[UNKNOWN, FREE, FREE, UNKNOWN, UNKNOWN, OCCUPIED, OCCUPIED]]


def test_a_map_is_told_when_it_is_news_and_now_and_then() -> None:
    grids = Grids()
    assert grids.due(np.eye(4), 0.0) is None
    grids.take(grid())
    told = [now for now in np.arange(0.0, 2.5 * AGAIN, 0.5) if grids.due(np.eye(4), now) is not None]
    assert told == [0.0, AGAIN, 2.0 * AGAIN]
    grids.take(grid(100))
    assert grids.due(np.eye(4), 2.5 * AGAIN) is not None


@pytest.mark.parametrize(("row", "col"), [(1, 2), (-1, -1), (3, 5), (9, 9)])
def test_a_patch_changes_its_cells_and_no_others(row: int, col: int) -> None:
    grids, whole = Grids(), np.zeros((4, 6), np.int8)
    grids.take(grid())
    grids.take(Patch(row, col, np.full((2, 3), 100, np.int8)))
    for r in range(row, row + 2):
        for c in range(col, col + 3):
            if 0 <= r < 4 and 0 <= c < 6:
                whole[r, c] = 100
    assert grids.latest is not None
    np.testing.assert_array_equal(grids.latest.occupancy, whole)


def test_a_patch_before_any_map_says_nothing() -> None:
    grids = Grids()
    grids.take(Patch(0, 0, np.zeros((1, 1), np.int8)))
    assert grids.latest is None


def test_with_evidence_map_the_map_comes_in_the_teams_frame_and_scans_are_no_evidence() -> None:
    door = FakeDoor([*at(1.0, 0.0), *at(2.0, 0.0), scan(1.5), grid(frame="odom")])
    settings = Ros2Settings(start=(10.0, 5.0, 90.0), evidence="map")
    then, seen, now, told = Ros2Body(PlatformSpec(), settings, door).sense(0.0)
    assert isinstance(then, Pose)
    assert isinstance(seen, Scan)
    assert isinstance(now, Pose)
    assert seen.mapped
    assert np.isnan(seen.unread.ranges).all()
    np.testing.assert_array_equal(seen.unread.angles, seen.angles)
    assert isinstance(told, Sensed)
    assert isinstance(told.data, OwnMap)
    assert (told.data.x, told.data.y, told.data.heading) == pytest.approx((12.0, 4.0, pi / 2))


def test_with_evidence_scan_a_map_says_nothing() -> None:
    door = FakeDoor([*at(1.0, 0.0), grid()])
    assert [type(event) for event in Ros2Body(PlatformSpec(), Ros2Settings(), door).sense(0.0)] == [Pose]

"""Messages as a robot may send them, malformed ones too, as plain values."""

from __future__ import annotations

from types import SimpleNamespace as Message
from typing import Any

import numpy as np
import pytest

from vedette.ros2.messages import grid_of, joints_of, patch_of
from vedette.ros2.transforms import planar

STAMP = Message(sec=12, nanosec=500_000_000)
ORIGIN, UPRIGHT = Message(x=0.0, y=0.0, z=0.0), Message(x=0.0, y=0.0, z=0.0, w=1.0)


def transform(parent: str, child: str, turn: Any = UPRIGHT) -> Message:
    return Message(
        header=Message(frame_id=parent, stamp=STAMP),
        child_frame_id=child,
        transform=Message(translation=Message(x=1.0, y=2.0, z=0.0), rotation=turn),
    )


def test_a_transform_is_where_and_when_it_says() -> None:
    (joint,) = joints_of(Message(transforms=[transform("odom", "base_link")]), fixed=False)
    assert (joint.parent, joint.child, joint.stamp, joint.fixed) == ("odom", "base_link", 12.5, False)
    np.testing.assert_array_equal(joint.T, planar(1.0, 2.0, 0.0))


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("length", [0.0, 1e-200, 1e200])
def test_a_rotation_of_no_length_or_of_one_beyond_all_measure_is_left_out(length: float) -> None:
    nothing = Message(x=0.0, y=0.0, z=0.0, w=length)
    assert not list(joints_of(Message(transforms=[transform("odom", "base", nothing)]), fixed=True))


def a_grid(**other: Any) -> Message:
    info = {
        "resolution": 0.05,
        "height": 2,
        "width": 3,
        "origin": Message(position=ORIGIN, orientation=UPRIGHT),
    }
    data = other.pop("data", [0, 100, -1, 0, 0, 0])
    return Message(header=Message(frame_id="map"), info=Message(**{**info, **other}), data=data)


def test_a_map_is_its_cells_row_by_row() -> None:
    told = grid_of(a_grid())
    assert told is not None
    assert told.occupancy.tolist() == [[0, 100, -1], [0, 0, 0]]


@pytest.mark.parametrize("wrong", [{"data": [0]}, {"resolution": 0.0}, {"resolution": float("nan")}])
def test_a_map_that_makes_no_sense_is_left_out(wrong: dict[str, Any]) -> None:
    assert grid_of(a_grid(**wrong)) is None


def test_a_patch_is_where_it_says_and_one_that_makes_no_sense_is_left_out() -> None:
    told = patch_of(Message(x=4, y=7, width=2, height=1, data=[0, 100]))
    assert told is not None
    assert (told.row, told.col, told.occupancy.tolist()) == (7, 4, [[0, 100]])
    assert patch_of(Message(x=4, y=7, width=2, height=2, data=[0, 100])) is None

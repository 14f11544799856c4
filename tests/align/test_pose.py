"""Rigid motions of the plane."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vedette.align import FramePose

POSES = st.builds(FramePose.of, st.floats(-50, 50), st.floats(-50, 50), st.floats(-9, 9))
POINTS = np.array([[0.0, 0.0], [3.0, -1.0], [-20.0, 7.5]])


@given(POSES, POSES)
def test_one_motion_after_another_takes_places_through_both(a: FramePose, b: FramePose) -> None:
    assert a.after(b).places(POINTS) == pytest.approx(a.places(b.places(POINTS)), abs=1e-9)


@given(POSES)
def test_the_inverse_takes_places_back(pose: FramePose) -> None:
    assert pose.inverse().places(pose.places(POINTS)) == pytest.approx(POINTS, abs=1e-9)
    assert -math.pi <= pose.angle <= math.pi


def test_a_pose_is_apart_from_another_by_where_they_take_a_place_and_by_the_shorter_turn() -> None:
    a, b = FramePose.of(1.0, 0.0, 3.1), FramePose.of(1.0, 0.0, -3.1)
    shift, turn = a.apart(b, np.array([10.0, 0.0]))
    assert turn == pytest.approx(2.0 * (math.pi - 3.1))
    assert shift == pytest.approx(20.0 * math.sin(math.pi - 3.1))

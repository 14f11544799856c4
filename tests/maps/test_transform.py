"""Integer transforms: they are those of the plane, rounded."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vedette.maps.transform import IDENTITY, TURN, UNIT, Transform, cosine

transforms = st.builds(
    Transform, st.integers(-(10**6), 10**6), st.integers(-(10**6), 10**6), st.integers(0, TURN - 1)
)


@given(angle=st.integers(-TURN, 2 * TURN))
def test_a_cosine_is_the_floats_rounded(angle: int) -> None:
    cos, sin = cosine(angle)
    turned = math.tau * (angle % TURN) / TURN
    assert (cos, sin) == (
        pytest.approx(UNIT * math.cos(turned), abs=0.51),
        pytest.approx(UNIT * math.sin(turned), abs=0.51),
    )


@given(first=transforms, then=transforms, x=st.floats(-500, 500), y=st.floats(-500, 500))
def test_one_motion_after_another_takes_places_where_both_take_them(
    first: Transform, then: Transform, x: float, y: float
) -> None:
    both = then.place(*first.place(x, y))
    assert math.dist(then.after(first).place(x, y), both) < 2e-3


@given(there=transforms)
def test_there_and_back_is_where_one_was(there: Transform) -> None:
    back = there.inverse().after(there)
    assert back.angle == 0
    assert max(abs(back.x), abs(back.y)) <= 1
    assert IDENTITY.after(there) == there == there.after(IDENTITY)


@given(x=st.floats(-900, 900), y=st.floats(-900, 900), angle=st.floats(-20, 20))
def test_a_motion_in_metres_is_the_nearest_of_integers(x: float, y: float, angle: float) -> None:
    there = Transform.of(x, y, angle)
    assert there.x / 1000.0 == pytest.approx(x, abs=5.01e-4)
    assert there.y / 1000.0 == pytest.approx(y, abs=5.01e-4)
    off = (there.radians - angle) % math.tau
    assert min(off, math.tau - off) <= math.pi / TURN + 1e-9


def test_how_far_apart_two_are_is_told_for_a_place_and_by_the_smaller_angle() -> None:
    shift, turn = Transform(0, 0, TURN - 100).apart(Transform(0, 0, 100), 10.0, 0.0)
    assert turn == pytest.approx(math.tau * 200 / TURN)
    assert shift == pytest.approx(2 * 10.0 * math.sin(turn / 2), rel=1e-3)
    places = Transform(1000, 0, TURN // 4).places(np.array([[2.0, 0.0]]))
    np.testing.assert_allclose(places, [[1.0, 2.0]], atol=1e-12)

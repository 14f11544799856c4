"""The cells under a disc are those that it overlaps, and no others."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from vedette.maps import GridFrame
from vedette.maps.disc import cells_under

FRAME = GridFrame(0.1, 12, 9, -0.35, 2.0)


@given(x=st.floats(-0.8, 1.0), y=st.floats(1.6, 3.6), radius=st.floats(-0.1, 0.7))
def test_a_disc_lies_on_the_cells_whose_nearest_point_is_within_its_radius(
    x: float, y: float, radius: float
) -> None:
    near = []
    for flat in range(FRAME.size):
        row, col = divmod(flat, FRAME.cols)
        left, low = FRAME.origin_x + 0.1 * col, FRAME.origin_y + 0.1 * row
        nearest = min(max(x, left), left + 0.1), min(max(y, low), low + 0.1)
        near.append(math.dist((x, y), nearest))
    under = cells_under(FRAME, x, y, radius)
    assert np.all(np.diff(under) > 0)
    distance = np.array(near)
    inside = np.zeros(FRAME.size, bool)
    inside[under] = True
    assert inside[distance < radius - 2e-6].all()
    assert not inside[distance > radius].any()

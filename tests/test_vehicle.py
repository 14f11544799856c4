"""Vehicles: poses against step-by-step integration of their motion."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from vedette.vehicle import drive, turn_sequences

RATES = st.lists(st.floats(-1.5, 1.5), min_size=1, max_size=5)


@settings(deadline=None, max_examples=40)
@given(RATES, st.floats(0.0, 40.0), st.floats(0.1, 3.0), st.floats(-4.0, 4.0))
def test_poses_are_the_integral_of_the_motion(
    rates: list[float], speed: float, step: float, heading: float
) -> None:
    poses = drive((1.0, -2.0, heading), rates, speed, step)
    x, y, psi = 1.0, -2.0, heading
    parts = 2000
    for rate, pose in zip(rates, poses, strict=True):
        for _ in range(parts):  # midpoint rule
            middle = psi + rate * step / parts / 2
            x += speed * np.cos(middle) * step / parts
            y += speed * np.sin(middle) * step / parts
            psi += rate * step / parts
        np.testing.assert_allclose(pose, (x, y, psi), atol=1e-4 * (1 + speed * step))


def test_many_sequences_at_once_are_each_on_its_own() -> None:
    sequences = turn_sequences(0.5, 3)
    together = drive((0.0, 0.0, 1.0), sequences, 2.0, 1.0)
    assert together.shape == (27, 3, 3)
    for alone, rates in zip(together, sequences, strict=True):
        np.testing.assert_array_equal(alone, drive((0.0, 0.0, 1.0), rates, 2.0, 1.0))


def test_every_sequence_comes_once_and_straight_ahead_is_one() -> None:
    sequences = turn_sequences(0.5, 4)
    assert len(np.unique(sequences, axis=0)) == 81
    assert (sequences == 0.0).all(axis=1).sum() == 1

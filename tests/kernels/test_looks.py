"""The kernels of looks against their twins."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from vedette.kernels.looks import Sight, foreseen, lines
from vedette.kernels.reference import looks as reference

seeds = st.integers(0, 2**32 - 1)


def random_sight(rng: np.random.Generator) -> Sight:
    """A range, a bearing, both, or a place, of a sensor that stands or moves."""
    r, b, p = 10 ** rng.uniform(-1, 1), np.radians(10 ** rng.uniform(-0.5, 1.3)), 10 ** rng.uniform(-1, 1)
    noises = [(r, 0.0, 0.0), (0.0, b, 0.0), (r, b, 0.0), (0.0, 0.0, p)][rng.integers(4)]
    return Sight(*noises, min_range=10 ** rng.uniform(-1, 1.3), stride=rng.choice([0.0, 10.0]))


def random_spreads(rng: np.random.Generator, *shape: int) -> np.ndarray:
    """Covariances of positions as xx, xy, yy, from narrow to wide."""
    root = rng.normal(size=(*shape, 2, 2)) * 10 ** rng.uniform(-1, 2)
    full = root @ root.swapaxes(-1, -2) + 0.01 * np.eye(2)
    return np.stack([full[..., 0, 0], full[..., 0, 1], full[..., 1, 1]], -1)


@settings(deadline=None, max_examples=100)
@given(seeds)
def test_lines_equal_their_twins(seed: int) -> None:
    rng = np.random.default_rng(seed)
    sight, spreads = random_sight(rng), random_spreads(rng, 5)
    offsets = rng.normal(size=(5, 2)) * 10 ** rng.uniform(0, 2.5)
    offsets[0] = 0.0  # exactly below
    for found, expected in zip(
        lines(sight, offsets, spreads), reference.lines(sight, offsets, spreads), strict=True
    ):
        np.testing.assert_allclose(found, expected, rtol=1e-5, atol=1e-9 * np.abs(expected).max())


@settings(deadline=None, max_examples=40)
@given(seeds)
def test_what_is_foreseen_equals_its_twin(seed: int) -> None:
    rng = np.random.default_rng(seed)
    sight = random_sight(rng)
    view = float(rng.uniform(20, 200)), np.radians(float(rng.choice([20.0, 60.0, 120.0, 180.0])))
    poses = np.concatenate([rng.uniform(-60, 60, (3, 2, 2)), rng.uniform(-7, 7, (3, 2, 1))], axis=2)
    points, spreads = rng.uniform(-60, 60, (4, 2, 2)), random_spreads(rng, 4, 2)
    found = foreseen(sight, view, poses, points, spreads)
    expected = reference.foreseen(sight, view, poses, points, spreads)
    np.testing.assert_allclose(found, expected, rtol=1e-5, atol=1e-9 * np.abs(expected).max(initial=1e-9))


def test_of_a_target_known_to_a_micrometre_at_a_thousand_kilometres_no_digits_are_lost() -> None:
    sight = Sight(0.5, np.radians(0.01), 0.0, 1.0, 10.0)
    spread = np.array([[1e-12, 0.0, 1e-12]])
    information = lines(sight, np.array([[1e6, 0.0]]), spread).information[0]
    np.testing.assert_allclose(information, [4.0, 0.0, (1e6 * np.radians(0.01)) ** -2], rtol=1e-6, atol=1e-9)

"""Kernels of fields against their twins, on dense matrices."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vedette.kernels import field
from vedette.kernels.field import Floats, Rows
from vedette.kernels.reference import field as twin


def drawn(rng: np.random.Generator) -> tuple[Floats, Rows]:
    """A positive definite band, and rows within it, some of them empty."""
    n = int(rng.integers(1, 12))
    width = int(rng.integers(0, n))
    band = rng.normal(size=(n, width + 1))
    band[:, width] = 2.0 * (width + 1) * (1.0 + np.abs(band).max())
    for i in range(min(width, n)):
        band[i, : width - i] = 0.0
    starts, columns = [0], []
    for _ in range(int(rng.integers(0, 6))):
        first = int(rng.integers(0, n))
        columns += range(first, min(n, first + int(rng.integers(0, width + 2))))
        starts.append(len(columns))
    weights = rng.uniform(0.1, 1.0, len(columns))
    return band, Rows(np.array(starts, np.int64), np.array(columns, np.int64), weights)


@given(st.integers(0, 2**32 - 1))
def test_factor_determinant_covariance_and_gains_are_the_twins(seed: int) -> None:
    rng = np.random.default_rng(seed)
    band, rows = drawn(rng)
    information = rng.uniform(0.0, 5.0, len(rows.starts) - 1)
    ours, theirs = field.factor(band, rows, information), twin.factor(band, rows, information)
    np.testing.assert_allclose(ours[0], theirs[0], atol=1e-9)
    np.testing.assert_allclose(ours[1], theirs[1], atol=1e-9)
    covariance = field.covariance(ours[0], rows)
    np.testing.assert_allclose(covariance, twin.covariance(theirs[0], rows), atol=1e-9)
    np.testing.assert_allclose(field.variances(ours[0]), twin.variances(theirs[0]), atol=1e-9)
    places = rng.permutation(len(information))
    ways = Rows(np.array([0, len(places) // 2, len(places)]), places, rng.uniform(0.0, 3.0, len(places)))
    np.testing.assert_allclose(field.gains(covariance, ways), twin.gains(covariance, ways), atol=1e-9)


def test_a_matrix_that_is_not_positive_definite_is_refused() -> None:
    nothing = Rows(np.zeros(1, np.int64), np.empty(0, np.int64), np.empty(0))
    for kernels in (field, twin):
        with pytest.raises(ValueError, match="not positive definite"):
            kernels.factor(np.array([[0.0, 1.0], [2.0, 1.0]]), nothing, np.empty(0))


def test_rows_that_do_not_fit_are_refused() -> None:
    band = np.ones((3, 1))
    far = Rows(np.array([0, 2]), np.array([0, 2]), np.ones(2))
    with pytest.raises(ValueError, match="beyond the band"):
        field.factor(band, far, np.ones(1))
    with pytest.raises(ValueError, match="do not fit"):
        field.covariance(band, Rows(np.array([0, 1]), np.array([3]), np.ones(1)))
    with pytest.raises(ValueError, match="a row each"):
        field.factor(band, far, np.ones(2))

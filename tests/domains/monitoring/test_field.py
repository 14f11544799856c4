"""The field's model against dense matrices, and draws from it against what it says of them."""

from __future__ import annotations

import math

import numpy as np
import pytest
import scipy.sparse as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from vedette import InputError
from vedette.domains.monitoring.belief import FieldBelief
from vedette.domains.monitoring.factor import Factor
from vedette.domains.monitoring.field import FieldModel, shifted
from vedette.domains.monitoring.spots import Spots
from vedette.maps import GridFrame


def model(rows: int = 6, cols: int = 9, **changes: float) -> FieldModel:
    numbers = {"length": 7.0, "deviation": 2.5, **changes}
    return FieldModel(GridFrame(2.0, rows, cols, -3.0, 1.0), **numbers)  # type: ignore[arg-type]


@settings(deadline=None, max_examples=30)
@given(st.integers(2, 7), st.integers(2, 9), st.floats(2.0, 60.0), st.floats(0.01, 100.0))
def test_every_cell_has_the_deviation_that_the_model_states(
    rows: int, cols: int, length: float, deviation: float
) -> None:
    field = model(rows, cols, length=length, deviation=deviation)
    covariance = np.linalg.inv(field.precision.toarray())
    np.testing.assert_allclose(np.sqrt(np.diag(covariance)), deviation, rtol=1e-6)
    assert (covariance > -1e-9 * deviation**2).all()


def test_the_closed_forms_are_those_of_the_dense_matrix() -> None:
    field = model()
    dense = field.precision.toarray()
    assert field.log_det == pytest.approx(np.linalg.slogdet(dense)[1], rel=1e-10)
    vector = np.random.default_rng(0).normal(size=54)
    np.testing.assert_allclose(field.smoothed(vector), np.linalg.solve(dense, vector), rtol=1e-8)


def test_correlation_falls_to_a_seventh_at_the_length_as_a_matern_fields_does() -> None:
    field = FieldModel(GridFrame(1.0, 61, 61), length=12.0)
    unit = np.zeros((61, 61))
    unit[30, 30] = 1.0
    row = field.smoothed(unit.ravel()).reshape(61, 61)[30]
    distance = math.sqrt(8.0)  # kappa times length
    from scipy.special import kv

    assert row[42] / row[30] == pytest.approx(distance * kv(1, distance), abs=0.02)


def test_draws_have_the_models_covariance_and_keep_what_the_model_says() -> None:
    field = model(3, 4, lasting=5.0, mean=3.0)
    rng = np.random.default_rng(1)
    first = np.array([field.sample(rng) for _ in range(4000)])
    later = np.array([field.later(x, 0.0, 2.0, rng) for x in first])
    covariance = np.linalg.inv(field.precision.toarray())
    for draws in (first, later):
        flat = draws.reshape(len(draws), -1)
        np.testing.assert_allclose(np.cov(flat.T), covariance, atol=0.6)
        np.testing.assert_allclose(flat.mean(axis=0), 3.0, atol=0.15)
    both = np.mean((first - 3.0) * (later - 3.0), axis=0)
    np.testing.assert_allclose(both, math.exp(-0.4) * 2.5**2, atol=0.5)


def test_a_drifting_field_moves_by_whole_cells_that_add_up_to_the_way() -> None:
    field = model(drift=(0.7, -0.3), lasting=math.inf)  # type: ignore[arg-type]
    moves = np.array([field.shift(0.5 * k, 0.5 * (k + 1)) for k in range(80)])
    np.testing.assert_allclose(moves.cumsum(axis=0)[-1], [-0.3 * 40 / 2, 0.7 * 40 / 2], atol=0.5)
    plane = np.arange(12.0).reshape(3, 4)
    out, inside = shifted(plane, 1, -2)
    assert out.tolist() == [[0, 0, 0, 0], [2, 3, 0, 0], [6, 7, 0, 0]]
    assert inside.sum() == 4
    assert not shifted(plane, 5, 0)[1].any()
    x = field.sample(np.random.default_rng(2))
    later = field.later(x, 0.0, 10.0, np.random.default_rng(3))
    moved, inside = shifted(x, *field.shift(0.0, 10.0))
    np.testing.assert_allclose(later[inside], moved[inside])


@pytest.mark.parametrize("seed", range(4))
def test_a_factor_solves_and_has_the_determinant_of_the_dense_matrix(seed: int) -> None:
    rng = np.random.default_rng(seed)
    root = sp.random(40, 40, 0.1, random_state=rng) + sp.eye(40)
    matrix = sp.csc_matrix(root @ root.T)
    factor, dense = Factor(matrix), matrix.toarray()
    assert factor.log_det == pytest.approx(np.linalg.slogdet(dense)[1], rel=1e-9)
    right = rng.normal(size=(40, 3))
    np.testing.assert_allclose(factor.solve(right), np.linalg.solve(dense, right), rtol=1e-7, atol=1e-9)


@pytest.mark.parametrize(
    "matrix", [[[1.0, 2.0], [2.0, 1.0]], [[1.0, 1.0], [1.0, 1.0]], [[-1.0, 0.0], [0.0, 1.0]]]
)
def test_a_matrix_that_is_not_positive_definite_is_refused(matrix: list[list[float]]) -> None:
    with pytest.raises(InputError, match="precision is not positive definite; its least pivot is"):
        Factor(sp.csc_matrix(np.array(matrix)))


@pytest.mark.parametrize("side", [1, 3, 5, 15])
def test_a_footprint_is_the_mean_over_the_cells_of_the_block_that_lie_on_the_grid(side: int) -> None:
    frame = GridFrame(1.0, 6, 9)
    field = np.random.default_rng(0).normal(size=frame.shape)
    spots = Spots(frame, (side,) if side == 1 else (1, side))
    means = spots.planes(spots.weights @ field.ravel())[-1]
    for row, col in np.ndindex(frame.shape):
        low, left = max(row - side // 2, 0), max(col - side // 2, 0)
        block = field[low : row + side // 2 + 1, left : col + side // 2 + 1]
        assert means[row, col] == pytest.approx(block.mean())
        whole = spots.whole[spots.of(side, np.array([row * 9 + col]))][0]
        assert whole == (block.size == side**2)


@pytest.mark.parametrize(
    ("changes", "line"),
    [
        ({"deviation": 0.0}, "deviation must be a number > 0; got 0.0"),
        ({"deviation": math.nan}, "deviation must be a number > 0; got nan"),
        ({"length": 1.0}, "length 1 m is less than a cell; take 2 m or more"),
        ({"lasting": 0.0}, "lasting must be > 0 s; got 0.0"),
        ({"lasting": math.nan}, "lasting must be > 0 s; got nan"),
        ({"mean": math.inf}, "mean must be a number; got inf"),
        ({"drift": (0.0, math.nan)}, "drift y must be a number; got nan"),
        ({"rows": 1, "cols": 3}, "field has 3 cells; take 4 to"),
    ],
)
def test_a_field_that_cannot_be_is_refused_in_one_line(changes: dict[str, float], line: str) -> None:
    with pytest.raises(InputError, match=line):
        model(**changes)  # type: ignore[arg-type]


@pytest.mark.parametrize("sides", [(), (2,), (17,), (1, 1), (-1,)])
def test_footprints_that_cannot_be_are_refused(sides: tuple[int, ...]) -> None:
    with pytest.raises(InputError, match="footprints: "):
        Spots(GridFrame(1.0, 4, 4), sides)


def test_the_longest_length_there_is_leaves_deviations_right_to_five_digits() -> None:
    frame = GridFrame(0.3, 20, 15)
    known = FieldBelief.prior(FieldModel(frame, deviation=2.0, length=300.0), Spots(frame))
    np.testing.assert_allclose(known.deviations(np.arange(frame.size)), 2.0, rtol=1e-5)
    with pytest.raises(InputError, match="length 301 m is more than 1000 cells; take 300 m or less"):
        FieldModel(frame, length=301.0)

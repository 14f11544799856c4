"""The correlation of walls and free ground: equal to its twin, and to counting cells one by one."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from vedette.kernels.align import ALIKE, ELSE, SAME, Weights, align_counts, align_fit, align_peaks
from vedette.kernels.reference import align as reference

Floats = NDArray[np.float64]
Masks = tuple[NDArray[np.float32], NDArray[np.float32]]


def drawn(seed: int, size: int) -> tuple[Masks, tuple[Floats, Floats]]:
    """Return A on a torus and points of B, at random."""
    rng = np.random.default_rng(seed)
    walls, free = np.zeros((2, size, size), np.float32)
    rows, cols = rng.integers(2, size // 2, 2)
    walls[:rows, :cols] = rng.random((rows, cols)) < 0.3
    free[:rows, :cols] = (rng.random((rows, cols)) < 0.6) * (1.0 - walls[:rows, :cols])
    span = size / 6.0
    return (walls, free), (rng.uniform(-span, span, (40, 2)), rng.uniform(-span, span, (90, 2)))


@settings(deadline=None, max_examples=40)
@given(
    seed=st.integers(0, 2**32 - 1),
    size=st.integers(12, 40),
    angles=st.lists(st.floats(0.0, 1.57), min_size=1, max_size=3),
    weights=st.tuples(st.floats(0.1, 2.0), st.floats(0.0, 2.0), st.floats(0.0, 0.5)),
)
def test_the_peaks_of_each_angle_have_the_worth_that_the_twin_gives_them_and_the_first_is_the_highest(
    seed: int, size: int, angles: list[float], weights: tuple[float, float, float]
) -> None:
    a, b = drawn(seed, size)
    turned, of = np.array(angles), Weights(*weights)
    found = align_peaks(a, b, turned, of, 3, 3)
    expected = reference.align_peaks(a, b, turned, of, 3, 3)
    assert found[..., 0, 0] == pytest.approx(expected[..., 0, 0], abs=2e-3)
    for k, quarters in np.ndindex(found.shape[:2]):  # equal worths may be named in another order
        worth, rows, cols = found[k, quarters][np.isfinite(found[k, quarters, :, 0])].T
        places = rows.astype(int), cols.astype(int)
        assert worth == pytest.approx(reference.worths(a, b, turned[k], quarters, of)[places], abs=2e-3)
        assert (np.diff(worth) <= 0.0).all()
        gaps = np.abs(np.stack(places)[:, :, None] - np.stack(places)[:, None])
        apart = np.minimum(gaps, size - gaps).max(axis=0)
        assert (apart[~np.eye(len(worth), dtype=bool)] > 3).all()


def test_worths_without_a_tie_come_in_the_twins_order() -> None:
    rng = np.random.default_rng(8)
    a = rng.random((2, 30, 30), np.float32)
    b = rng.uniform(-6.0, 6.0, (40, 2)), rng.uniform(-6.0, 6.0, (90, 2))
    turned, of = np.array([0.3, 1.1]), Weights(1.0, 0.5, 0.1)
    found = align_peaks((a[0], a[1]), b, turned, of, 5, 3)
    expected = reference.align_peaks((a[0], a[1]), b, turned, of, 5, 3)
    assert found == pytest.approx(expected, abs=1e-3)


def test_the_worth_of_a_shift_is_what_its_cells_count_one_by_one() -> None:
    a, (walls, free) = drawn(3, 30)
    weights = Weights(1.0, 0.6, 0.1)
    (worth, row, col), *_ = align_peaks(a, (walls, free), np.array([0.4]), weights, 1, 1)[0, 2]
    c, s = np.cos(0.4), np.sin(0.4)
    on_walls = {cell(x, y, c, s) for x, y in walls}
    on_free = {cell(x, y, c, s) for x, y in free} - on_walls
    counted = 0.0
    for cells, first, second in ((on_walls, 1.0, -0.6), (on_free, -0.6, 0.1)):
        for x, y in cells:  # half a turn: minus both
            at = (int(row) - y) % 30, (int(col) - x) % 30
            counted += first * float(a[0][at]) + second * float(a[1][at])
    assert worth == pytest.approx(counted, abs=1e-3)


def cell(x: float, y: float, c: float, s: float) -> tuple[int, int]:
    return int(np.floor(c * x - s * y + 0.5)), int(np.floor(s * x + c * y + 0.5))


@settings(deadline=None, max_examples=60)
@given(seed=st.integers(0, 2**32 - 1), rows=st.integers(1, 20), cols=st.integers(1, 20))
def test_faces_on_labels_are_counted_as_the_twin_counts_them(seed: int, rows: int, cols: int) -> None:
    rng = np.random.default_rng(seed)
    labels, looks = rng.integers(0, 4, (rows, cols), np.uint8), rng.integers(0, 256, (rows, cols), np.uint8)
    faces = rng.uniform(-10.0, 10.0, (50, 2)), rng.integers(0, 256, 50, np.uint8)
    transforms = np.column_stack([rng.uniform(-5.0, 25.0, (3, 2)), rng.uniform(-4.0, 4.0, 3)])
    counts = align_counts(labels, looks, *faces, transforms)
    assert np.array_equal(counts, reference.align_counts(labels, looks, *faces, transforms))
    assert (counts.sum(axis=1) == 50).all()


def test_a_wall_that_looks_the_other_way_is_not_the_same() -> None:
    labels, looks = np.full((1, 1), SAME, np.uint8), np.zeros((1, 1), np.uint8)
    point, quarter = np.array([[0.5, 0.5]]), np.array([64], np.uint8)
    for turn, label in ((-64, SAME), (-64 - ALIKE, SAME), (-64 - ALIKE - 1, ELSE), (64, ELSE)):
        angle = turn * np.pi / 128.0
        x, y = (0.5, 0.5) - np.array([np.cos(angle) - np.sin(angle), np.sin(angle) + np.cos(angle)]) / 2.0
        counts = align_counts(labels, looks, point, quarter, np.array([[x, y, angle]]))
        assert counts[0, label] == 1, turn


def test_masks_of_two_sizes_are_refused() -> None:
    a = np.zeros((4, 4), np.float32), np.zeros((5, 5), np.float32)
    with pytest.raises(ValueError, match="squares of one size"):
        align_peaks(a, (np.zeros((1, 2)), np.zeros((1, 2))), np.zeros(1), Weights(1.0, 1.0, 0.0), 1, 1)


def room(seed: int) -> tuple[NDArray[np.int32], Floats, Floats]:
    """Return the nearest face to each cell of a room of 6 x 4 m, and its faces and normals."""
    rng = np.random.default_rng(seed)
    along, up = rng.uniform(0.0, 6.0, 60), rng.uniform(0.0, 4.0, 40)
    sides = [
        (np.column_stack([along[:30], np.zeros(30)]), (0.0, 1.0)),
        (np.column_stack([along[30:], np.full(30, 4.0)]), (0.0, -1.0)),
        (np.column_stack([np.zeros(20), up[:20]]), (1.0, 0.0)),
        (np.column_stack([np.full(20, 6.0), up[20:]]), (-1.0, 0.0)),
    ]
    faces = np.vstack([places for places, _ in sides])
    normals = np.vstack([np.tile(normal, (len(places), 1)) for places, normal in sides])
    row, col = np.mgrid[:60, :80]
    cells = np.stack([col - 10.0, row - 10.0], axis=-1) * 0.1 + 0.05
    away = np.hypot(*np.moveaxis(cells[:, :, None] - faces, -1, 0))
    return away.argmin(axis=2).astype(np.int32), faces, normals


@settings(deadline=None, max_examples=40)
@given(
    seed=st.integers(0, 2**32 - 1),
    guess=st.tuples(st.floats(-0.5, 0.5), st.floats(-0.5, 0.5), st.floats(-0.15, 0.15)),
    reaches=st.lists(st.floats(0.05, 1.0), min_size=1, max_size=4),
)
def test_faces_are_fitted_as_the_twin_fits_them(
    seed: int, guess: tuple[float, float, float], reaches: list[float]
) -> None:
    face_at, faces, normals = room(seed)
    grid = face_at, 0.1, np.array([-1.0, -1.0]), (faces, normals)
    moving = room(seed + 1)[1:]
    found = align_fit(*grid, moving, guess, np.array(reaches))
    expected = reference.align_fit(*grid, moving, guess, np.array(reaches))
    assert found.paired == expected.paired
    assert found.pose == pytest.approx(expected.pose, abs=1e-6)
    assert found.matrix == pytest.approx(expected.matrix, rel=1e-6, abs=1e-6)
    assert found.squares == pytest.approx(expected.squares, rel=1e-6, abs=1e-9)


def test_a_room_moved_and_turned_a_little_is_laid_on_itself() -> None:
    face_at, faces, normals = room(3)
    x, y, angle = 0.12, -0.2, 0.05
    c, s = np.cos(angle), np.sin(angle)
    back = np.array([[c, s], [-s, c]])
    moved = (faces - (x, y)) @ back.T, normals @ back.T
    reaches = np.array([0.8, 0.5, 0.3, 0.3, 0.2])
    laid = align_fit(face_at, 0.1, np.array([-1.0, -1.0]), (faces, normals), moved, (0.0, 0.0, 0.0), reaches)
    assert laid.pose == pytest.approx((x, y, angle), abs=1e-3)
    assert laid.squares < 1e-6


def test_a_cell_that_names_no_face_is_refused() -> None:
    one = np.zeros((1, 2)), np.zeros((1, 2))
    for face in (-1, 1):
        with pytest.raises(ValueError, match="name one of the faces"):
            align_fit(
                np.full((2, 2), face, np.int32), 0.1, np.zeros(2), one, one, (0.0, 0.0, 0.0), np.ones(1)
            )

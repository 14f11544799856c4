"""Mission figures against truth, on worlds small enough to count by hand."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vedette.maps import FREE, OCCUPIED, UNKNOWN, GridFrame
from vedette.maps.world import World
from vedette.record.explore.score import CoverageProgress, Reference, coverage, map_errors, overlap
from vedette.team import PlatformSpec


def world_of(solid: np.ndarray) -> World:
    return World(GridFrame(0.1, *solid.shape), solid, "test")


def two_rooms() -> World:
    solid = np.zeros((20, 60), np.bool_)
    solid[:, 30] = True
    return world_of(solid)


def reference(world: World, *specs: PlatformSpec, x: float = 1.0, y: float = 1.0) -> Reference:
    return Reference(world, specs, np.array([[x, y, 0.0]] * len(specs)))


def test_what_no_disc_can_see_is_not_coverable() -> None:
    world = two_rooms()
    coverable = reference(world, PlatformSpec()).coverable
    assert coverable[:, :30].all()
    assert not coverable[:, 30:].any()


def test_a_short_range_leaves_out_what_lies_beyond_the_reachable_poses() -> None:
    solid = np.zeros((21, 60), np.bool_)
    solid[:, 20] = True
    solid[10, 20] = False  # a slit that light passes and the disc does not
    far = reference(world_of(solid), PlatformSpec(range=8.0), y=1.05).coverable
    near = reference(world_of(solid), PlatformSpec(range=1.0), y=1.05).coverable
    assert far[10, 20:].all()
    assert near[10, 25]
    assert not near[10, 31:].any()  # the disc gets no nearer to it than 1.2 m
    both = reference(world_of(solid), PlatformSpec(range=1.0), PlatformSpec(range=8.0), y=1.05).coverable
    np.testing.assert_array_equal(both, far)


def test_coverage_is_the_known_share_of_coverable_cells() -> None:
    world = two_rooms()
    classes = np.full(world.frame.shape, UNKNOWN, np.uint8)
    ref = reference(world, PlatformSpec())
    assert coverage(ref, classes) == 0.0
    classes[:, 31:] = FREE  # the other room counts for nothing
    assert coverage(ref, classes) == 0.0
    classes[:10, :30] = FREE
    assert coverage(ref, classes) == 0.5
    assert coverage(ref, world.classes()) == 1.0


def test_a_wrong_cell_counts_unless_it_touches_a_true_boundary() -> None:
    solid = np.zeros((12, 12), np.bool_)
    solid[:, 6:] = True
    truth = world_of(solid)
    assert map_errors(truth, truth.classes()) == (0, 144)
    for cell, wrong in (
        ((5, 5), 0),
        ((5, 4), 1),
        ((5, 6), 0),
        ((5, 7), 1),
        ((0, 2), 0),
        ((0, 9), 1),
        ((5, 0), 0),
    ):
        classes = truth.classes()
        classes[cell] = OCCUPIED if classes[cell] == FREE else FREE
        assert map_errors(truth, classes) == (wrong, 144), cell
        classes[cell] = UNKNOWN
        assert map_errors(truth, classes) == (0, 143), cell


@given(seed=st.integers(0, 10_000))
@settings(deadline=None, max_examples=30)
def test_map_errors_are_those_of_a_cell_by_cell_count(seed: int) -> None:
    rng = np.random.default_rng(seed)
    solid = np.kron(rng.random((3, 4)) < 0.4, np.ones((4, 4))).astype(np.bool_)
    classes = rng.integers(0, 3, solid.shape).astype(np.uint8)
    classes[: rng.integers(0, 7)] = classes[:, rng.integers(4, 17) :] = UNKNOWN
    padded = np.pad(solid, 1, constant_values=True)
    wrong = 0
    for row, col in np.ndindex(*solid.shape):
        block = padded[row : row + 3, col : col + 3]
        uniform = (block == solid[row, col]).all()
        wrong += bool(uniform and classes[row, col] == (FREE if solid[row, col] else OCCUPIED))
    assert map_errors(world_of(solid), classes) == (wrong, int(np.count_nonzero(classes)))


def test_overlap_is_the_share_seen_by_two_or_more() -> None:
    a = np.array([[True, True, False, False]])
    b = np.array([[False, True, True, False]])
    assert overlap([a]) == 0.0
    assert overlap([a, b]) == pytest.approx(1 / 3)
    assert overlap([a, b, b]) == pytest.approx(2 / 3)
    assert overlap([a & ~a]) == 0.0


def test_times_and_area_are_those_of_a_step_curve() -> None:
    progress = CoverageProgress()
    assert progress.t_at(0.5) is None
    assert progress.auc(10.0) == 10.0
    for t, share in ((1.0, 0.2), (2.0, 0.5), (2.0, 0.6), (4.0, 0.9)):
        progress.add(t, share)
    assert progress.t_at(0.5) == 2.0
    assert progress.t_at(0.9) == 4.0
    assert progress.t_at(0.95) is None
    assert progress.auc(6.0) == pytest.approx(1.0 + 0.8 + 2 * 0.4 + 2 * 0.1)
    assert progress.auc(3.0) == pytest.approx(1.0 + 0.8 + 0.4)
    with pytest.raises(ValueError, match="time order"):
        progress.add(3.0, 0.9)

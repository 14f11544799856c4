"""The belief of a round: windows change nothing, worth is entropy plus hidden area, nothing is shared."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from tests.support.mapping_scenes import CORRIDOR, FRAME, SPEC, explored, frozen, placed
from vedette.domains.mapping import layers
from vedette.domains.mapping.belief import LN2, MapBelief, freeze, planning_factor
from vedette.domains.mapping.impact import NOTHING
from vedette.domains.mapping.platform import MappingPlatform
from vedette.domains.mapping.sightings import empty_counts
from vedette.domains.mapping.stops import block
from vedette.domains.mapping.tour import STAY
from vedette.kernels.reference.coverage import dense
from vedette.maps import FREE, UNKNOWN, GridFrame

seeds = st.integers(0, 2**32 - 1)
PLACES = [[(-0.5, 7.1)], CORRIDOR, [(-0.5, 7.1), (-0.6, 4.0), (10.0, 8.0)]]


def frontiers(belief: MapBelief) -> list[NDArray[np.float64]]:
    """Where the cells of every frontier are [m], so that windows of different size compare."""
    points = belief.frame.centres(belief.frontier_cells)
    return np.split(points, belief.frontier_starts[1:-1])


def random_classes(rng: np.random.Generator) -> tuple[NDArray[np.uint8], GridFrame]:
    """A blob of known cells in a grid of any shape, resolution and planning factor."""
    rows, cols = (int(side) for side in rng.integers(5, 60, 2))
    classes = np.zeros((rows, cols), np.uint8)
    row, col = rng.integers(0, rows), rng.integers(0, cols)
    patch = classes[row : row + rng.integers(1, 30), col : col + rng.integers(1, 30)]
    patch[:] = rng.choice([0, 1, 1, 1, 2], patch.shape)
    patch[0, 0] = FREE
    return classes, GridFrame(float(rng.choice([0.05, 0.07, 0.1, 0.3])), rows, cols, -1.7, 0.4)


@settings(deadline=None, max_examples=60)
@given(seeds)
def test_cropping_to_the_window_changes_neither_worth_nor_frontiers(seed: int) -> None:
    rng = np.random.default_rng(seed)
    classes, frame = random_classes(rng)
    cropped = frozen(classes, frame=frame, reach=3 * frame.resolution)
    whole = frozen(classes, frame=frame, reach=1e3)
    assert whole.frame == frame
    np.testing.assert_array_equal(dense(cropped.weights), dense(whole.weights))
    for one, other in zip(frontiers(cropped), frontiers(whole), strict=True):
        np.testing.assert_allclose(one, other, atol=1e-9)
    local = np.arange(cropped.unknown.size, dtype=np.uint32)
    there = whole.planning_cells(np.arange(whole.unknown.size, dtype=np.uint32))
    np.testing.assert_array_equal(there, np.arange(whole.planning.size))
    np.testing.assert_array_equal(
        whole.unknown.ravel()[cropped.planning_cells(local)], cropped.unknown.ravel()
    )


def test_of_a_map_of_which_nothing_is_known_a_round_takes_one_planning_cell() -> None:
    belief = frozen(np.zeros((70, 50), np.uint8), frame=GridFrame(0.1, 70, 50))
    assert belief.frame == GridFrame(0.1, 2, 2)
    assert not len(belief.frontier_cells)


@settings(deadline=None, max_examples=60)
@given(seeds)
def test_being_told_where_nothing_is_known_changes_nothing(seed: int) -> None:
    rng = np.random.default_rng(seed)
    classes, frame = random_classes(rng)
    where = np.argwhere(classes)
    low, high = (where.min(axis=0), where.max(axis=0) + 1) if len(where) else (np.zeros(2, int),) * 2
    low = np.maximum(low - rng.integers(0, 5, 2), 0)
    rows, cols = (slice(int(a), int(b + rng.integers(0, 5))) for a, b in zip(low, high, strict=True))
    one, other = (
        freeze(
            classes[known],
            frame,
            reach=3 * frame.resolution,
            extent=2.5,
            hidden=2.0,
            layers=layers.rate(),
            counts=empty_counts(),
            known=known,
        )
        for known in ((slice(None), slice(None)), (rows, cols))
    )
    assert (one.frame, one.first) == (other.frame, other.first)
    for name in ("classes", "unknown", "frontier_cells", "frontier_starts"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))
    np.testing.assert_array_equal(dense(one.weights), dense(other.weights))


@pytest.mark.parametrize("places", PLACES)
def test_cropping_to_the_window_does_not_change_decisions(places: list[tuple[float, float]]) -> None:
    tours = []
    for reach in (SPEC.range, 1e3):
        belief, platform = frozen(explored(places), reach=reach), MappingPlatform(SPEC)
        placed(platform, belief)
        tours.append(platform.reply(belief, NOTHING, STAY))
    assert len(tours[0])
    np.testing.assert_allclose(tours[0].views, tours[1].views, atol=1e-9)
    np.testing.assert_array_equal(tours[0].arrivals, tours[1].arrivals)


def test_equal_evidence_gives_equal_beliefs() -> None:
    one, other = frozen(explored(CORRIDOR)), frozen(explored(CORRIDOR[::-1]))
    for name in ("classes", "unknown", "frontier_cells", "frontier_starts", "counts"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name), strict=True)
    np.testing.assert_array_equal(dense(one.weights), dense(other.weights), strict=True)
    assert (one.frame, one.planning, one.first) == (other.frame, other.planning, other.first)


@settings(deadline=None, max_examples=60)
@given(seeds, st.floats(0.0, 10.0))
def test_total_worth_is_the_entropy_of_the_unknown_plus_the_hidden_area_of_every_frontier(
    seed: int, hidden: float
) -> None:
    classes, frame = random_classes(np.random.default_rng(seed))
    belief = frozen(classes, frame=frame, hidden=hidden, reach=0.5)
    count = len(belief.frontier_starts) - 1
    cells = np.count_nonzero(classes == UNKNOWN) + count * hidden / frame.resolution**2
    assert dense(belief.weights).sum(dtype=np.float64) == pytest.approx(LN2 * cells, rel=1e-5)


def test_hidden_area_lies_only_where_unknown_cells_touch_a_frontier() -> None:
    with_it, without = frozen(hidden=3.0), frozen(hidden=0.0)
    bonus = dense(with_it.weights) - dense(without.weights)
    assert bonus.any()
    for cell in np.flatnonzero(bonus):
        row, col = divmod(int(cell), with_it.planning.cols)
        factor = with_it.factor
        around = explored(CORRIDOR)[
            max(0, row * factor - 1) : row * factor + factor + 1,
            max(0, col * factor - 1) : col * factor + factor + 1,
        ]
        assert (around == UNKNOWN).any()
        assert (around == FREE).any()


def test_planning_cells_at_the_far_edges_count_only_the_cells_that_exist() -> None:
    frame = GridFrame(0.1, 7, 5)
    known = np.zeros(frame.shape, np.uint8)
    known[0, 0] = FREE
    belief = frozen(known, frame=frame)
    assert belief.factor == planning_factor(0.1) == 2
    assert belief.unknown.tolist() == [[3, 4, 2]] + [[4, 4, 2]] * 2 + [[2, 2, 1]]
    near = frozen(known, frame=frame, reach=0.1, hidden=0.0)
    assert near.unknown.shape == (1, 1)
    expected = np.array([[3, 4, 2]] + [[4, 4, 2]] * 2 + [[2, 2, 1]]) * LN2
    np.testing.assert_allclose(dense(near.weights).reshape(4, 3), expected, rtol=1e-6)


@pytest.mark.parametrize("reach", [0.1, 1e3])
def test_a_frozen_belief_does_not_see_the_map_change(reach: float) -> None:
    classes = explored(CORRIDOR)
    belief = frozen(classes, reach=reach)
    before = belief.classes.copy()
    classes[:] = FREE
    np.testing.assert_array_equal(belief.classes, before)


def test_the_window_keeps_the_frame_of_the_map() -> None:
    belief = frozen(reach=0.3)
    assert belief.frame.rows < FRAME.rows
    for flat in (0, belief.frame.size - 1):
        x, y = belief.frame.centres(np.array([flat]))[0]
        row, col = FRAME.cell(x, y)
        assert belief.classes.ravel()[flat] == explored(CORRIDOR)[row, col]


@settings(deadline=None, max_examples=60)
@given(seeds)
def test_a_disc_blocks_the_cells_whose_centres_are_too_near_it_wherever_it_stands(seed: int) -> None:
    rng = np.random.default_rng(seed)
    frame = GridFrame(float(rng.choice([0.05, 0.1, 0.3])), 31, 47, -1.7, 0.4)
    x, y = rng.uniform((-3.0, -1.0), (14.0, 12.0))
    size, radius = rng.uniform(0.05, 1.0, 2)
    passable = np.ones(frame.shape, bool)
    block(passable, frame, (x, y, size), radius)
    centres = frame.centres(np.arange(frame.size))
    away = np.hypot(centres[:, 0] - x, centres[:, 1] - y).reshape(frame.shape)
    clear = np.abs(away - size - radius) > 1e-9
    np.testing.assert_array_equal(passable[clear], (away > size + radius)[clear])

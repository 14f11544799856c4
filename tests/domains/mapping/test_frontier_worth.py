"""A frontier stands for the area behind it and for the way back to it; the sum is conserved."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from tests.support.mapping_scenes import frozen
from vedette.domains.mapping.frontier_worth import (
    FARTHEST,
    NEIGHBOURS,
    frontier_areas,
    leads_on,
    spread_behind,
)
from vedette.domains.mapping.sightings import berths_in, empty_counts
from vedette.kernels.frontier import find_frontiers
from vedette.maps import FREE, OCCUPIED, UNKNOWN, GridFrame

FRAME = GridFrame(0.5, 40, 60)
SIDES = [(-1, 0), (1, 0), (0, -1), (0, 1)]


def clusters(middles: list[int]) -> tuple[np.ndarray, np.ndarray]:
    """Frontiers of one cell each."""
    return np.array(middles, np.int64), np.arange(len(middles) + 1, dtype=np.int64)


def test_without_a_price_every_frontier_stands_for_the_hidden_area() -> None:
    cells, starts = clusters([3, 700, 1500])
    np.testing.assert_array_equal(frontier_areas(FRAME, cells, starts, 2.0, 0.0), [2.0, 2.0, 2.0])
    assert frontier_areas(FRAME, cells, starts, 2, 0).dtype == np.float64, "of whole numbers as well"


@pytest.mark.parametrize("seed", range(5))
def test_the_price_is_the_distance_to_the_fifth_nearest_other_frontier(seed: int) -> None:
    rng = np.random.default_rng(seed)
    cells, starts = clusters(sorted(rng.choice(FRAME.size, 20, replace=False).tolist()))
    points = FRAME.centres(cells)
    for own, area in zip(points, frontier_areas(FRAME, cells, starts, 2.0, 1.5), strict=True):
        apart = sorted(float(np.hypot(*(own - other))) for other in points)
        assert area == pytest.approx(2.0 + 1.5 * min(apart[NEIGHBOURS], FARTHEST))


def test_the_last_few_frontiers_all_cost_the_longest_way_back() -> None:
    cells, starts = clusters([3, 4, 5])
    np.testing.assert_array_equal(frontier_areas(FRAME, cells, starts, 1.0, 2.0), [1.0 + 2.0 * FARTHEST] * 3)


def test_what_a_frontier_stands_for_is_spread_whole_over_what_touches_it() -> None:
    classes = frozen().classes
    cells, starts = find_frontiers(classes, 2, 12)
    areas = np.random.default_rng(0).uniform(1.0, 9.0, len(starts) - 1)
    for factor in (1, 2, 3):
        spread = spread_behind(classes, cells, starts, areas, factor)
        assert spread.sum() == pytest.approx(areas.sum(), rel=1e-5)


def learned(shares: list[float]) -> np.ndarray:
    """Return counts of a million tries a berth, of which such a share was seen however deep."""
    counts = empty_counts()
    counts[0::2] = 10**6
    counts[3::2] = np.multiply(10**6, shares)[:, None]
    return counts


def unknown_beside(classes: np.ndarray, cells: np.ndarray) -> list[tuple[int, int]]:
    """Return the unknown neighbours of each cell in turn."""
    around = [
        (r + i, c + j) for r, c in zip(*np.divmod(cells, classes.shape[1]), strict=True) for i, j in SIDES
    ]
    inside = [(r, c) for r, c in around if 0 <= r < classes.shape[0] and 0 <= c < classes.shape[1]]
    return [place for place in inside if classes[place] == UNKNOWN]


@pytest.mark.parametrize("resolution", [0.05, 0.1, 0.3])
def test_a_frontier_leads_on_by_what_was_seen_a_metre_behind_cells_of_the_same_berth(
    resolution: float,
) -> None:
    classes = frozen().classes
    cells, starts = find_frontiers(classes, 2, 12)
    shares = [0.02, 0.1, 0.3, 0.4, 0.8, 0.6]
    walls = np.argwhere(classes == OCCUPIED)
    step = max(1, round(0.1 / resolution))
    expected = []
    for low, high in itertools.pairwise(starts):
        beside = unknown_beside(classes, cells[low:high])
        away = [int(np.abs(walls - place).max(axis=1).min()) for place in beside]
        expected.append(np.mean([shares[min((far - 1) // step, 5)] for far in away]) / 0.8)
    berths = berths_in(classes, resolution)
    found = leads_on(classes, berths, (cells, starts), learned(shares), resolution)
    np.testing.assert_allclose(found, expected, atol=1e-3)


def test_a_gap_in_a_wall_stands_for_nothing_once_gaps_have_shown_nothing_and_an_open_front_for_all() -> None:
    classes = np.zeros((40, 40), np.uint8)
    classes[:20, :30] = FREE
    classes[20, :20] = OCCUPIED
    classes[20, 5:8] = UNKNOWN  # seen aslant; from column 20 on nobody has looked yet
    frontiers = find_frontiers(classes, 2, 12)
    found = leads_on(
        classes, berths_in(classes, 0.1), frontiers, learned([0.0, 0.0, 1.0, 1.0, 1.0, 1.0]), 0.1
    )
    gap = frontiers[0][frontiers[1][:-1]] == 19 * 40 + 5
    assert gap.sum() == 1
    assert found[gap] == pytest.approx(0.0, abs=1e-4)
    assert found[~gap].max() == pytest.approx(1.0)
    nothing_yet = leads_on(classes, berths_in(classes, 0.1), frontiers, empty_counts(), 0.1)
    np.testing.assert_allclose(nothing_yet, 1.0)

"""A frontier stands for the area behind it and for the way back to it; the sum is conserved."""

from __future__ import annotations

import numpy as np
import pytest

from tests.support.mapping_scenes import frozen
from vedette.domains.mapping.frontier_worth import FARTHEST, NEIGHBOURS, frontier_areas, spread_behind
from vedette.kernels.frontier import find_frontiers
from vedette.maps import GridFrame

FRAME = GridFrame(0.5, 40, 60)


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

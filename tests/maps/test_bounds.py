"""Bounds hold all that they are told of, and no row or column more than that takes."""

from __future__ import annotations

import numpy as np
import pytest

from vedette.maps.bounds import Bounds


@pytest.mark.parametrize("seed", range(20))
def test_bounds_are_the_smallest_that_hold_all_cells(seed: int) -> None:
    rng = np.random.default_rng(seed)
    marked, bounds = np.zeros((40, 60), bool), Bounds()
    assert marked[bounds.extent].size == 0
    for _ in range(rng.integers(1, 5)):
        rows, cols = rng.integers(40, size=rng.integers(0, 4)), rng.integers(60, size=4)
        bounds.widen(rows, cols[: len(rows)])
        marked[rows, cols[: len(rows)]] = True
        inside = marked[bounds.extent]
        assert np.count_nonzero(inside) == np.count_nonzero(marked)
        if marked.any():
            assert inside[[0, -1]].any(axis=1).all()
            assert inside[:, [0, -1]].any(axis=0).all()

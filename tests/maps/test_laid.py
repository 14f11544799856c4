"""Grids seen on others: where anything of them lies."""

from __future__ import annotations

import numpy as np
import pytest

from vedette.maps.frame import GridFrame
from vedette.maps.laid import laid, under


def drawn(rng: np.random.Generator) -> GridFrame:
    rows, cols = rng.integers(1, 12, 2).tolist()
    x, y = rng.uniform(-1.5, 1.5, 2).tolist()
    return GridFrame(rows=rows, cols=cols, resolution=float(rng.choice([0.1, 0.2])), origin_x=x, origin_y=y)


@pytest.mark.parametrize("seed", range(40))
def test_nothing_of_some_grids_lies_outside_what_is_said_to_be_under(seed: int) -> None:
    rng = np.random.default_rng(seed)
    onto, frames = drawn(rng), [drawn(rng) for _ in range(rng.integers(0, 4))]
    there = np.zeros(onto.shape, np.bool_)
    for frame in frames:
        there |= laid(np.ones(frame.shape, np.bool_), frame, onto)
    rows, cols = under(frames, onto)
    assert there.sum() == there[rows, cols].sum()
    if there.any():
        along, across = np.flatnonzero(there.any(axis=1)), np.flatnonzero(there.any(axis=0))
        assert (rows.start, rows.stop) == (along[0], along[-1] + 1)
        assert (cols.start, cols.stop) == (across[0], across[-1] + 1)

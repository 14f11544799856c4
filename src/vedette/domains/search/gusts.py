"""What a vehicle would detect that winds may carry off its way: the mean over where it ends up."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from vedette.domains.search.detectors import Detector
from vedette.domains.search.flights import Branches
from vedette.maps import GridFrame
from vedette.vehicle import Gust, carried

Sparse: TypeAlias = tuple[NDArray[np.int64], NDArray[np.uint32], NDArray[np.float64]]


def expected_footprints(
    detector: Detector,
    frame: GridFrame,
    tree: Branches,
    poses: NDArray[np.float64],
    dt: float,
    gusts: tuple[Gust, ...],
) -> Sparse:
    """Return the probabilities that a step's looks detect, averaged over the gusts: not rounded yet.

    Exact for each step by itself, since psi is linear in its misses; that one gust lasts through all of them
    is left out, as if each step had drawn its own. docs/theory.md (V107)

    Args:
        detector: the sensor.
        frame: the grid.
        tree: N steps of flights.
        poses: (N, looks, 3) without wind.
        dt: of a step [s].
        gusts: with their probabilities.

    Returns:
        starts (N + 1,), cells and probabilities, as `Detector.footprints`.
    """
    looks = poses.shape[1]
    after = dt * (_steps_before(tree)[:, None] + np.arange(1, looks + 1) / looks)
    found = [detector.footprints(frame, carried(poses, after, gust.wind)) for gust in gusts]
    if len(gusts) == 1:
        return found[0]
    rows = [np.repeat(np.arange(len(poses)), np.diff(starts)) for starts, _, _ in found]
    keys = np.concatenate([row * frame.size + cells for row, (_, cells, _) in zip(rows, found, strict=True)])
    shares = np.concatenate([gust.chance * p for gust, (_, _, p) in zip(gusts, found, strict=True)])
    distinct, where = np.unique(keys, return_inverse=True)
    row, cell = np.divmod(distinct, frame.size)
    starts = np.searchsorted(row, np.arange(len(poses) + 1))
    return starts.astype(np.int64), cell.astype(np.uint32), np.bincount(where, shares).astype(np.float64)


def _steps_before(tree: Branches) -> NDArray[np.int64]:
    """Return how many steps go before each of a tree's."""
    before = np.zeros(len(tree.parents), np.int64)
    for node, parent in enumerate(tree.parents.tolist()):
        if parent >= 0:
            before[node] = before[parent] + 1
    return before

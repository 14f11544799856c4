"""How likely a scan is to see an unknown cell: the beam model, and the paper's measured one (Fig. 3)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vedette.kernels import coverage

BIN = 0.25  # [m]
BINS = 96  # 24 m; longer sensors share the last bin
PRIOR_TRIALS = 20.0  # weight of the prior in each bin
PRIOR_DEPTH = 3.0  # mean free path of the prior [m]
BERTHS = 6  # told apart, by how far from what is known occupied one looks into the unknown ...
BERTH = 0.1  # ... in steps of so much [m]
ROWS = 2 + 2 * BERTHS  # of counts
P_OCCUPIED = 0.5  # prior of an unknown cell


@dataclass(frozen=True, eq=False)
class SightingModel:
    """Probability that a scan reveals an unknown cell that no known obstacle hides, by berth and depth."""

    table: NDArray[np.float32]  # (berths or 1, T) by depth [cells]; the last entry holds beyond
    by_distance: bool  # depth is the distance from the sensor; otherwise the unknown length crossed before


def beam_model(cells: int) -> SightingModel:
    """``(1 - P)^k`` behind k unknown cells: the exact beam product on the grid; paper, eqs. (32) and (36).

    With 0.1 m cells it falls to 1e-3 within a metre, far below what rooms really show (paper, Fig. 3).
    """
    curve = (1.0 - P_OCCUPIED) ** np.arange(cells + 1)
    return SightingModel(curve.astype(np.float32)[None], by_distance=False)


def empty_counts() -> NDArray[np.int64]:
    """Return counts of no scan: rows tried and seen by distance, then of each berth by unknown length."""
    return np.zeros((ROWS, BINS), np.int64)


def berths_in(classes: NDArray[np.uint8], resolution: float) -> NDArray[np.uint8]:
    """Return ``(R, C)`` the berth of each cell of a grid.  docs/mapping.md (V240)"""
    return coverage.berths(classes, berth_step(resolution), BERTHS - 1)


def berth_step(resolution: float) -> int:
    """Return how many cells wider the next berth is."""
    return max(1, round(BERTH / resolution))


def pooled(told: NDArray[np.int64]) -> NDArray[np.int64]:
    """Add up ``(n, ROWS, BINS)`` counts of robots that need not be honest: nobody outweighs all the others.

    Where one has tried more than all others together it counts as if it had tried as often as they have; so
    what one says halves, or doubles, what is expected at most. Of one robot alone all counts.
    """
    tried = np.maximum(told[:, 0::2], 0)
    seen = np.clip(told[:, 1::2], 0, tried)
    counts = np.minimum(tried, tried.sum(axis=0) - tried) if len(told) > 1 else tried
    sightings = np.empty(told.shape[1:], np.int64)
    sightings[0::2] = counts.sum(axis=0)
    sightings[1::2] = np.rint(seen * (counts / np.maximum(tried, 1))).sum(axis=0)
    return sightings


def measured_model(
    counts: NDArray[np.int64], resolution: float, cells: int, *, by_distance: bool
) -> SightingModel:
    """Learned share of unknown cells seen at each depth; counts add, so a team pools them; paper, Fig. 3.

    Each bin is shrunk to ``exp(-depth / 3 m)`` with the weight of 20 trials, and the curve is made
    non-increasing by pooling adjacent violators.  docs/mapping.md (V25)

    Args:
        counts: (ROWS, BINS) as ``kernels.lidar.count_sightings`` sums them.
        resolution: cell side [m].
        cells: depth of the table [cells].
        by_distance: use the rows by distance (the paper's) instead of by unknown length; they make one curve
            for all berths.
    """
    rows = counts[:2] if by_distance else counts[2:]
    curves = [_curve(*pair, resolution, cells) for pair in zip(rows[0::2], rows[1::2], strict=True)]
    return SightingModel(np.array(curves, np.float32), by_distance)


def _curve(
    tried: NDArray[np.int64], seen: NDArray[np.int64], resolution: float, cells: int
) -> NDArray[np.float64]:
    depth = (np.arange(BINS) + 0.5) * BIN
    prior = np.exp(-depth / PRIOR_DEPTH)
    weight: NDArray[np.float64] = np.asarray(tried + PRIOR_TRIALS, np.float64)
    share = non_increasing((seen + PRIOR_TRIALS * prior) / weight, weight)
    at = (np.arange(cells + 1) + 0.5) * resolution
    return np.asarray(np.interp(at, depth, share))


def non_increasing(values: NDArray[np.float64], weights: NDArray[np.float64]) -> NDArray[np.float64]:
    """Weighted least-squares fit that never rises, by pooling adjacent violators."""
    pools: list[tuple[float, float, int]] = []
    for value, weight in zip(values.tolist(), weights.tolist(), strict=True):
        pools.append((value, weight, 1))
        while len(pools) > 1 and pools[-2][0] < pools[-1][0]:
            (v2, w2, n2), (v1, w1, n1) = pools.pop(), pools.pop()
            pools.append(((v1 * w1 + v2 * w2) / (w1 + w2), w1 + w2, n1 + n2))
    return np.repeat([value for value, _, _ in pools], [length for _, _, length in pools])

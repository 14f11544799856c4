"""Footprints of scans that will be taken from an uncertain pose."""

from __future__ import annotations

import itertools
import math
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from vedette.domains.mapping.impact import MIN_SHARE

Shares: TypeAlias = tuple[NDArray[np.int64], NDArray[np.uint32], NDArray[np.float32]]
"""Rows of a sparse matrix: (K + 1,) bounds, (M,) planning cells ascending in each row, (M,) shares."""

LEAST_TAP = 1e-3  # a displacement this unlikely, or less, is left out


def displacement(deviation: float) -> NDArray[np.float64]:
    """``w_j = E[max(0, 1 - |e - j|)]`` with e from N(0, deviation^2): ``(2 n + 1,)``, sum 1, j from -n to n.

    By so many cells a content spread evenly over its own moves under a displacement e; lengths in cells.
    docs/theory.md (V84)
    """
    if deviation <= 0.0:
        return np.ones(1)
    reach = math.ceil(4.0 * deviation) + 1
    beyond = [_mean_excess(float(j), deviation) for j in range(-reach - 1, reach + 2)]
    taps = np.diff(beyond, 2)
    kept = int(np.flatnonzero(taps >= LEAST_TAP)[0])
    taps = taps[kept : len(taps) - kept]
    return np.asarray(taps / taps.sum())


def _mean_excess(x: float, deviation: float) -> float:
    """``E[max(0, x - e)]``, e from N(0, deviation^2)."""
    z = x / deviation
    density = math.exp(-0.5 * z * z) / math.sqrt(2.0 * math.pi)
    return 0.5 * x * math.erfc(-z / math.sqrt(2.0)) + deviation * density


def blurred(footprints: Shares, unknown: NDArray[np.uint16], deviation: float) -> Shares:
    """``sum w u p / sum w u`` over the cells around: footprints of scans that land beside where they should.

    A planning cell's share becomes the mean of the shares around it, each by its unknown cells and by how
    likely the displacement is: it stays within 0..1, and what sees all around a cell still sees all of it.
    Shares that would round to nothing are left out. docs/theory.md (V85)

    Args:
        footprints: K rows over the window's planning cells.
        unknown: (r, c) unknown cells of each planning cell in the window.
        deviation: of each coordinate of the pose [planning cells]; 0 leaves the footprints as they are.
    """
    if deviation <= 0.0:
        return footprints
    starts, cells, shares = footprints
    taps = displacement(deviation)
    reach = len(taps) // 2
    around = _spread(unknown.astype(np.float64), taps)
    around = around[reach : reach + unknown.shape[0], reach : reach + unknown.shape[1]]
    rows = [
        _blurred_row(cells[first:last], shares[first:last], unknown, around, taps)
        for first, last in itertools.pairwise(starts)
    ]
    sizes = np.array([len(row) for row, _ in rows], np.int64)
    return (
        np.concatenate(([0], np.cumsum(sizes))),
        np.concatenate([np.empty(0, np.uint32), *(row for row, _ in rows)]),
        np.concatenate([np.empty(0, np.float32), *(share for _, share in rows)]),
    )


def _blurred_row(
    cells: NDArray[np.uint32],
    shares: NDArray[np.float32],
    unknown: NDArray[np.uint16],
    around: NDArray[np.float64],
    taps: NDArray[np.float64],
) -> tuple[NDArray[np.uint32], NDArray[np.float32]]:
    """Blur one footprint in the box that it fills and the taps reach."""
    if not len(cells):
        return cells, shares
    row, col = np.divmod(cells.astype(np.int64), unknown.shape[1])
    top, left, reach = int(row.min()), int(col.min()), len(taps) // 2
    seen = np.zeros((int(row.max()) - top + 1, int(col.max()) - left + 1))
    seen[row - top, col - left] = shares * unknown[row, col]
    spread = _spread(seen, taps)
    above, before = max(0, reach - top), max(0, reach - left)  # rows and columns outside the window
    spread = spread[above:, before:]
    top, left = max(0, top - reach), max(0, left - reach)
    box = np.s_[top : top + spread.shape[0], left : left + spread.shape[1]]
    counted = unknown[box]
    spread = spread[: counted.shape[0], : counted.shape[1]]
    share = np.divide(spread, around[box], out=np.zeros_like(spread), where=counted > 0)
    kept = np.nonzero(share >= MIN_SHARE)
    flat = (kept[0] + top) * unknown.shape[1] + kept[1] + left
    return flat.astype(np.uint32), np.minimum(share[kept], 1.0).astype(np.float32)


def _spread(values: NDArray[np.float64], taps: NDArray[np.float64]) -> NDArray[np.float64]:
    """Convolve rows and columns; the result is larger by the taps' reach on every side."""
    for _ in range(2):
        size, more = values.shape[0], len(taps) - 1
        out = np.zeros((size + more, values.shape[1]))
        for j, tap in enumerate(taps):
            out[j : j + size] += tap * values
        values = out.T
    return values

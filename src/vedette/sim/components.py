"""Label the connected parts of a grid."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def components(cells: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Return labels ``int64[R, C]``: 4-connected parts from 0 by their smallest flat index, -1 elsewhere.

    Four neighbours are what a robot that cuts no corner can use: a diagonal step needs both side cells. Runs
    along the rows are joined by giving each the smallest label it touches until nothing changes.
    """
    rows, cols = cells.shape
    padded = np.zeros((rows, cols + 1), np.int8)
    padded[:, :cols] = cells
    flat = padded.ravel()
    edges = np.diff(flat, prepend=np.int8(0))
    starts = np.flatnonzero(edges == 1)  # every run ends before its row's padding column
    run = np.cumsum(edges == 1).reshape(padded.shape)[:, :cols] - 1
    both = cells[1:] & cells[:-1]
    both[:, 1:] &= ~both[:, :-1]  # one link for each stretch that two runs share
    root = _roots(len(starts), run[:-1][both], run[1:][both])
    labels = np.unique(root, return_inverse=True)[1]
    return np.where(cells, labels[run] if len(starts) else -1, -1)


def largest(cells: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return the part with the most cells (the first of equals) as a mask; no cell where there is none."""
    labels = components(cells)
    if not cells.any():
        return np.zeros_like(cells)
    part: NDArray[np.bool_] = labels == np.bincount(labels[cells]).argmax()
    return part


def _roots(count: int, a: NDArray[np.int64], b: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return for each of ``count`` nodes the smallest node that the edges ``a[k] - b[k]`` link it to."""
    root = np.arange(count)
    while a.size:
        low = np.minimum(root[a], root[b])
        np.minimum.at(root, root[a], low)
        np.minimum.at(root, root[b], low)
        while not np.array_equal(root, root[root]):
            root = root[root]
        apart = root[a] != root[b]
        a, b = a[apart], b[apart]
    return root

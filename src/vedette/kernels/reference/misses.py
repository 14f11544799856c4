"""What the kernels of sparse log-misses compute, by whole arrays."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vedette.kernels.misses import SparseMisses


def pack_misses(impact: SparseMisses, cells: int, layers: int, runs: int) -> bytes:
    """Return the bytes of an impact before they are deflated."""
    layer = impact.keys % layers
    order = np.argsort(layer, kind="stable")
    cell = (impact.keys // layers)[order].astype(np.int64)
    run, place = np.divmod(layer[order].astype(np.int64) * cells + cell, cells * layers // runs)
    counts = np.bincount(run, minlength=runs)
    gap = np.diff(place, prepend=0)
    first = _firsts(counts)
    gap[first] = place[first]
    small, wide = np.minimum(gap, 255).astype(np.uint8), gap[gap >= 255].astype("<u4")
    return counts.astype("<u4").tobytes() + small.tobytes() + impact.misses[order].tobytes() + wide.tobytes()


def unpack_misses(body: bytes, cells: int, layers: int, runs: int) -> SparseMisses:
    """Return the impact of such bytes.

    Raises:
        ValueError: they are no impact over these cells and layers.
    """
    places, head = cells * layers // runs, 4 * runs
    if len(body) < head:
        raise ValueError("impact is cut short or too large")
    counts = np.frombuffer(body, "<u4", runs).astype(np.int64)
    total = int(counts.sum())
    if len(body) < head + 2 * total:
        raise ValueError("impact has fewer entries than it declares")
    gap = np.frombuffer(body, np.uint8, total, head).astype(np.int64)
    misses = np.frombuffer(body, np.uint8, total, head + total)
    large = body[head + 2 * total :]
    wide = gap == 255
    if len(large) != 4 * int(np.count_nonzero(wide)):
        raise ValueError("impact has the wrong number of wide gaps")
    gap[wide] = np.frombuffer(large, "<u4")
    place, first = np.cumsum(gap), _firsts(counts)
    place -= np.repeat((place - gap)[first], counts[counts > 0])
    if total and (place.max() >= places or misses.min() == 0):
        raise ValueError("impact has a cell outside the map or an empty entry")
    gap[first] = 1
    if not gap.all():
        raise ValueError("impact has the same cell and layer twice")
    place += np.repeat(np.arange(runs) * places, counts)
    layer, cell = np.divmod(place, cells)
    keys = cell * layers + layer
    order = np.argsort(keys, kind="stable")
    return SparseMisses(keys[order].astype(np.uint32), misses[order])


def _firsts(counts: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the index of the first entry of each run that has any."""
    firsts: NDArray[np.int64] = (np.cumsum(counts) - counts)[counts > 0]
    return firsts

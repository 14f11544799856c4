"""Impacts as paths of looks, those that begin alike sharing their beginning."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from vedette.domains.search.impact import Impact
from vedette.kernels.misses import Misses
from vedette.kernels.search import Paths


def shared_paths(impacts: Sequence[Impact], layers: int) -> tuple[Paths, NDArray[np.int64]]:
    """Return the forest of looks, one a layer, of impacts, and the look ``(K,)`` with which each ends."""
    known: dict[tuple[int, bytes, bytes], int] = {}
    parents: list[int] = []
    cells: list[NDArray[np.uint32]] = []
    misses: list[Misses] = []
    ends = np.empty(len(impacts), np.int64)
    for k, impact in enumerate(impacts):
        cell, layer = np.divmod(impact.keys, np.uint32(layers))
        order = np.argsort(layer, kind="stable")
        bounds = np.searchsorted(layer[order], np.arange(layers + 1))
        look = -1
        used = 1 + int(layer.max(initial=0))
        for start, end in pairwise(bounds[: used + 1]):
            part = order[start:end]
            name = (look, cell[part].tobytes(), impact.misses[part].tobytes())
            if name not in known:
                known[name] = len(parents)
                parents.append(look)
                cells.append(cell[part])
                misses.append(impact.misses[part])
            look = known[name]
        ends[k] = look
    return Paths(
        np.array(parents, np.int64),
        np.cumsum([0, *map(len, cells)], dtype=np.int64),
        np.concatenate([np.empty(0, np.uint32), *cells]),
        np.concatenate([np.empty(0, np.uint8), *misses]),
    ), ends


def impact_of(paths: Paths, end: int, layers: int) -> Impact:
    """Return the impact of the path that ends at a look."""
    looks = [end]
    while paths.parents[looks[0]] >= 0:
        looks.insert(0, int(paths.parents[looks[0]]))
    rows = [slice(paths.starts[look], paths.starts[look + 1]) for look in looks]
    keys = np.concatenate([paths.cells[row] * np.uint32(layers) + np.uint32(k) for k, row in enumerate(rows)])
    misses = np.concatenate([paths.misses[row] for row in rows])
    order = np.argsort(keys)
    return Impact(keys[order], misses[order])

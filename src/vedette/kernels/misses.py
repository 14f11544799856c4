"""Sparse log-misses by cell and layer: the form in which impacts of looks are combined, priced and sent."""

from __future__ import annotations

import zlib
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vedette import wire

STEPS_PER_NAT = 16.0
MOST_ENTRIES = 1 << 24  # of an impact, whatever the grid; more are refused
CERTAIN = 255  # log-misses saturate here

Keys = NDArray[np.uint32]
Misses = NDArray[np.uint8]
Cell = tuple[int, int]  # row, column


@dataclass(frozen=True, eq=False)
class SparseMisses:
    """Log-misses that start in a layer; an absent entry is a miss probability of 1 (identity)."""

    keys: Keys  # (M,) strictly increasing, cell * layers + layer
    misses: Misses  # (M,) log-miss in steps of 1/16 nat, 1..255

    def __eq__(self, other: object) -> bool:
        return (
            isinstance(other, SparseMisses)
            and np.array_equal(self.keys, other.keys)
            and np.array_equal(self.misses, other.misses)
        )

    def __hash__(self) -> int:
        return hash((self.keys.tobytes(), self.misses.tobytes()))

    @property
    def sparse(self) -> tuple[Keys, Misses]:
        """The two arrays, as the kernels take them."""
        return self.keys, self.misses

    def within(self, layers: int, cols: int, boxes: Iterable[tuple[Cell, Cell]]) -> SparseMisses:
        """Keep the cells of a grid of so many columns from the first to the last corner of any box."""
        row, col = np.divmod(self.keys // np.uint32(layers), np.uint32(cols))
        inside = np.zeros(len(row), np.bool_)
        for (row0, col0), (row1, col1) in boxes:
            inside |= (row0 <= row) & (row <= row1) & (col0 <= col) & (col <= col1)
        return self if inside.all() else SparseMisses(self.keys[inside], self.misses[inside])


class MissesCodec:
    """Log-misses as bytes: places layer by layer as gaps, log-misses apart, deflated.

    A place is ``layer * cells + cell``. Gaps start anew with each of ``runs`` equal parts of all places. The
    body: the number of entries in each run (``<u4``), all gaps in a byte each, all log-misses, and the gaps
    of 255 and more once again (``<u4``).
    """

    def __init__(self, cells: int, layers: int, *, runs: int, level: int) -> None:
        """Take the grid's size, the layers, and how hard to deflate (zlib's level)."""
        self._cells, self._layers, self._runs, self._level = cells, layers, runs, level
        self._places = cells * layers // runs  # of a run
        # two bytes an entry, four more a wide gap: a run's gaps sum to less than its places
        entries = min(runs * self._places, MOST_ENTRIES)
        self._largest = 4 * runs + 2 * entries + 4 * min(runs * (self._places // 255), entries)

    @property
    def bound(self) -> int:
        """Largest encoding of any impact over these cells and layers [bytes]; no team size in it."""
        return self._largest + 5 * (self._largest // 16383 + 1) + 64  # deflate at its worst

    def encode(self, impact: SparseMisses) -> bytes:
        """Return at most ``bound`` bytes."""
        layer = (impact.keys % self._layers).astype(np.min_scalar_type(self._layers))  # sorted by radix
        order = np.argsort(layer, kind="stable")
        cell = (impact.keys // self._layers)[order].astype(np.int64)
        run, place = np.divmod(layer[order].astype(np.int64) * self._cells + cell, self._places)
        counts = np.bincount(run, minlength=self._runs)
        gap = np.diff(place, prepend=0)
        first = _firsts(counts)
        gap[first] = place[first]
        small, wide = np.minimum(gap, 255).astype(np.uint8), gap[gap >= 255].astype("<u4")
        body = counts.astype("<u4").tobytes() + small.tobytes() + impact.misses[order].tobytes()
        return zlib.compress(body + wide.tobytes(), self._level, wbits=-15)

    def decode(self, payload: bytes) -> SparseMisses:
        """Return the impact.

        Raises:
            ValueError: the payload is not an impact over these cells and layers.
        """
        body, head = wire.inflate(payload, self._largest, "impact"), 4 * self._runs
        if len(body) < head:
            raise ValueError("impact is cut short or too large")
        counts = np.frombuffer(body, "<u4", self._runs).astype(np.int64)
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
        if total and (place.max() >= self._places or misses.min() == 0):
            raise ValueError("impact has a cell outside the map or an empty entry")
        gap[first] = 1
        if not gap.all():
            raise ValueError("impact has the same cell and layer twice")
        place += np.repeat(np.arange(self._runs) * self._places, counts)
        layer, cell = np.divmod(place, self._cells)
        keys = cell * self._layers + layer
        order = np.argsort(keys, kind="stable")
        return SparseMisses(keys[order].astype(np.uint32), misses[order])


def _firsts(counts: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the index of the first entry of each run that has any."""
    firsts: NDArray[np.int64] = (np.cumsum(counts) - counts)[counts > 0]
    return firsts

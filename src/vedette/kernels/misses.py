"""Sparse log-misses by cell and layer: the form in which impacts of looks are combined, priced and sent."""

from __future__ import annotations

import zlib
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vedette import _kernels, wire

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
        places = cells * layers // runs  # of a run
        # two bytes an entry, four more a wide gap: a run's gaps sum to less than its places
        entries = min(runs * places, MOST_ENTRIES)
        self._largest = 4 * runs + 2 * entries + 4 * min(runs * (places // 255), entries)

    @property
    def bound(self) -> int:
        """Largest encoding of any impact over these cells and layers [bytes]; no team size in it."""
        return self._largest + 5 * (self._largest // 16383 + 1) + 64  # deflate at its worst

    def encode(self, impact: SparseMisses) -> bytes:
        """Return at most ``bound`` bytes."""
        body = _kernels.pack_misses(*impact.sparse, self._cells, self._layers, self._runs)
        return zlib.compress(body, self._level, wbits=-15)

    def decode(self, payload: bytes) -> SparseMisses:
        """Return the impact.

        Raises:
            ValueError: the payload is not an impact over these cells and layers.
        """
        body = wire.inflate(payload, self._largest, "impact")
        return SparseMisses(*_kernels.unpack_misses(body, self._cells, self._layers, self._runs))

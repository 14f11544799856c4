"""Sparse log-misses by cell and layer: the form in which impacts of looks are combined, priced and sent."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from weakref import WeakValueDictionary

import numpy as np
from numpy.typing import NDArray

from vedette import _kernels

STEPS_PER_NAT = 16.0
MOST_ENTRIES = 1 << 24  # of an impact, whatever the grid; more are refused
CERTAIN = 255  # log-misses saturate here
_TABLES = 400  # at most, of an encoding: the number of runs and three tables [bytes]

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


# What was written in this process, as long as anybody holds it: robots simulated together read it once.
_WRITTEN: WeakValueDictionary[tuple[int, int, bytes], SparseMisses] = WeakValueDictionary()


class MissesCodec:
    """Log-misses as bytes: runs of equal ones, layer by layer, under prefix codes of their own.

    A place is ``layer * cells + cell``. A run is places in a row with one log-miss; gaps between runs, their
    lengths and log-misses have a code each (Huffman's), whose tables come first. What the bits are:
    ``rust/src/misses.rs``.
    """

    def __init__(self, cells: int, layers: int) -> None:
        """Take the grid's size and the layers."""
        self._cells, self._layers = cells, layers

    @property
    def bound(self) -> int:
        """Largest encoding of any impact over these cells and layers [bytes]; no team size in it."""
        places = self._cells * self._layers
        words = 3 * 12 * min(places, MOST_ENTRIES)  # bits, if every place were a run
        return _TABLES + (words + places) // 8  # gaps and lengths sum to less than all places

    def encode(self, impact: SparseMisses) -> bytes:
        """Return at most ``bound`` bytes."""
        data = _kernels.pack_misses(*impact.sparse, self._cells, self._layers)
        _WRITTEN[self._cells, self._layers, data] = impact
        return data

    def decode(self, payload: bytes) -> SparseMisses:
        """Return the impact.

        Raises:
            ValueError: the payload is not an impact over these cells and layers.
        """
        written = _WRITTEN.get((self._cells, self._layers, payload))
        if written is not None:
            return written
        return SparseMisses(*_kernels.unpack_misses(payload, self._cells, self._layers, MOST_ENTRIES))

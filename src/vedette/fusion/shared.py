"""Tiles of which equal ones are in memory once, whoever in this process holds them."""

from __future__ import annotations

import hashlib
from typing import Generic
from weakref import WeakValueDictionary

import numpy as np
from numpy.typing import NDArray

from vedette.kernels.tiles import CELLS, CellT

_SHARED: WeakValueDictionary[bytes, NDArray[np.generic]] = WeakValueDictionary()


class SharedTiles(Generic[CellT]):
    """Cells by tile; all that was never written is 0. Memory: those tiles, once for all who hold the same.

    So robots simulated in one process, each with a copy of what all the others have seen, hold it once.
    """

    def __init__(self, dtype: type[CellT]) -> None:
        self._dtype: type[CellT] = dtype
        self._tiles: dict[int, NDArray[CellT]] = {}  # (1024,) each, never changed

    @property
    def held(self) -> NDArray[np.int64]:
        """Tiles written to, increasing."""
        return np.sort(np.fromiter(self._tiles, np.int64, len(self._tiles)))

    def holds(self, tiles: NDArray[np.int64]) -> NDArray[np.bool_]:
        """Tell of which of these tiles there are cells, ``(T,)``."""
        if self._tiles.keys().isdisjoint(numbers := tiles.tolist()):
            return np.zeros(len(numbers), np.bool_)
        return np.array([tile in self._tiles for tile in numbers], np.bool_)

    def read(self, tiles: NDArray[np.int64]) -> NDArray[CellT]:
        """Return a copy of these tiles' cells, ``(T, 1024)``."""
        cells = np.zeros((len(tiles), CELLS), self._dtype)
        for row, tile in enumerate(tiles.tolist()):
            held = self._tiles.get(tile)
            if held is not None:
                cells[row] = held
        return cells

    def write(self, tiles: NDArray[np.int64], cells: NDArray[CellT]) -> None:
        """Replace the cells of these tiles, ``(T, 1024)``."""
        for tile, block in zip(tiles.tolist(), cells, strict=True):
            self._tiles[tile] = _shared(block)


def _shared(cells: NDArray[CellT]) -> NDArray[CellT]:
    key = hashlib.blake2b(cells.tobytes(), digest_size=16).digest()
    held = _SHARED.get(key)
    if held is None:
        held = _SHARED[key] = cells.copy()
        held.flags.writeable = False
    return held  # type: ignore[return-value]  # of so many bytes there is one type of cells

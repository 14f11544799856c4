"""Grids kept by tiles: what was never written costs no memory, however large the grid."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

SIDE = 32  # cells along a tile's side
CELLS = SIDE * SIDE

ALL = slice(None)

CellT = TypeVar("CellT", np.uint8, np.int8, np.uint16, np.int32)


@dataclass(frozen=True)
class Tiling:
    """A ``(rows, cols)`` grid cut into tiles of 32 x 32 cells, numbered row by row; edge tiles are padded."""

    rows: int
    cols: int

    @property
    def across(self) -> int:
        """Tiles in a row of tiles."""
        return -(-self.cols // SIDE)

    @property
    def count(self) -> int:
        """Number of tiles."""
        return self.across * -(-self.rows // SIDE)

    def holding(self, flat: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return the increasing ids of the tiles that hold these flat (row-major) cells."""
        return np.unique(self.split(flat)[0])

    def split(self, flat: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return the tile of each flat (row-major) cell, and the cell's place within it, 0..1023."""
        row, col = np.divmod(flat, self.cols)
        return row // SIDE * self.across + col // SIDE, row % SIDE * SIDE + col % SIDE

    def corners(self, tiles: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return row and column of the first cell of each tile."""
        row, col = np.divmod(tiles, self.across)
        return row * SIDE, col * SIDE

    def inside(self, tiles: NDArray[np.int64]) -> NDArray[np.bool_]:
        """Return ``(len(tiles), 1024)``: which cells of the padded tiles lie in the grid."""
        top, left = self.corners(tiles)
        rows = top[:, None] + np.arange(SIDE) < self.rows
        cols = left[:, None] + np.arange(SIDE) < self.cols
        return (rows[:, :, None] & cols[:, None, :]).reshape(-1, CELLS)


class TiledGrid(Generic[CellT]):
    """A grid that holds the tiles that were written to; all other cells are 0.

    ``slots`` ``(tiles,)`` says where a tile's cells are in ``blocks`` ``(S, 1024)``; 0 is the blank tile,
    which is never written. Memory: the tiles held and as many to grow into, 4 bytes a tile of the grid.
    """

    def __init__(self, tiling: Tiling, dtype: type[CellT]) -> None:
        self.tiling = tiling
        self.slots: NDArray[np.int32] = np.zeros(tiling.count, np.int32)
        self.blocks: NDArray[CellT] = np.zeros((1, CELLS), dtype)
        self._ids: NDArray[np.int64] = np.zeros(1, np.int64)  # (S,) of the tile in each slot
        self._used = 1  # slots, the blank one included

    @classmethod
    def of(cls, grid: NDArray[CellT]) -> TiledGrid[CellT]:
        """Return a grid that holds these cells, ``(rows, cols)``, wherever they are not 0."""
        tiled = cls(Tiling(*grid.shape), grid.dtype.type)
        cells = np.flatnonzero(grid)
        tiled.put(cells, grid.ravel()[cells])
        return tiled

    @property
    def held(self) -> NDArray[np.int64]:
        """Tiles written to, in the order in which they were first; ``slots`` of the k-th is k + 1."""
        return self._ids[1 : self._used]

    def read(self, tiles: NDArray[np.int64]) -> NDArray[CellT]:
        """Return a copy of these tiles' cells, ``(T, 1024)``."""
        cells: NDArray[CellT] = self.blocks[self.slots[tiles]]
        return cells

    def write(self, tiles: NDArray[np.int64], cells: NDArray[CellT]) -> None:
        """Replace the cells of these tiles, each given once, ``(T, 1024)``."""
        slots = self.claim(tiles)
        self.blocks[slots] = cells

    def take(self, flat: NDArray[np.int64]) -> NDArray[CellT]:
        """Return some cells by their flat (row-major) indices."""
        tiles, places = self.tiling.split(flat)
        cells: NDArray[CellT] = self.blocks[self.slots[tiles], places]
        return cells

    def put(self, flat: NDArray[np.int64], values: NDArray[CellT]) -> None:
        """Replace some cells by their flat (row-major) indices."""
        tiles, places = self.tiling.split(flat)
        self.claim(np.unique(tiles))
        self.blocks[self.slots[tiles], places] = values

    def window(self, rows: slice = ALL, cols: slice = ALL) -> NDArray[CellT]:
        """Return a copy of some rows and columns, ``(R, C)``; those beyond the grid are left out."""
        first_row, end_row, _ = rows.indices(self.tiling.rows)
        first_col, end_col, _ = cols.indices(self.tiling.cols)
        top, left = first_row // SIDE, first_col // SIDE
        part = self.slots.reshape(-1, self.tiling.across)[
            top : -(-end_row // SIDE), left : -(-end_col // SIDE)
        ]
        grid = self.blocks[part].reshape(*part.shape, SIDE, SIDE).transpose(0, 2, 1, 3)
        whole = grid.reshape(part.shape[0] * SIDE, part.shape[1] * SIDE)
        row, col = first_row - top * SIDE, first_col - left * SIDE
        return np.ascontiguousarray(whole[row : row + end_row - first_row, col : col + end_col - first_col])

    def claim(self, tiles: NDArray[np.int64]) -> NDArray[np.int32]:
        """Return the slots of these tiles, each given once; those not held yet get one, blank."""
        fresh = tiles[self.slots[tiles] == 0]
        if len(fresh):
            end = self._used + len(fresh)
            self._make_room(end)
            self.slots[fresh] = np.arange(self._used, end)
            self._ids[self._used : end] = fresh
            self._used = end
        slots: NDArray[np.int32] = self.slots[tiles]
        return slots

    def _make_room(self, slots: int) -> None:
        if slots <= len(self.blocks):
            return
        room = max(slots, 2 * len(self.blocks))
        blocks, ids = np.zeros((room, CELLS), self.blocks.dtype), np.zeros(room, np.int64)
        blocks[: self._used], ids[: self._used] = self.blocks[: self._used], self._ids[: self._used]
        self.blocks, self._ids = blocks, ids

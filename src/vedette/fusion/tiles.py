"""Shared evidence: five levels a cell, their exact sum over robots, and the team map it shows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vedette.fusion.digest import Digest, fingerprint
from vedette.maps import FREE, OCCUPIED, UNKNOWN
from vedette.maps.bounds import Bounds, Extent

SIDE = 32  # cells along a tile's side
CELLS = SIDE * SIDE
FIRM = 6  # |log-odds| from which evidence is firm [units of the robot's own int8 grid]
MOST_ROBOTS = 2047  # per cell, that a packed sum can hold

# Codes are ordered so that the maximum of two is the stronger one, occupied winning ties.
LEVELS: NDArray[np.int32] = np.array([0, -1, 1, -2, 2], dtype=np.int32)  # level of a code
_COUNT = 1 << 16
WORDS: NDArray[np.int32] = LEVELS + _COUNT * (LEVELS != 0).astype(np.int32)  # packed sum of one code
CLASSES: NDArray[np.uint8] = np.array([UNKNOWN, FREE, OCCUPIED, FREE, OCCUPIED], dtype=np.uint8)


def codes_of(log_odds: NDArray[np.int8]) -> NDArray[np.uint8]:
    """Return the code 0..4 of each cell: nothing, weakly free, weakly occupied, firmly free, firmly occupied.

    Only the sign and whether ``|log_odds| >= FIRM`` are shared; any shape in, the same shape out.
    """
    firm = (log_odds >= FIRM) | (log_odds <= -FIRM)
    codes = 1 + (log_odds > 0).astype(np.uint8) + 2 * firm.astype(np.uint8)
    return np.where(log_odds == 0, 0, codes).astype(np.uint8)


def sums_of(words: NDArray[np.int32]) -> NDArray[np.int32]:
    """Return the sum of levels in packed sums ``word = sum + 65536 * contributors``."""
    return words.astype(np.int16).astype(np.int32)


def contributors_of(words: NDArray[np.int32]) -> NDArray[np.int32]:
    """Return how many robots contributed to each packed sum."""
    robots: NDArray[np.int32] = (words - sums_of(words)) >> 16
    return robots


def saturated(words: NDArray[np.int32]) -> NDArray[np.int32]:
    """Return packed sums with at most ``MOST_ROBOTS`` contributors; sane sums are returned unchanged.

    More arise only where sums run in a circle, and must not spill into neighbouring bits.
    """
    if words.size == 0 or (words.min() >= 0 and words.max() < MOST_ROBOTS * _COUNT):
        return words
    robots = np.clip(contributors_of(words), 0, MOST_ROBOTS)
    return (np.clip(sums_of(words), -2 * robots, 2 * robots) + robots * _COUNT).astype(np.int32)


def classes_of(words: NDArray[np.int32]) -> NDArray[np.uint8]:
    """Return each cell's class: the sign of the sum; a tie between robots is kept safe as occupied."""
    known = np.where(words.astype(np.int16) < 0, np.uint8(FREE), np.uint8(OCCUPIED))
    return np.where(words == 0, np.uint8(UNKNOWN), known)


def code_of_sums(words: NDArray[np.int32]) -> NDArray[np.uint8]:
    """Return the code 0..4 nearest to each packed sum: its sign, firm from two units on."""
    sums = sums_of(words)
    codes = 1 + (sums >= 0).astype(np.uint8) + 2 * (np.abs(sums) >= 2).astype(np.uint8)
    return np.where(words == 0, 0, codes).astype(np.uint8)


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
        row, col = np.divmod(flat, self.cols)
        return np.unique(row // SIDE * self.across + col // SIDE)

    def gather(self, grid: NDArray[np.int8], tiles: NDArray[np.int64]) -> NDArray[np.int8]:
        """Return ``(len(tiles), 1024)``: the grid's tiles, zero outside the grid."""
        blocks = np.zeros((len(tiles), SIDE, SIDE), dtype=grid.dtype)
        for block, tile in zip(blocks, tiles.tolist(), strict=True):
            part = grid[self._window(tile)]
            block[: part.shape[0], : part.shape[1]] = part
        return blocks.reshape(-1, CELLS)

    def paint(self, grid: NDArray[np.uint8], tile: int, block: NDArray[np.uint8]) -> None:
        """Write one tile's ``(1024,)`` cells into the grid, leaving out what lies outside."""
        part = grid[self._window(tile)]
        part[:] = block.reshape(SIDE, SIDE)[: part.shape[0], : part.shape[1]]

    def inside(self, tiles: NDArray[np.int64]) -> NDArray[np.bool_]:
        """Return ``(len(tiles), 1024)``: which cells of the padded tiles lie in the grid."""
        top, left = np.divmod(tiles, self.across)
        offsets = np.arange(SIDE)
        rows = top[:, None] * SIDE + offsets < self.rows
        cols = left[:, None] * SIDE + offsets < self.cols
        return (rows[:, :, None] & cols[:, None, :]).reshape(-1, CELLS)

    def _window(self, tile: int) -> tuple[slice, slice]:
        row, col = divmod(tile, self.across)
        return slice(row * SIDE, (row + 1) * SIDE), slice(col * SIDE, (col + 1) * SIDE)


class TeamMap:
    """The team's classes and counts as one robot knows them, with a digest kept up tile by tile."""

    def __init__(self, tiling: Tiling, counts_size: int) -> None:
        self.classes: NDArray[np.uint8] = np.zeros((tiling.rows, tiling.cols), dtype=np.uint8)
        self.counts: NDArray[np.int64] = np.zeros(counts_size, dtype=np.int64)
        self._tiling = tiling
        self._shown: NDArray[np.uint8] = np.zeros((tiling.count, CELLS), dtype=np.uint8)
        self._digest = Digest()  # of the tiles
        self._bounds = Bounds()  # of the tiles shown

    @property
    def known(self) -> Extent:
        """Rows and columns outside of which nothing is known; not necessarily the narrowest."""
        return self._bounds.extent

    def show(self, tiles: NDArray[np.int64], classes: NDArray[np.uint8]) -> NDArray[np.int64]:
        """Put ``(len(tiles), 1024)`` classes on the map; return the tiles that changed."""
        changed = np.flatnonzero((self._shown[tiles] != classes).any(axis=1))
        for index in changed.tolist():
            tile, block = int(tiles[index]), classes[index]
            self._shown[tile] = block
            self._tiling.paint(self.classes, tile, block)
            self._digest.put(tile, block.tobytes() if block.any() else b"")
        rows, cols = np.divmod(tiles[changed], self._tiling.across)
        self._bounds.widen(rows * SIDE, cols * SIDE)
        self._bounds.widen(
            np.minimum(rows * SIDE + SIDE, self._tiling.rows) - 1,
            np.minimum(cols * SIDE + SIDE, self._tiling.cols) - 1,
        )
        return tiles[changed]

    @property
    def digest(self) -> int:
        """64 bits, equal (up to 2^-64) for two robots iff their classes and counts are equal."""
        if not self.counts.any():
            return self._digest.value
        return self._digest.value ^ fingerprint(self.counts.astype("<i8").tobytes(), self._tiling.count)

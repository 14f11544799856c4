"""Shared evidence: five levels a cell, their exact sum over robots, and the team map it shows."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vedette.fusion.digest import Digest, fingerprint
from vedette.kernels.tiles import SIDE, TiledGrid, Tiling
from vedette.maps import FREE, OCCUPIED, UNKNOWN
from vedette.maps.bounds import Bounds, Extent

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


class TeamMap:
    """The team's classes and counts as one robot knows them, with a digest kept up tile by tile.

    ``mark`` stands in the digest for what else two robots must agree on, such as where the cells lie.
    """

    def __init__(self, tiling: Tiling, counts_size: int, mark: int) -> None:
        self.classes: TiledGrid[np.uint8] = TiledGrid(tiling, np.uint8)
        self.counts: NDArray[np.int64] = np.zeros(counts_size, dtype=np.int64)
        self._tiling = tiling
        self._mark = mark
        self._digest = Digest()  # of the tiles
        self._bounds = Bounds()  # of the tiles shown

    @property
    def known(self) -> Extent:
        """Rows and columns outside of which nothing is known; not necessarily the narrowest."""
        return self._bounds.extent

    def show(self, tiles: NDArray[np.int64], classes: NDArray[np.uint8]) -> NDArray[np.int64]:
        """Put ``(len(tiles), 1024)`` classes on the map; return the tiles that changed."""
        differs = (self.classes.read(tiles) != classes).any(axis=1)
        changed: NDArray[np.int64] = tiles[differs]
        fresh = classes[differs]
        self.classes.write(changed, fresh)
        for tile, block in zip(changed.tolist(), fresh, strict=True):
            self._digest.put(tile, block.tobytes() if block.any() else b"")
        rows, cols = self._tiling.corners(changed)
        self._bounds.widen(rows, cols)
        self._bounds.widen(
            np.minimum(rows + SIDE, self._tiling.rows) - 1, np.minimum(cols + SIDE, self._tiling.cols) - 1
        )
        return changed

    @property
    def digest(self) -> int:
        """64 bits, equal (up to 2^-64) for two robots iff their classes, counts and marks are equal."""
        digest = self._digest.value ^ self._mark
        if not self.counts.any():
            return digest
        return digest ^ fingerprint(self.counts.astype("<i8").tobytes(), self._tiling.count)

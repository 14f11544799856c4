"""An old map of the building: what it says of what nobody has seen yet, as far as it has proved right."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
import scipy
from numpy.typing import NDArray

from vedette.domains.mapping.impact import MIN_SHARE
from vedette.kernels.components import components
from vedette.maps import FREE, OCCUPIED, UNKNOWN, GridFrame
from vedette.maps.laid import laid

SAME_WALL = 0.15  # a wall that is seen so near one of the old map is that one [m]
NEAR = 1.5  # along either axis, what was found right or wrong speaks for what is so near [m]
BELIEVED = 20  # cells of wall that an old map counts as confirmed by before anybody has seen anything
LOCALLY = 20  # cells of wall that what was found elsewhere counts for in a place
WEIGHT_OF_WRONG = 3  # a cell found wrong counts as so many found right

# What looks reveal: starts (K + 1,) of each look's entries, planning cells of the window (M,), shares (M,).
Shares: TypeAlias = tuple[NDArray[np.int64], NDArray[np.uint32], NDArray[np.float32]]


@dataclass(frozen=True, eq=False)
class PriorMap:
    """An old map on cells of the team's grid."""

    classes: NDArray[np.uint8]  # (r, c) FREE or OCCUPIED, UNKNOWN where it has nothing to say
    frame: GridFrame  # of these cells, team frame

    @classmethod
    def of(cls, classes: NDArray[np.uint8], frame: GridFrame) -> PriorMap:
        """Take a map as it was saved; what it does not know, nearer to a wall than to free ground, is solid.

        That is the inside of walls, and what lies behind them; where free ground ends without a wall, whoever
        made the map had not been there.
        """
        known = classes != UNKNOWN
        nearest = scipy.ndimage.distance_transform_edt(~known, return_distances=False, return_indices=True)
        solid = ~known & (classes[tuple(nearest)] == OCCUPIED)
        return cls(np.where(solid, np.uint8(OCCUPIED), classes), frame)

    @property
    def identity(self) -> int:
        """64 bits that are equal for equal old maps."""
        cells = hashlib.blake2b(repr(self.frame).encode(), digest_size=8)
        cells.update(self.classes.tobytes())
        return int.from_bytes(cells.digest(), "little")


@dataclass(frozen=True, eq=False)
class Foresight:
    """What an old map lets a team expect of the unknown cells in a window.

    With probability ``trust`` the map is right about a planning cell: looks then end at its walls, pass over
    its free cells, and only these are to be seen. Otherwise it says nothing.  docs/mapping.md (V160)
    """

    classes: NDArray[np.uint8]  # (R, C) as if the map were right: UNKNOWN is what then can be seen
    seeable: NDArray[np.uint16]  # (r, c) cells of each planning cell that can be seen if it is
    trust: NDArray[np.float32]  # (r, c) 0..1

    def expected(self, unknown: NDArray[np.uint16]) -> NDArray[np.float32]:
        """Return ``(r, c)`` how many of the unknown cells there are to be seen, on average."""
        return self.trust * self.seeable + (1 - self.trust) * unknown

    def mean(self, plain: Shares, right: Shares, unknown: NDArray[np.uint16]) -> Shares:
        """Return what looks reveal on average, as shares of `expected`.

        Args:
            plain: shares of the unknown cells that they reveal if the map says nothing.
            right: shares of the seeable cells that they reveal if it is right.
            unknown: (r, c) unknown cells of each planning cell.
        """
        trust, expected = self.trust.ravel(), self.expected(unknown).ravel()
        looks, size = len(plain[0]) - 1, len(trust)
        keys, cells = [], []
        for (starts, seen, shares), weight in (
            (plain, (1 - trust) * unknown.ravel()),
            (right, trust * self.seeable.ravel()),
        ):
            keys.append(np.repeat(np.arange(looks), np.diff(starts)) * size + seen)
            cells.append(shares * weight[seen])
        distinct, where = np.unique(np.concatenate(keys), return_inverse=True)
        look, seen = np.divmod(distinct, size)
        share = np.bincount(where, np.concatenate(cells), len(distinct)) / np.maximum(expected[seen], 1e-6)
        kept = share >= MIN_SHARE
        starts = np.searchsorted(look[kept], np.arange(looks + 1))
        return starts, seen[kept].astype(np.uint32), share[kept].astype(np.float32)


def foresee(classes: NDArray[np.uint8], frame: GridFrame, factor: int, prior: PriorMap) -> Foresight | None:
    """Return what an old map lets expect in a window; None if it has nothing to say there.

    Args:
        classes: (R, C) the team map in the window.
        frame: of the window.
        factor: side of a planning cell [cells].
        prior: the old map.
    """
    said = laid(prior.classes, prior.frame, frame)
    return as_told(classes, said, trust(classes, said, frame.resolution), factor)


def as_told(
    classes: NDArray[np.uint8], said: NDArray[np.uint8], believed: Any, factor: int
) -> Foresight | None:
    """Return what follows for the unknown from what is said of it; None if nothing is.

    Args:
        classes: (R, C) the team map in the window.
        said: (R, C) FREE or OCCUPIED, UNKNOWN where nothing is said.
        believed: (R, C), or for all of it, with what probability that is right.
        factor: side of a planning cell [cells].
    """
    unseen = classes == UNKNOWN
    told = unseen & (said != UNKNOWN)
    if not told.any():
        return None
    parts = components((classes == FREE) | (unseen & (said == FREE)))
    reached = np.isin(parts, np.unique(parts[classes == FREE])) & (parts >= 0)
    right = np.where(told & ~reached, np.uint8(OCCUPIED), classes)
    unknown = block_sum(unseen, factor)
    share = block_sum(np.where(told, believed, 0.0), factor) / np.maximum(unknown, 1)
    seeable = block_sum(right == UNKNOWN, factor)
    return Foresight(right, seeable.astype(np.uint16), share.astype(np.float32))


def trust(classes: NDArray[np.uint8], said: NDArray[np.uint8], resolution: float) -> NDArray[np.float64]:
    """Return ``(R, C)`` with what probability an old map is right about each cell.

    ``t(s) = (c(s) + k T) / (c(s) + k + 3 x(s))``, ``T = (c + k) / (c + k + 3 x)``, with *c* the cells of wall
    that were seen where it has one, *x* those seen where it has none and the free ones seen where it has a
    wall, within 1.5 m of the cell, and in all; k = 20.  docs/mapping.md (V161)

    Args:
        classes: (R, C) the team map.
        said: (R, C) the old map.
        resolution: cell side [m].
    """
    beside = 2 * max(1, round(SAME_WALL / resolution)) + 1
    wall, old_wall = classes == OCCUPIED, said == OCCUPIED
    by_old = scipy.ndimage.maximum_filter(old_wall, beside)
    by_wall = scipy.ndimage.maximum_filter(wall, beside)
    confirmed = wall & by_old
    wrong = (wall & ~by_old & (said == FREE)) | ((classes == FREE) & old_wall & ~by_wall)
    overall = _share(confirmed.sum(), wrong.sum(), BELIEVED, 1.0)
    around = round(NEAR / resolution)
    return np.asarray(_share(_box_sum(confirmed, around), _box_sum(wrong, around), LOCALLY, overall))


def _share(right: Any, wrong: Any, weight: float, before: Any) -> Any:
    return (right + weight * before) / (right + weight + WEIGHT_OF_WRONG * wrong)


def _box_sum(cells: NDArray[np.bool_], reach: int) -> NDArray[np.int64]:
    """Count the cells within a square about each."""
    total = cells.astype(np.int64)
    for axis in (0, 1):
        sums = np.cumsum(total, axis=axis)
        size = sums.shape[axis]
        ends = np.minimum(np.arange(size) + reach, size - 1)
        starts = np.arange(size) - reach - 1
        before = np.take(sums, np.maximum(starts, 0), axis=axis)
        inside = starts >= 0
        total = np.take(sums, ends, axis=axis) - before * (inside[:, None] if axis == 0 else inside)
    return total


def block_sum(cells: NDArray[Any], factor: int) -> NDArray[Any]:
    """Add up what lies in each planning cell of ``factor x factor`` cells."""
    rows, cols = cells.shape
    padded = np.pad(cells, ((0, -rows % factor), (0, -cols % factor)))
    shape = padded.shape[0] // factor, padded.shape[1] // factor
    total = np.zeros(shape, np.float64 if cells.dtype == np.float64 else np.uint16)
    for row in range(factor):
        for col in range(factor):
            total += padded[row::factor, col::factor]
    return total

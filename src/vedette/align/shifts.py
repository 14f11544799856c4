"""Where B may lie on A, from all angles and shifts: the correlation of their walls, in large cells."""

from __future__ import annotations

import math

import numpy as np
import scipy
from numpy.typing import NDArray

from vedette.align.charted import Charted
from vedette.align.pose import FramePose
from vedette.kernels.align import QUARTERS, Weights, align_peaks

WEIGHTS = Weights(walls=1.0, clash=0.6, free=0.03)
BESIDE = 0.5  # a wall counts in the cells beside it [of a wall]
SMALLEST, LARGEST = 0.25, 0.4  # sides of the large cells: in larger ones walls fill all ground [m]
CELLS_ALONG = 384  # large cells on a side of both maps together, as far as `LARGEST` allows
TURN_AT_THE_END = 1.25  # large cells that the end of a map moves between two angles
LEAST_TURN, MOST_TURN = math.radians(1.5), math.radians(3.0)
FRINGE = 2.0  # so much of both that lies on each other as on the torus alone does no harm [m]
PARALLEL = 0.6  # walls that are parallel at an angle, of those at the best, for the angle to be looked at
QUARTER = 64  # in 1/256 of a turn, as faces look
_BLUR = 1.5  # of how faces look [1/256 of a turn]
PEAKS = 6  # of each angle
APART = 1.0  # peaks of one angle, at least [m]


def likely(a: Charted, b: Charted, most: int) -> list[FramePose]:
    """Return the places of B's middle from A's middle, with B's angle, that count most by (V140).

    Of places within `APART` and two angles of each other the best stands for all.
    """
    both = a.side + 2.0 * b.radius - FRINGE
    cell = max(min(max(SMALLEST, both / CELLS_ALONG), LARGEST), 2.0 * a.cell, 2.0 * b.cell)
    size = int(scipy.fft.next_fast_len(math.ceil(max(both, a.side, 2.0 * b.radius) / cell) + 4))
    turn = min(max(TURN_AT_THE_END * cell / (b.side / 2.0), LEAST_TURN), MOST_TURN)
    turns = math.ceil(math.pi / 2.0 / turn)
    angles = _parallel(a, b, np.linspace(0.0, math.pi / 2.0, turns, endpoint=False))
    spacing = max(1, round(APART / cell))
    points = (b.walls / cell, b.free / cell)
    found = align_peaks(_torus(a, cell, size), points, angles, WEIGHTS, PEAKS, spacing)
    worth, row, col = np.moveaxis(found, -1, 0)
    quarter = np.linspace(0.0, 2.0 * math.pi, QUARTERS, endpoint=False)[:, None]
    angle = np.broadcast_to(angles[:, None, None] + quarter, worth.shape)
    order = np.argsort(-worth, axis=None, kind="stable")
    order = order[np.isfinite(worth.ravel()[order])]
    x, y = (_unwrapped(k.ravel()[order], size, round(a.side / cell)) * cell for k in (col, row))
    left, low = (a.corner + cell / 2.0).tolist()
    places = np.stack([x + left, y + low, angle.ravel()[order]], axis=1)
    return [FramePose.of(*place) for place in _distinct(places, 2.5 * turn, most).tolist()]


def _torus(a: Charted, cell: float, size: int) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return A's walls, lower beside them, and free ground away from them, ``(size, size)`` large cells."""
    walls, free = np.zeros((size, size), np.float32), np.zeros((size, size), np.float32)
    for mask, points in ((walls, a.walls), (free, a.free)):
        col, row = np.floor((points - a.corner) / cell).astype(int).T
        mask[row, col] = 1.0
    beside = scipy.ndimage.maximum_filter(walls, size=3, mode="wrap")
    free[beside > 0.0] = 0.0
    return np.maximum(walls, BESIDE * beside, dtype=np.float32), free


def _parallel(a: Charted, b: Charted, angles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return those of the angles at which many walls of B are parallel, or at right angles, to walls of A.

    Each angle stands for its quarter turns too.
    """
    of_a, of_b = (
        scipy.ndimage.gaussian_filter1d(
            np.bincount(each.looks % QUARTER, minlength=QUARTER).astype(np.float64), _BLUR, mode="wrap"
        )
        for each in (a, b)
    )
    by_turn = np.array([of_a @ np.roll(of_b, turn) for turn in range(QUARTER + 1)])
    found = np.interp(angles * (QUARTER / (math.pi / 2.0)), np.arange(QUARTER + 1), by_turn)
    kept: NDArray[np.float64] = angles[found >= PARALLEL * found.max()]
    return kept


def _unwrapped(index: NDArray[np.float64], size: int, side: int) -> NDArray[np.float64]:
    """Return shifts on the torus as what they are: half of what A leaves of it lies before A, half after."""
    return np.where(index > (size + side) / 2.0, index - size, index)


def _distinct(places: NDArray[np.float64], turn: float, most: int) -> NDArray[np.float64]:
    """Return the first places that are apart from all before them in shift or angle."""
    kept: list[int] = []
    for number, (x, y, angle) in enumerate(places):
        near = places[kept]
        beside = np.hypot(near[:, 0] - x, near[:, 1] - y) < APART
        aside = np.abs((near[:, 2] - angle + math.pi) % (2.0 * math.pi) - math.pi)
        if not (beside & (aside < turn)).any():
            kept.append(number)
            if len(kept) == most:
                break
    return places[kept]

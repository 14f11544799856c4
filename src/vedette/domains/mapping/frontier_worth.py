"""What a frontier is worth beyond the unknown cells that a scan from it may reveal."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vedette.domains.mapping.sightings import measured_model
from vedette.maps import FREE, UNKNOWN, GridFrame

NEIGHBOURS = 5  # a frontier with so many others near by will be passed again
FARTHEST = 15.0  # being farther from others than this makes no more difference [m]
BEHIND = 1.0  # what is seen so far into the unknown tells whether a frontier leads on [m]


def frontier_areas(
    frame: GridFrame, cells: NDArray[np.int64], starts: NDArray[np.int64], hidden: float, return_price: float
) -> NDArray[np.float64]:
    """``A_f = hidden + return_price * d_f``: area behind a frontier, and the price of coming back for it.

    ``d_f`` is the distance to the fifth nearest other frontier, at most 15 m: a scrap left in a corner that
    is otherwise finished costs a way back of about that length, one among many nothing.
    docs/mapping.md (V24)

    Args:
        frame: of the window.
        cells, starts: frontiers as ``find_frontiers`` returns them.
        hidden: area expected behind any frontier [m^2].
        return_price: [m^2 a metre].

    Returns:
        (K,) area that each frontier stands for [m^2].
    """
    count = len(starts) - 1
    if return_price == 0.0 or count == 0:
        return np.full(count, hidden, np.float64)
    if count <= NEIGHBOURS:
        return np.full(count, hidden + return_price * FARTHEST)
    places = middles(frame, cells, starts)
    apart = np.hypot(*(places[:, None] - places).transpose(2, 0, 1))
    fifth: NDArray[np.float64] = np.partition(apart, NEIGHBOURS, axis=1)[:, NEIGHBOURS]
    return np.asarray(hidden + return_price * np.minimum(fifth, FARTHEST))


def middles(frame: GridFrame, cells: NDArray[np.int64], starts: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return ``(K, 2)`` x, y [m] of the middle of each frontier's cells."""
    count = len(starts) - 1
    owner = np.repeat(np.arange(count), np.diff(starts))
    sums = np.column_stack([np.bincount(owner, axis, minlength=count) for axis in frame.centres(cells).T])
    return np.asarray(sums / np.diff(starts)[:, None])


def spread_behind(
    classes: NDArray[np.uint8],
    cells: NDArray[np.int64],
    starts: NDArray[np.int64],
    areas: NDArray[np.float64],
    factor: int,
) -> NDArray[np.float32]:
    """Share each frontier's area among the planning cells of the unknown cells that touch it.

    Returns:
        (r, c) area carried by each planning cell of ``factor x factor`` cells, in the unit of ``areas``.
    """
    touched, owner = touching(classes, cells, starts, factor)
    share = areas[owner] / np.bincount(owner, minlength=len(starts) - 1)[owner]
    rows, cols = classes.shape
    shape = (-(-rows // factor), -(-cols // factor))
    return np.bincount(touched, share, minlength=shape[0] * shape[1]).reshape(shape).astype(np.float32)


def leads_on(
    classes: NDArray[np.uint8],
    berths: NDArray[np.uint8],
    frontiers: tuple[NDArray[np.int64], NDArray[np.int64]],
    counts: NDArray[np.int64],
    resolution: float,
) -> NDArray[np.float64]:
    """``q_f``: how likely cells 1 m behind a frontier are seen, against where most are.

    The mean over the unknown cells that touch it, by the team's sightings of their berth: gaps in walls that
    were seen aslant lead nowhere.  docs/mapping.md (V241)

    Args:
        classes: (R, C) of the window.
        berths: (R, C) of its cells.
        frontiers: cells and starts as ``find_frontiers`` returns them.
        counts: (ROWS, BINS) the team's sightings.
        resolution: cell side [m].

    Returns:
        (K,) 0..1.
    """
    at = round(BEHIND / resolution)
    seen = measured_model(counts, resolution, at, by_distance=False).table[:, at].astype(np.float64)
    row, col, owner = _beside(classes, *frontiers)
    shares = (seen / seen.max())[berths[row, col]]
    count = len(frontiers[1]) - 1
    return np.bincount(owner, shares, count) / np.bincount(owner, minlength=count)


def touching(
    classes: NDArray[np.uint8], cells: NDArray[np.int64], starts: NDArray[np.int64], factor: int
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the flat planning cell of each unknown cell beside a frontier, and which frontier it is."""
    row, col, owner = _beside(classes, cells, starts)
    return row // factor * -(-classes.shape[1] // factor) + col // factor, owner


def _beside(
    classes: NDArray[np.uint8], cells: NDArray[np.int64], starts: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """Return row and column of each unknown cell beside a frontier's cell, and which frontier it is."""
    padded = np.pad(classes, 1, constant_values=FREE)
    row, col = np.divmod(cells, classes.shape[1])
    r = row[:, None] + np.array([-1, 1, 0, 0])
    c = col[:, None] + np.array([0, 0, -1, 1])
    touches = padded[r + 1, c + 1] == UNKNOWN
    cluster = np.repeat(np.arange(len(starts) - 1), np.diff(starts))
    owner = np.broadcast_to(cluster[:, None], touches.shape)[touches]
    return r[touches], c[touches], owner

"""What looks promise where the robot has a sensor of somebody's own in the place of a lidar."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vedette.domains.mapping.belief import MapBelief
from vedette.domains.mapping.impact import MIN_SHARE
from vedette.sensor import CheckedSensor


def as_seen(
    sensor: CheckedSensor,
    belief: MapBelief,
    seen: tuple[NDArray[np.int64], NDArray[np.uint32], NDArray[np.float32]],
    views: NDArray[np.int64],
    toward: NDArray[np.float64],
) -> tuple[NDArray[np.int64], NDArray[np.uint32], NDArray[np.float32]]:
    """Return what a lidar would show as an own sensor does that looks from the same places.

    Args:
        sensor: whose it is.
        belief: of the round.
        seen: starts (K + 1,), planning cells of the window (M,), shares of them (M,).
        views: (K,) cells.
        toward: (K,) where the robot faces there [rad].
    """
    starts, cells, shares = seen
    sizes, cols = np.diff(starts), belief.unknown.shape[1]
    row, col = np.divmod(cells.astype(np.int64), cols)
    middle = (np.stack((col, row)) + 0.5) * belief.planning.resolution
    view_row, view_col = np.divmod(np.repeat(views, sizes), belief.frame.cols)
    x, y = middle - (np.stack((view_col, view_row)) + 0.5) * belief.frame.resolution
    bearing = np.arctan2(y, x) - np.repeat(toward, sizes)
    likely = sensor.sees(np.hypot(x, y), np.remainder(bearing + np.pi, 2.0 * np.pi) - np.pi)
    less = (shares * likely).astype(np.float32)
    kept = less >= MIN_SHARE
    ends = np.concatenate(([0], np.cumsum(kept)))
    return ends[starts], cells[kept], less[kept]

"""What a robot's stops would show, on the plane of a round."""

from __future__ import annotations

import numpy as np

from vedette.kernels.coverage import Footprints
from vedette.maps import GridFrame
from vedette.maps.transform import IDENTITY, Transform

_PARTS = 2  # places a side of a planning cell that say which cells of the plane it lies on


def on_plane(footprints: Footprints, planning: GridFrame, there: Transform) -> Footprints:
    """Return footprints over planning cells of a robot's own frame as those of the plane's.

    A cell of the plane is as surely seen as that one of those that lie on it that is most so.

    Args:
        footprints: of the robot's stops.
        planning: where planning cells lie, in either frame about its origin.
        there: T_plane_own.
    """
    if there == IDENTITY:
        return footprints
    middles = planning.centres(footprints.cells.astype(np.int64))
    beside = ((np.arange(_PARTS) + 0.5) / _PARTS - 0.5) * planning.resolution
    x, y = np.meshgrid(beside, beside)
    points = middles[:, None] + np.column_stack((x.ravel(), y.ravel()))
    moved = there.places(points.reshape(-1, 2))
    col = np.floor((moved[:, 0] - planning.origin_x) / planning.resolution).astype(np.int64)
    row = np.floor((moved[:, 1] - planning.origin_y) / planning.resolution).astype(np.int64)
    inside = (row >= 0) & (row < planning.rows) & (col >= 0) & (col < planning.cols)
    stops = np.repeat(np.arange(len(footprints.starts) - 1), np.diff(footprints.starts))
    keys = (np.repeat(stops, _PARTS**2) * planning.size + row * planning.cols + col)[inside]
    misses = np.repeat(footprints.misses, _PARTS**2)[inside]
    order = np.argsort(keys, kind="stable")
    keys, misses = keys[order], misses[order]
    first = np.flatnonzero(np.diff(keys, prepend=-1))
    most = np.maximum.reduceat(misses, first) if len(first) else misses
    of, cells = np.divmod(keys[first], planning.size)
    starts = np.searchsorted(of, np.arange(len(footprints.starts)))
    return Footprints(starts.astype(np.int64), cells.astype(np.uint32), most)

"""How much of what two maps have in common is more than a few straight lines: many halls have those."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from vedette.align.charted import Charted
from vedette.align.pose import FramePose
from vedette.kernels.align import SAME

Floats = NDArray[np.float64]

THICK = 0.3  # a wall along a line is as near to it as this [m]
ALIKE = math.cos(math.radians(30.0))  # and looks so nearly the same way
TRIED = 200  # walls that a line is drawn along


def beside_lines(a: Charted, b: Charted, pose: FramePose, lines: int) -> float:
    """Return the walls of B that lie on A's, but for those along the lines with most of them [m].

    Args:
        a: the map on which the other lies.
        b: the other.
        pose: of B's own frame in A's own.
        lines: how many are left out.
    """
    col, row = np.floor((pose.places(b.middle + b.walls) - a.middle - a.corner) / a.cell).astype(np.int64).T
    inside = (row >= 0) & (row < a.frame.rows) & (col >= 0) & (col < a.frame.cols)
    same = np.zeros(len(inside), np.bool_)
    same[inside] = a.labels[row[inside], col[inside]] == SAME
    places, normals = b.walls[same], b.normals[same]
    for _ in range(lines):
        rest = ~_longest(places, normals)
        places, normals = places[rest], normals[rest]
    return len(places) * b.cell


def _longest(places: Floats, normals: Floats) -> NDArray[np.bool_]:
    """Tell which walls lie along the line that has most of them; some walls are tried as part of it."""
    best = np.zeros(len(places), np.bool_)
    for k in range(0, len(places), max(1, len(places) // TRIED)):
        along = (np.abs((places - places[k]) @ normals[k]) <= THICK) & (normals @ normals[k] >= ALIKE)
        if np.count_nonzero(along) > np.count_nonzero(best):
            best = along
    return best

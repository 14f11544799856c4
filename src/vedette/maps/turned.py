"""A map whose origin has a yaw, laid into a grid along the axes of the team frame."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from vedette.maps.frame import OCCUPIED, UNKNOWN, GridFrame

_LEAST = 0.5  # [cells] a turn that moves no corner as far is none
_BESIDE = np.array([[0.0, 0.25, 0.25, -0.25, -0.25], [0.0, 0.25, -0.25, 0.25, -0.25]])  # [cells]


def upright(
    classes: NDArray[np.uint8], resolution: float, origin: tuple[float, float, float]
) -> tuple[GridFrame, NDArray[np.uint8]]:
    """Return frame and classes of cells that are turned about their lower-left corner.

    Quarter turns move cells as they are; a yaw from which no corner is half a cell away counts as one. For
    others each cell of a grid around it all takes the class at its centre, but is occupied if that is so a
    quarter of a cell beside it, so that walls of one cell stay closed; what is outside is unknown.

    Args:
        classes: ``uint8[rows, cols]`` before the turn.
        resolution: side of a cell [m].
        origin: x, y of the corner and the yaw, counter-clockwise [m, m, rad], team frame.
    """
    x, y, yaw = origin
    quarters = round(yaw / (math.pi / 2))
    if abs(yaw - quarters * math.pi / 2) * math.hypot(*classes.shape) < _LEAST:
        cos, sin = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[quarters % 4]
        turned = np.ascontiguousarray(np.rot90(classes, -quarters))
        (left, low), _ = _corners(classes.shape, cos, sin)
    else:
        cos, sin = math.cos(yaw), math.sin(yaw)
        (left, low), (right, high) = _corners(classes.shape, cos, sin)
        turned = np.empty((math.ceil(high - low), math.ceil(right - left)), np.uint8)
        _resample(classes, turned, left, low, cos, sin)
    rows, cols = turned.shape
    return GridFrame(resolution, rows, cols, x + left * resolution, y + low * resolution), turned


def _corners(shape: tuple[int, ...], cos: float, sin: float) -> tuple[list[float], list[float]]:
    """Return the lowest and the highest x, y of the turned grid from its corner [cells]."""
    rows, cols = shape
    u, v = np.array([0, cols, 0, cols]), np.array([0, 0, rows, rows])
    corners = np.stack([cos * u - sin * v, sin * u + cos * v])
    return corners.min(axis=1).tolist(), corners.max(axis=1).tolist()


def _resample(
    classes: NDArray[np.uint8], turned: NDArray[np.uint8], left: float, low: float, cos: float, sin: float
) -> None:
    """Fill ``turned``, whose corner is ``left, low`` [cells] from that about which ``classes`` is turned."""
    rows, cols = classes.shape
    around = np.pad(classes, 1, constant_values=UNKNOWN)
    px = left + np.arange(turned.shape[1]) + 0.5
    for number, row in enumerate(turned):
        py = low + number + 0.5
        u = cos * px + sin * py + _BESIDE[0][:, None]  # (5, cols) back in the grid before the turn
        v = cos * py - sin * px + _BESIDE[1][:, None]
        i = np.clip(np.floor(v) + 1, 0, rows + 1).astype(np.intp)
        j = np.clip(np.floor(u) + 1, 0, cols + 1).astype(np.intp)
        found = around[i, j]
        row[:] = np.where((found == OCCUPIED).any(axis=0), np.uint8(OCCUPIED), found[0])

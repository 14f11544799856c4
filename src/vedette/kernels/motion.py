"""Local motion of disc robots: distance to walls, and the next velocity along a path."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vedette import _kernels
from vedette.kernels._arrays import floats

WALL_GUARD = 0.025  # [m]


class Limits(NamedTuple):
    """What a robot's body can do, and how often it is told."""

    radius: float  # [m]
    speed: float  # top speed [m/s]
    turn_rate: float  # top turn rate [rad/s]
    period: float  # time for which a command holds [s]
    guard: float = WALL_GUARD  # least clearance to walls ever commanded [m]


class Command(NamedTuple):
    """What ``steer`` chose."""

    speed: float  # [m/s], along the heading after half the turn
    turn: float  # [rad/s], counter-clockwise positive
    arc: float  # arc length reached on the path after one period [m]
    offset: float  # sideways offset from the path that is being followed [m], left positive
    cost: float  # predicted time to the path's end, penalties included [s]


def clearance(solid: NDArray[np.bool_], resolution: float, x: float, y: float, reach: float) -> float:
    """Distance from the point to the nearest solid cell's square, capped at ``reach`` [m].

    ``solid`` is ``(R, C)``; outside the grid is solid. ``x, y`` [m] from the grid's lower-left corner.
    """
    return _kernels.clearance(solid, resolution, x, y, reach)


def block_discs(
    free: NDArray[np.bool_], resolution: float, discs: Sequence[tuple[float, float, float]]
) -> NDArray[np.bool_]:
    """Return ``free`` ``(R, C)`` without the cells whose centre lies in a disc ``(x, y, r)`` [m].

    For a centre to keep clear of a body, ``r`` is the sum of both radii and the gap wanted. A centre on the
    rim is not in the disc; ``x, y`` from the grid's lower-left corner.
    """
    left = np.array(free, np.bool_, order="C")
    if len(discs):
        _kernels.block_discs(left, resolution, floats(discs))
    return left


def steer(
    solid: NDArray[np.bool_],
    traversable: NDArray[np.bool_],
    first: tuple[int, int],
    resolution: float,
    pose: tuple[float, float, float],
    path: NDArray[np.float64],
    arc: NDArray[np.float64],
    progress: tuple[float, float, float],
    others: NDArray[np.float64],
    limits: Limits,
) -> Command:
    """Choose the command whose 2 s roll-out has the least ``time to go + penalties``.

    The roll-outs are followers of the path with different sideways offsets, speeds and look-aheads (a dynamic
    window in path coordinates): each turns towards its point ahead and slows down while it is askew. One that
    would leave the traversable cells, or come within 5 cm of a disc (others move on at constant velocity) or
    the guard of a wall, waits for that step, unless it is no worse than before: every candidate is safe. The
    first that costs at most 0.1 s more than conceivable is taken. Head-on, robots keep to the right. A robot
    that turns on the spot needs a reason to turn back, lest it dither between two followers.

    ``solid`` ``(R, C)``: the true walls, as a ring of proximity sensors feels them within a metre.
    ``traversable`` ``(r, c)``: cells where the map allows the robot's centre, from row and column ``first``
    on, which may lie outside the grid; nowhere else.
    ``pose``: x, y [m] from the grid's lower-left corner, heading [rad].
    ``path`` ``(L, 2)`` [m], L >= 2, no two consecutive points equal; ``arc`` ``(L,)`` its arc length [m].
    ``progress``: from the last command, the arc length reached and the offset followed [m], and its turn rate
    [rad/s] if the robot did not move, otherwise 0; all 0 at first.
    ``others`` ``(D, 6)``: x, y, vx, vy, radius, and the gap one would rather keep (> 0) [m, m/s].
    """
    return Command(
        *_kernels.steer(solid, traversable, first, resolution, pose, path, arc, progress, others, limits)
    )


def remaining(path: NDArray[np.float64], x: float, y: float, length: float) -> NDArray[np.float64]:
    """Return the path ``(L, 2)`` [m] from its point nearest (x, y) on, at most ``length`` [m] of it."""
    if len(path) < 2:
        return path
    return _kernels.remaining(np.ascontiguousarray(path), (x, y), length)

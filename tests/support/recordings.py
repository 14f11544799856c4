"""Logs as a lidar in a known building would have left them."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from vedette.kernels import lidar
from vedette.maps.world import World

NO_RETURN = 81.91  # what the lidar writes where nothing came back [m]


def places(world: World, step: float) -> NDArray[np.float64]:
    """A place in every so many metres of the free ones, ``(n, 2)`` [m], row by row."""
    every = round(step / world.frame.resolution)
    grid = np.zeros(world.frame.shape, bool)
    grid[::every, ::every] = True
    return world.frame.centres(np.flatnonzero(grid & ~world.solid))


def ranges_from(
    world: World, x: float, y: float, heading: float, angles: NDArray[np.float64], reach: float = 8.0
) -> NDArray[np.float64]:
    """What comes back to a lidar [m]."""
    frame = world.frame
    at = x - frame.origin_x, y - frame.origin_y
    ranges = lidar.cast_rays(world.solid, frame.resolution, *at, heading + angles, reach, np.zeros((0, 3)))
    return np.where(np.isfinite(ranges), ranges, NO_RETURN)


def flaser(ranges: Sequence[float], x: float, y: float, heading: float, stamp: float) -> str:
    """A line of a log."""
    pose = f"{x:.4f} {y:.4f} {heading:.6f}"
    return f"FLASER {len(ranges)} {' '.join(f'{r:.3f}' for r in ranges)} {pose} {pose} {stamp} host {stamp}"


def carmen_log(world: World, step: float = 1.0) -> str:
    """A log of half-round scans, two at each place, forth and back."""
    angles = np.radians(np.arange(-90.0, 90.0, 0.5))
    lines = ["# a log", "PARAM robot_length 0.5 0 host 0"]
    for k, (x, y) in enumerate(places(world, step).tolist()):
        for turn, heading in enumerate((0.0, math.pi)):
            ranges = ranges_from(world, x, y, heading, angles).tolist()
            lines.append(flaser(ranges, x, y, heading, 2.0 * k + turn))
    return "\n".join(lines) + "\n"

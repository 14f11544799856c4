"""A real building as a world: what was recorded of it is free or solid, and the rest is solid."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from vedette.errors import InputError
from vedette.kernels import lidar
from vedette.kernels.components import components, largest
from vedette.kernels.tiles import TiledGrid, Tiling
from vedette.logs import RecordedLog, RecordedMap, RecordedScan
from vedette.maps import FREE, GridFrame
from vedette.maps.world import World
from vedette.missions.explore.evidence import CLAMP, GAIN_HIT, GAIN_MISS, NUDGE
from vedette.missions.explore.own_map import OwnMap
from vedette.sim.worlds.size import RESOLUTIONS, check_cells, check_length

NO_RETURNS = ("ignore", "free")
SPECK = 0.25  # solid things that nothing came back from are no smaller [m^2]
_MARGIN = 0.5  # about what was seen [m]


def logged(log: RecordedLog, resolution: float, reach: float, no_return: str) -> World:
    """Return the building in which a log was recorded; by maps, as the last of them has it.

    A cell is free where more beams passed than came back, and solid where they came back, or where none
    was. Specks that no beam fell into, between the beams of far scans, are free as what is round them; of
    the free cells the largest connected part is kept.

    Args:
        log: of a lidar.
        resolution: cell side [m].
        reach: of the beams; what lies farther is left out [m].
        no_return: what a beam says that did not come back: ``ignore`` nothing, ``free`` that nothing is
            within reach; glass and black walls return none.

    Raises:
        InputError: a resolution out of range, more than 8000 cells a side, or nothing free.
    """
    frame = frame_of(log, resolution, reach)
    solid = ~largest(_mapped(log.maps[-1], frame) if log.maps else _scanned(log, frame, reach, no_return))
    if solid.all():
        more = "" if log.maps else f" within {reach:g} m; raise --range"
        raise InputError(f"{log.name}: its {'map leaves' if log.maps else 'scans leave'} nothing free{more}")
    return World(frame, solid, log.name)


def _mapped(told: RecordedMap, frame: GridFrame) -> NDArray[np.bool_]:
    """Return what is free on a map."""
    free: NDArray[np.bool_] = OwnMap(told.classes, told.resolution, *told.corner).laid(frame) == FREE
    return free


def _scanned(log: RecordedLog, frame: GridFrame, reach: float, no_return: str) -> NDArray[np.bool_]:
    """Return what is free by the scans of a log."""
    resolution = frame.resolution
    evidence = TiledGrid(Tiling(*frame.shape), np.int8)
    for scan in log.scans:
        ranges, hits = beams(scan, reach, no_return)
        x, y = scan.x - frame.origin_x, scan.y - frame.origin_y
        gains = GAIN_HIT, GAIN_MISS, CLAMP, NUDGE * resolution
        lidar.integrate_scan(evidence, resolution, x, y, scan.angles, ranges, hits, *gains)
    return _specks_freed(evidence.window(), round(SPECK / resolution**2))


def beams(scan: RecordedScan, reach: float, no_return: str) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Return how far each beam of a scan tells of, 0 where it tells nothing [m], and whether it came back."""
    lost = np.isinf(scan.ranges)
    told = ~np.isnan(scan.ranges) & ~(lost & (no_return == "ignore"))
    hits = told & ~lost & (scan.ranges < reach)
    return np.where(told, np.minimum(scan.ranges, reach), 0.0), hits


def frame_of(log: RecordedLog, resolution: float, reach: float) -> GridFrame:
    """Return the grid of all that came back from within reach, or was mapped, on multiples of its cells.

    Raises:
        InputError: a resolution out of range, or more than 8000 cells a side.
    """
    check_length("resolution of a world", resolution, RESOLUTIONS)
    low, high = np.full(2, math.inf), np.full(2, -math.inf)
    for sight in log.sights:
        seen = sight.corners if isinstance(sight, RecordedMap) else _hit(sight, reach)
        low, high = np.minimum(low, seen.min(axis=0)), np.maximum(high, seen.max(axis=0))
    first, last = np.floor((low - _MARGIN) / resolution), np.ceil((high + _MARGIN) / resolution)
    cols, rows = (last - first).astype(int).tolist()
    check_cells(rows, cols)
    x, y = (first * resolution).tolist()
    return GridFrame(resolution, rows, cols, x, y)


def _hit(scan: RecordedScan, reach: float) -> NDArray[np.float64]:
    """Return where the lidar was and where its beams came back from within reach, ``(n, 2)`` [m]."""
    ranges, hits = beams(scan, reach, "ignore")
    at, angles, away = np.array([scan.x, scan.y]), scan.angles[hits], ranges[hits]
    return np.vstack([at, at + away[:, None] * np.stack([np.cos(angles), np.sin(angles)], axis=1)])


def _specks_freed(evidence: NDArray[np.int8], cells: int) -> NDArray[np.bool_]:
    """Return what is free, with parts of the unknown that are smaller than so many cells."""
    free, unknown = evidence < 0, evidence == 0
    labels = components(unknown)
    small = np.bincount(labels[unknown]) < cells
    free[unknown] = small[labels[unknown]]
    return free

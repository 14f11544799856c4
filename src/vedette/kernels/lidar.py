"""Lidar on a grid: simulate a scan, fuse it into log-odds, and count what it saw of the unknown.

Positions are metres from the grid's lower-left corner; angles are radians in the grid's frame, 0 along +x,
counter-clockwise. Arrays that do not fit raise ``ValueError``.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from vedette import _kernels
from vedette.kernels._arrays import Mask, flags, floats, mask_bytes
from vedette.kernels.tiles import TiledGrid


def cast_rays(
    solid: Mask,
    resolution: float,
    x: float,
    y: float,
    angles: NDArray[np.float64],
    max_range: float,
    discs: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Return each beam's range [m] to the first wall face or disc surface, infinity beyond ``max_range``.

    The grid is traversed exactly (Amanatides and Woo, 1987). Outside the grid is solid; a sensor in a
    solid cell measures 0.

    Args:
        solid: ``(R, C)``, true where a wall stops the beam.
        resolution: cell side [m].
        x: sensor [m].
        y: sensor [m].
        angles: ``(B,)`` [rad].
        max_range: [m], itself included.
        discs: ``(D, 3)`` x, y, radius [m]; a disc that holds the sensor is ignored.

    Returns:
        ``(B,)`` ranges [m].
    """
    return _kernels.cast_rays(
        mask_bytes(solid), resolution, x, y, floats(angles), max_range, floats(discs).reshape(-1, 3)
    )


def integrate_scan(
    log_odds: TiledGrid[np.int8],
    resolution: float,
    x: float,
    y: float,
    angles: NDArray[np.float64],
    ranges: NDArray[np.float64],
    hits: NDArray[np.bool_],
    gain_hit: int,
    gain_miss: int,
    clamp: int,
    nudge: float,
) -> NDArray[np.int64]:
    """Add one scan to integer log-odds, in place; return the cells whose class changed.

    Class: occupied above 0, free below 0, unknown at 0. On each beam the cells before the endpoint's are
    misses. The endpoint's cell is a hit where the beam hit, and a miss where it did not. Within the scan each
    cell counts once, a hit before a miss; the sensor's own cell is always a miss. Cells outside the grid are
    ignored.

    Args:
        log_odds: changed in place.
        resolution: cell side [m].
        x: sensor [m].
        y: sensor [m].
        angles: ``(B,)`` [rad].
        ranges: ``(B,)`` [m], finite.
        hits: ``(B,)``, whether the range ends at an obstacle.
        gain_hit: added to a hit.
        gain_miss: taken from a miss.
        clamp: log-odds stay within ``[-clamp, clamp]``; 1 to 127.
        nudge: endpoint of a hit beyond its range [m], so that it lies in the obstacle and not on its face.

    Returns:
        Sorted flat indices of the cells whose class changed.
    """
    return _fused(
        log_odds,
        lambda: _kernels.integrate_scan(
            _tiles(log_odds),
            resolution,
            x,
            y,
            floats(angles),
            floats(ranges),
            flags(hits),
            gain_hit,
            gain_miss,
            clamp,
            nudge,
        ),
    )


def integrate_blurred_scan(
    log_odds: TiledGrid[np.int8],
    resolution: float,
    x: float,
    y: float,
    angles: NDArray[np.float64],
    ranges: NDArray[np.float64],
    hits: NDArray[np.bool_],
    margins: NDArray[np.float64],
    gain_hit: int,
    gain_miss: int,
    clamp: int,
    nudge: float,
) -> NDArray[np.int64]:
    """As ``integrate_scan``, for a scan whose returns may lie up to a margin from where they seem to.

    A return's evidence is spread over its band: its own cell and those whose centre is within its margin *m*,
    each of which gets ``max(1, round(gain_hit * min(1, a / 2 m)))`` with *a* the cell's side. A cell is a
    miss only if the middle of the beam's way through it is farther than *m* from every return and from its
    shadow: before its band, or past it at a bearing that clears it by *m*. What was known stays known:
    log-odds that would be 0 stop one short of it, on the step's side. docs/theory.md (V81), (V82)

    Args:
        margins: ``(B,)`` of each beam's return [m], 0 to 100; those of beams without one do not count.
        log_odds, resolution, x, y, angles, ranges, hits: as for ``integrate_scan``.
        gain_hit, gain_miss, clamp, nudge: as for ``integrate_scan``.

    Returns:
        Sorted flat indices of the cells whose class changed.
    """
    return _fused(
        log_odds,
        lambda: _kernels.integrate_blurred_scan(
            _tiles(log_odds),
            resolution,
            x,
            y,
            floats(angles),
            floats(ranges),
            flags(hits),
            floats(margins),
            gain_hit,
            gain_miss,
            clamp,
            nudge,
        ),
    )


def count_sightings(
    log_odds: TiledGrid[np.int8],
    resolution: float,
    x: float,
    y: float,
    angles: NDArray[np.float64],
    ranges: NDArray[np.float64],
    hits: NDArray[np.bool_],
    max_range: float,
    bin_m: float,
    berths: int,
    step: int,
    stride: int,
    nudge: float = 0.0,
) -> NDArray[np.int64]:
    """Count the unknown cells that one scan tried and saw: the paper's measured sensor model (Fig. 3).

    Every ``stride``-th beam is followed to ``max_range``, or to a cell known occupied or the grid's border.
    Each unknown cell on the way was tried; it was seen if the beam entered it before its endpoint, or hit in
    it. A beam's berth is the least of the cells by which it came from the known into the unknown so far.

    Args:
        log_odds: before the scan is fused; 0 is unknown.
        resolution, x, y, angles, ranges, hits, nudge: as for ``integrate_scan``.
        max_range: [m].
        bin_m: bin width [m].
        berths: how many to tell apart, as ``coverage.berths`` does.
        step: of them [cells].
        stride: beams from one that counts to the next.

    Returns:
        ``(2 + 2 berths, ceil(max_range / bin_m))``: tried and seen by distance of the crossing's middle, then
        of each berth tried and seen by the length of unknown cells crossed before on the beam.
    """
    return _kernels.count_sightings(
        _tiles(log_odds),
        resolution,
        x,
        y,
        floats(angles),
        floats(ranges),
        flags(hits),
        max_range,
        bin_m,
        berths,
        step,
        stride,
        nudge,
    )


def _tiles(
    grid: TiledGrid[np.int8],
) -> tuple[NDArray[np.int32], NDArray[np.int8], tuple[int, int]]:
    """Return slots, blocks and shape of a grid, as the kernels take it."""
    return grid.slots, grid.blocks, (grid.tiling.rows, grid.tiling.cols)


def _fused(grid: TiledGrid[np.int8], fuse: Callable[[], tuple[bool, NDArray[np.int64]]]) -> NDArray[np.int64]:
    """Return the cells that changed, once the grid holds all tiles that the scan touches."""
    done, cells = fuse()
    if not done:
        grid.claim(cells)
        _, cells = fuse()
    return cells

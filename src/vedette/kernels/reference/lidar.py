"""What the lidar kernels compute, said with the interval in which a ray lies inside each cell's square."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def crossings(
    shape: tuple[int, int], resolution: float, x: float, y: float, angle: float
) -> tuple[Floats, Floats]:
    """Return, for every cell, the metres along the ray at which it enters and leaves the cell's square.

    The ray crosses the cell if entry < exit.
    """
    rows, cols = shape
    entry, leave = np.zeros(shape), np.full(shape, np.inf)
    lows = np.meshgrid(np.arange(rows) * resolution, np.arange(cols) * resolution, indexing="ij")
    for low, position, direction in zip(lows, (y, x), (math.sin(angle), math.cos(angle)), strict=True):
        near, far = low - position, low + resolution - position
        if direction == 0.0:
            outside = (near > 0) | (far <= 0)
            leave[outside] = -np.inf
            continue
        near, far = near / direction, far / direction
        entry = np.maximum(entry, np.minimum(near, far))
        leave = np.minimum(leave, np.maximum(near, far))
    return entry, leave


def disc_range(disc: Floats, x: float, y: float, angle: float) -> float:
    """Return the range to a disc's surface: the smaller root of ``|p + t u - c|^2 = r^2``."""
    dx, dy, radius = disc[0] - x, disc[1] - y, disc[2]
    along = dx * math.cos(angle) + dy * math.sin(angle)
    across = dx * math.sin(angle) - dy * math.cos(angle)
    if math.hypot(dx, dy) <= radius or along <= 0 or abs(across) > radius:
        return math.inf
    return float(along - math.sqrt(radius**2 - across**2))


def cast_rays(
    solid: NDArray[np.bool_],
    resolution: float,
    x: float,
    y: float,
    angles: Floats,
    max_range: float,
    discs: Floats,
) -> Floats:
    """Twin of ``lidar.cast_rays``."""
    ranges = np.full(len(angles), np.inf)
    for b, angle in enumerate(angles):
        entry, leave = crossings((solid.shape[0], solid.shape[1]), resolution, x, y, angle)
        crossed = entry < leave
        border = leave[crossed].max(initial=0.0)
        wall = entry[crossed & (solid != 0)].min(initial=border)
        nearest = min([wall, *(disc_range(disc, x, y, angle) for disc in discs)])
        if nearest <= max_range:
            ranges[b] = nearest
    return ranges


def integrate_scan(
    log_odds: NDArray[np.int8],
    resolution: float,
    x: float,
    y: float,
    angles: Floats,
    ranges: Floats,
    hits: NDArray[np.bool_],
    gain_hit: int,
    gain_miss: int,
    clamp: int,
    nudge: float,
) -> NDArray[np.int64]:
    """Twin of ``lidar.integrate_scan``."""
    shape = (log_odds.shape[0], log_odds.shape[1])
    touched, hit_cells = np.zeros(shape, bool), np.zeros(shape, bool)
    for angle, measured, hit in zip(angles, ranges, hits, strict=True):
        reach = measured + nudge if hit else measured
        entry, leave = crossings(shape, resolution, x, y, angle)
        reached = (entry < leave) & (entry <= reach)
        touched |= reached
        hit_cells |= reached & (reach < leave) & hit
    row, col = math.floor(y / resolution), math.floor(x / resolution)
    if len(angles) and 0 <= row < shape[0] and 0 <= col < shape[1]:
        touched[row, col], hit_cells[row, col] = True, False
    before = np.sign(log_odds)
    step = np.where(hit_cells, gain_hit, np.where(touched, -gain_miss, 0))
    log_odds[touched] = np.clip(log_odds + step, -clamp, clamp)[touched]
    return np.flatnonzero(np.sign(log_odds) != before)


def integrate_blurred_scan(
    log_odds: NDArray[np.int8],
    resolution: float,
    x: float,
    y: float,
    angles: Floats,
    ranges: Floats,
    hits: NDArray[np.bool_],
    margins: Floats,
    gain_hit: int,
    gain_miss: int,
    clamp: int,
    nudge: float,
) -> NDArray[np.int64]:
    """Twin of ``lidar.integrate_blurred_scan``."""
    shape = (log_odds.shape[0], log_odds.shape[1])
    reaches = np.where(hits, np.asarray(ranges) + nudge, ranges)
    free, gains = np.zeros(shape, bool), np.zeros(shape, np.int64)
    rows, cols = (np.indices(shape) + 0.5) * resolution
    for b, angle in enumerate(angles):
        entry, leave = crossings(shape, resolution, x, y, angle)
        middle = 0.5 * (entry + leave)
        crossed = (entry < leave) & (
            (middle <= reaches[b] - margins[b]) if hits[b] else (entry <= reaches[b])
        )
        for other in np.flatnonzero(hits & (np.asarray(margins) > 0)):
            near, across = reaches[other] - margins[other], abs(math.sin(angle - angles[other]))
            if math.cos(angle - angles[other]) > 0:
                crossed &= ~((middle > near) & (middle * across < margins[other]))
        free |= crossed
        if hits[b]:
            end_x, end_y = x + reaches[b] * math.cos(angle), y + reaches[b] * math.sin(angle)
            band = np.hypot(cols - end_x, rows - end_y) <= margins[b]
            band |= np.maximum(np.abs(cols - end_x), np.abs(rows - end_y)) < resolution / 2
            gain = max(1, math.floor(gain_hit / max(1.0, 2 * margins[b] / resolution) + 0.5))
            gains[band] = np.maximum(gains[band], gain)
    row, col = math.floor(y / resolution), math.floor(x / resolution)
    if len(angles) and 0 <= row < shape[0] and 0 <= col < shape[1]:
        free[row, col], gains[row, col] = True, 0
    before = np.sign(log_odds)
    step = np.where(gains > 0, gains, np.where(free, -gain_miss, 0))
    after = np.clip(log_odds + step, -clamp, clamp)
    log_odds[step != 0] = np.where(after == 0, np.sign(step), after)[step != 0]
    return np.flatnonzero(np.sign(log_odds) != before)


def count_sightings(
    log_odds: NDArray[np.int8],
    resolution: float,
    x: float,
    y: float,
    angles: Floats,
    ranges: Floats,
    hits: NDArray[np.bool_],
    max_range: float,
    bin_m: float,
    berths: int,
    step: int,
    stride: int,
    nudge: float = 0.0,
) -> NDArray[np.int64]:
    """Twin of ``lidar.count_sightings``."""
    counts = np.zeros((2 + 2 * berths, math.ceil(max_range / bin_m)), np.int64)
    last = counts.shape[1] - 1
    for b in range(0, len(angles), stride):
        reach = ranges[b] + nudge if hits[b] else ranges[b]
        entry, leave = crossings((log_odds.shape[0], log_odds.shape[1]), resolution, x, y, angles[b])
        cells = np.flatnonzero((entry < leave) & (entry < max_range))
        unknown, berth, outside = 0.0, berths - 1, True
        for cell in cells[np.argsort(entry.flat[cells])]:
            if log_odds.flat[cell] > 0:
                break
            if outside and log_odds.flat[cell] == 0:
                berth = min(berth, _berth(log_odds, int(cell), step))
            if log_odds.flat[cell] == 0:
                start, end = entry.flat[cell], min(leave.flat[cell], max_range)
                by_distance = min(int(0.5 * (start + end) / bin_m), last)
                by_unknown = min(int(unknown / bin_m), last)
                seen = start < reach or (hits[b] and start == reach)
                counts[:2, by_distance] += (1, seen)
                counts[2 + 2 * berth : 4 + 2 * berth, by_unknown] += (1, seen)
                unknown += end - start
            outside = log_odds.flat[cell] != 0
    return counts


def _berth(log_odds: NDArray[np.int8], cell: int, step: int) -> int:
    """How many steps a cell is from the nearest occupied one."""
    row, col = divmod(cell, log_odds.shape[1])
    rows, cols = np.nonzero(log_odds > 0)
    away = np.maximum(abs(rows - row), abs(cols - col)).min(initial=np.iinfo(np.int64).max)
    return int((away - 1) // step)

"""What search teams bring: distances at which people were found, tracks already searched, no-go areas."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vedette.domains.search.belief import normalised
from vedette.domains.search.priors import polygon_share, tell_outside
from vedette.errors import InputError
from vedette.maps import GridFrame

_POINTS = 16.0  # along a radius or a track's width at which a cell is tested
_LEAST = 16  # points along each side of a cell
_MOST_DISC, _MOST_TRACK = 512, 64  # at most; a disc that is so small is in few cells
_MOST_POINTS = 8_000_000  # in all


@dataclass(frozen=True, eq=False)
class SearchedTrack:
    """Where somebody has searched already, in vain."""

    path: NDArray[np.float64]  # (n, 2) [m], team frame
    width: float  # within half of it on both sides [m]
    detection: float  # probability that a target there would have been detected


def rings(
    frame: GridFrame, centre: ArrayLike, distances: Sequence[float], within: Sequence[float]
) -> NDArray[np.float64]:
    """Rings round the last known place: ``within[j]`` of such people were found within ``distances[j]`` [m].

    Uniform in each ring, ``P = (F_j - F_{j-1}) / (pi (r_j^2 - r_{j-1}^2))``; who went farther is left out.

    Raises:
        InputError: as many distances as shares there must be, both rising from above 0, shares to 1 at most;
            or all rings lie outside the area.
        InputWarning: some of them do.
    """
    radii, shares = np.asarray(distances, np.float64), np.asarray(within, np.float64)
    for name, values in (("distances", radii), ("within", shares)):
        if len(values) == 0 or (np.diff(values, prepend=0.0) <= 0.0).any():
            raise InputError(f"{name} must rise from above 0; got {values.tolist()}")
    if len(radii) != len(shares):
        raise InputError(f"within must have a share for each of {len(radii)} distances; got {len(shares)}")
    if shares[-1] > 1.0:
        raise InputError(f"within must be shares of 1; got {shares[-1]:g}")
    discs = [np.zeros(frame.shape), *(disc_share(frame, centre, radius) for radius in radii)]
    areas = math.pi * np.diff(radii**2, prepend=0.0)
    densities = np.diff(shares, prepend=0.0) / areas
    mass = np.zeros(frame.shape)
    for inner, outer, density in zip(discs, discs[1:], densities, strict=False):
        mass += density * frame.resolution**2 * np.maximum(outer - inner, 0.0)
    told = normalised(frame, mass, "rings")
    tell_outside("rings", 1.0 - float(mass.sum()) / float(shares[-1]))
    return told


def disc_share(frame: GridFrame, centre: ArrayLike, radius: float) -> NDArray[np.float64]:
    """Return the share of each cell that lies within a radius [m] of a place [m], ``(R, C)``."""
    x, y = np.asarray(centre, np.float64)
    half = frame.resolution / 2.0
    cols = np.abs(frame.origin_x + (np.arange(frame.cols) + 0.5) * frame.resolution - x)
    rows = np.abs(frame.origin_y + (np.arange(frame.rows) + 0.5) * frame.resolution - y)[:, None]
    share = (np.hypot(rows + half, cols + half) <= radius).astype(np.float64)
    nearest = np.hypot(np.maximum(rows - half, 0.0), np.maximum(cols - half, 0.0))
    edge = np.flatnonzero((nearest < radius).ravel() & (share.ravel() == 0.0))
    offsets = _offsets(frame, radius, _MOST_DISC)
    for part in np.array_split(edge, max(1, len(edge) * len(offsets) // 4_000_000)):
        points = frame.centres(part)[:, None] + offsets - (x, y)
        share.ravel()[part] = (np.hypot(points[..., 0], points[..., 1]) <= radius).mean(axis=1)
    return np.asarray(share)


def missed_by(frame: GridFrame, tracks: Sequence[SearchedTrack]) -> NDArray[np.float64]:
    """Probability that tracks searched in vain missed a target anywhere in a cell, ``(R, C)``.

    ``prod_j (1 - P_j [d_j <= W_j / 2])``, d the distance to a track; the mean is over points of a cell, so
    that two tracks at one place are no two tracks at two.

    Raises:
        InputError: nothing of a track is in the area.
    """
    near = [[_cells_near(frame, ends, track.width) for ends in _segments(track)] for track in tracks]
    own = [np.unique(np.concatenate(pieces)) for pieces in near]
    for i, cells in enumerate(own):
        if not len(cells):
            raise InputError(f"searched[{i}]: nothing of the track is in the area; check its path, in m")
    touched = np.unique(np.concatenate([np.empty(0, np.int64), *own]))
    missed = np.ones(frame.shape)
    if len(touched):
        most = min(_MOST_TRACK, math.isqrt(_MOST_POINTS // len(touched)))
        offsets = _offsets(frame, min(track.width for track in tracks), most)
        chance = np.ones((len(touched), len(offsets)))
        for track, pieces, all_cells in zip(tracks, near, own, strict=True):
            seen = np.zeros((len(all_cells), len(offsets)), bool)
            for ends, beside in zip(_segments(track), pieces, strict=True):
                points = frame.centres(beside)[:, None] + offsets
                seen[np.searchsorted(all_cells, beside)] |= _distance(points, ends) <= track.width / 2.0
            chance[np.searchsorted(touched, all_cells)] *= 1.0 - track.detection * seen
        missed.ravel()[touched] = chance.mean(axis=1)
    return missed


def _segments(track: SearchedTrack) -> Iterator[NDArray[np.float64]]:
    """The track's straight pieces, ``(2, 2)`` each."""
    return (track.path[i : i + 2] for i in range(len(track.path) - 1))


def without(frame: GridFrame, areas: Sequence[ArrayLike]) -> NDArray[np.float64]:
    """Return the share of each cell that is in none of these polygons, ``(R, C)``; they are taken apart."""
    open_to = np.ones(frame.shape)
    for i, corners in enumerate(areas):
        try:
            open_to *= 1.0 - polygon_share(frame, corners)
        except InputError as error:
            raise InputError(f"no_go[{i}]: {str(error).removeprefix('prior: ')}") from error
    return open_to


def _cells_near(frame: GridFrame, ends: NDArray[np.float64], width: float) -> NDArray[np.int64]:
    """Return the flat cells that a straight piece of a track may have touched, rising."""
    reach = width / 2.0 + frame.resolution * math.sqrt(0.5)
    (x0, x1), (y0, y1) = np.sort(ends, axis=0).T
    row, col = np.maximum(frame.cell(x0 - reach, y0 - reach), 0)
    last_row, last_col = np.minimum(frame.cell(x1 + reach, y1 + reach), np.subtract(frame.shape, 1))
    box = np.arange(row, last_row + 1)[:, None] * frame.cols + np.arange(col, last_col + 1)
    cells = box.ravel().astype(np.int64)
    return cells[_distance(frame.centres(cells), ends) <= reach]


def _distance(points: NDArray[np.float64], ends: NDArray[np.float64]) -> NDArray[np.float64]:
    """Distance of points ``(..., 2)`` from a straight piece between two places ``(2, 2)``."""
    along = ends[1] - ends[0]
    share = np.clip((points - ends[0]) @ along / max(float(along @ along), 1e-300), 0.0, 1.0)
    away = points - ends[0] - share[..., None] * along
    return np.asarray(np.hypot(away[..., 0], away[..., 1]))


def _offsets(frame: GridFrame, length: float, most: int) -> NDArray[np.float64]:
    """Points of a cell, relative to its middle, enough of them along a length [m], ``(k, 2)``."""
    count = int(np.clip(math.ceil(_POINTS * frame.resolution / length), _LEAST, most))
    side = ((np.arange(count) + 0.5) / count - 0.5) * frame.resolution
    return np.stack(np.meshgrid(side, side), axis=-1).reshape(-1, 2)

"""Where a target is taken to be at first: uniform, Gaussians, a polygon, or a heat map."""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vedette.domains.search.belief import normalised
from vedette.errors import InputError, InputWarning
from vedette.maps import GridFrame
from vedette.maps.raster import Extent, read_raster

LEAST_INSIDE = 0.01  # of a Gaussian's mass, in the area
_FINE = 4  # points along each side of a cell that a polygon is tested at


@dataclass(frozen=True)
class GaussianPart:
    """One normal distribution of a mixture."""

    mean: tuple[float, float]  # [m], team frame
    covariance: tuple[tuple[float, float], tuple[float, float]] | float  # [m^2]; a number: sigma [m]
    weight: float = 1.0


def uniform(frame: GridFrame) -> NDArray[np.float64]:
    """Return the same probability in all cells."""
    return np.full(frame.shape, 1.0 / frame.size)


def gaussians(frame: GridFrame, parts: Sequence[GaussianPart]) -> NDArray[np.float64]:
    """``P ~ sum_j w_j N(x; mean_j, C_j + (r^2 / 12) I)`` at the cells' centres, each part whole in the area.

    The resolution r widens a part by what a cell blurs, so that one narrower than a cell is not lost.

    Raises:
        InputError: no parts, a bad weight, mean or covariance, or a part that lies outside the area.
    """
    if not parts:
        raise InputError("prior: gaussians is empty; give at least one")
    total = np.zeros(frame.shape)
    points = frame.centres(np.arange(frame.size))
    for number, part in enumerate(parts, start=1):
        field = f"prior: gaussian {number}"
        if not (math.isfinite(part.weight) and part.weight > 0.0):
            raise InputError(f"{field}: weight must be a number > 0; got {part.weight}")
        if np.shape(part.mean) != (2,) or not np.isfinite(part.mean).all():
            raise InputError(f"{field}: mean must be two finite coordinates [m]; got {part.mean}")
        covariance = _covariance(field, part.covariance) + frame.resolution**2 / 12.0 * np.eye(2)
        whitened = np.linalg.solve(np.linalg.cholesky(covariance), (points - part.mean).T)
        scale = frame.resolution**2 / (2.0 * math.pi * math.sqrt(np.linalg.det(covariance)))
        mass = scale * np.exp(-0.5 * (whitened**2).sum(axis=0))
        if mass.sum() < LEAST_INSIDE:
            raise InputError(
                f"{field}: its mean {part.mean} leaves {mass.sum():.1%} of it in the area; move it"
            )
        total += part.weight * (mass / mass.sum()).reshape(frame.shape)
    return np.asarray(total / total.sum())


def _covariance(field: str, given: object) -> NDArray[np.float64]:
    if isinstance(given, int | float) and not isinstance(given, bool):
        if not (math.isfinite(given) and given > 0.0):
            raise InputError(f"{field}: sigma must be a number > 0 m; got {given}")
        return float(given) ** 2 * np.eye(2)
    matrix = np.asarray(given, np.float64)
    if matrix.shape != (2, 2) or not np.isfinite(matrix).all():
        raise InputError(f"{field}: covariance must be 2x2 finite numbers [m^2]; got shape {matrix.shape}")
    if not np.allclose(matrix, matrix.T) or np.linalg.eigvalsh(matrix)[0] <= 0.0:
        raise InputError(
            f"{field}: covariance must be symmetric and positive definite; got {matrix.tolist()}"
        )
    return matrix


def polygon(frame: GridFrame, corners: ArrayLike) -> NDArray[np.float64]:
    """Uniform inside a polygon, cells at its edge by the share of them that is inside; as `polygon_share`."""
    share = polygon_share(frame, corners)
    return np.asarray(share / share.sum())


def polygon_share(frame: GridFrame, corners: ArrayLike) -> NDArray[np.float64]:
    """Return the share of each cell that is inside a polygon (even-odd rule), ``(R, C)``.

    Args:
        frame: the grid.
        corners: ``(n, 2)`` [m], team frame, in order; the last is joined to the first.

    Raises:
        InputError: fewer than three corners, a coordinate that is not finite, or nothing of it in the area.
    """
    points = np.asarray(corners, np.float64)
    if points.ndim != 2 or points.shape[1:] != (2,) or len(points) < 3:
        raise InputError(f"prior: a polygon needs at least three corners [x, y]; got shape {points.shape}")
    if not np.isfinite(points).all():
        raise InputError("prior: a polygon's corners must be finite coordinates [m]")
    step = frame.resolution / _FINE
    x = frame.origin_x + (np.arange(frame.cols * _FINE) + 0.5) * step
    y = frame.origin_y + (np.arange(frame.rows * _FINE) + 0.5) * step
    inside = np.zeros((len(y), len(x)), bool)
    for (x1, y1), (x2, y2) in zip(points, np.roll(points, -1, axis=0), strict=True):
        crossed = np.flatnonzero((y1 <= y) != (y2 <= y))
        where = x1 + (y[crossed] - y1) / (y2 - y1) * (x2 - x1) if len(crossed) else crossed
        inside[crossed] ^= x < where[:, None]
    share: NDArray[np.float64] = inside.reshape(frame.rows, _FINE, frame.cols, _FINE).mean(axis=(1, 3))
    if not share.any():
        raise InputError("prior: nothing of the polygon is in the area; check its corners, in m, team frame")
    return share


def heat_map(frame: GridFrame, path: Path, extent: Extent | None = None) -> NDArray[np.float64]:
    """Probabilities in proportion to the numbers of a raster where it lies, or stretched over the area.

    Each cell takes what covers it. The raster's own place is less than ``extent``, lowest x, lowest y,
    highest x, highest y [m].

    Raises:
        InputError: a raster that cannot be read, in colours, 0 all over, or beside the area.
        InputWarning: some of it is outside the area.
    """
    raster = read_raster(path, "heat map")
    x0, x1, y0, y1 = frame.extent
    left, low, right, high = extent or raster.extent or (x0, y0, x1, y1)
    if left >= x1 or right <= x0 or low >= y1 or high <= y0:
        raise InputError(
            f"heat map {path}: it lies at x {left:.10g} to {right:.10g} m, y {low:.10g} to {high:.10g} m, "
            f"beside the area of x {x0:.10g} to {x1:.10g} m, y {y0:.10g} to {y1:.10g} m"
        )
    values = raster.values / (raster.values.max() or 1.0)
    rows = _overlap(frame.rows, frame.resolution / (high - low), (y0 - low) / (high - low), len(values))
    cols = _overlap(
        frame.cols, frame.resolution / (right - left), (x0 - left) / (right - left), values.shape[1]
    )
    mass = np.asarray(rows @ values @ cols.T, np.float64)
    told = normalised(frame, mass, f"heat map {path}")
    tell_outside(f"heat map {path}", 1.0 - float(mass.sum()) / float(values.sum()))
    return told


def _overlap(cells: int, side: float, start: float, pixels: int) -> NDArray[np.float64]:
    """``(cells, pixels)`` share of each pixel that each cell covers, along one side of the raster.

    Cells of ``side`` begin at ``start``, both as shares of the raster's length.
    """
    edges = (start + np.arange(cells + 1) * side) * pixels
    first = np.arange(pixels)
    covered = np.minimum(edges[1:, None], first + 1) - np.maximum(edges[:-1, None], first)
    return np.asarray(np.maximum(covered, 0.0))


def tell_outside(what: str, share: float) -> None:
    """Say that a share of a part of the prior lies outside the area, if that is more than 1 %."""
    if share > LEAST_INSIDE:
        line = f"{what}: {share:.0%} of it is outside the area; what is inside counts as all"
        warnings.warn(line, InputWarning, stacklevel=5)


def mixture(frame: GridFrame, parts: Sequence[tuple[float, NDArray[np.float64]]]) -> NDArray[np.float64]:
    """``sum_j w_j P_j / sum_j w_j``: priors of different kinds together.

    Raises:
        InputError: no parts, or a weight that is not a number > 0.
    """
    if not parts:
        raise InputError("prior: no parts; give at least one")
    for number, (weight, _) in enumerate(parts, start=1):
        if not (math.isfinite(weight) and weight > 0.0):
            raise InputError(f"prior: weight of part {number} must be a number > 0; got {weight}")
    total = sum((weight * mass for weight, mass in parts), np.zeros(frame.shape))
    return normalised(frame, total, "prior")

"""What the kernels of looks compute, said with NumPy's own linear algebra."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from vedette.kernels.looks import Lines, Sight

Floats = NDArray[np.float64]

_NODES, _WEIGHTS = np.polynomial.hermite_e.hermegauss(4)
_XI = np.stack(np.meshgrid(_NODES, _NODES, indexing="ij"), -1).reshape(-1, 2)
_W = np.outer(_WEIGHTS, _WEIGHTS).ravel() / (2.0 * math.pi)


def cloud(mean: Floats, covariance: Floats) -> tuple[Floats, Floats]:
    """Return the points (16, 2) of a Gaussian and its Cholesky factor."""
    root: Floats = np.linalg.cholesky(covariance).astype(np.float64)
    return mean + _XI @ root.T, root


def regressed(
    f: Callable[[Floats], Floats], mean: Floats, covariance: Floats
) -> tuple[Floats, Floats, Floats]:
    """Return mean (s,), slope (s, 2) and left-over covariance (s, s) of functions of a Gaussian position."""
    points, root = cloud(mean, covariance)
    values = f(points)
    centre = _W @ values
    slope = (_W[:, None] * (values - centre)).T @ _XI @ np.linalg.inv(root)
    left = values - centre - (points - mean) @ slope.T
    return centre, slope, (_W[:, None] * left).T @ left


def line(sight: Sight, distance: float, covariance: Floats) -> tuple[Floats, Floats, Floats]:
    """Return rows H (s, 2), noise R (s, s) and expectations (s,), along the line of sight and across it."""
    mean = np.array([distance, 0.0])
    if sight.place_noise:
        return np.eye(2), sight.place_noise**2 * np.eye(2), mean
    moments = np.outer(mean, mean) + covariance  # E x x'
    square = float(np.trace(moments))
    again = min(300.0, 4.0 * max(1.0, math.sqrt(square) / sight.stride)) if sight.stride else 300.0

    def ranges(x: Floats) -> Floats:
        return np.asarray(np.linalg.norm(x, axis=1, keepdims=True))

    def units(x: Floats) -> Floats:
        return np.asarray(x / ranges(x))

    length, slope, left = regressed(ranges, mean, covariance)
    r = sight.range_noise**2
    if not sight.bearing_noise:
        return slope, r + again * left, length
    centre, turn, curved = regressed(units, mean, covariance)
    points, _ = cloud(mean, covariance)
    directions = (_W[:, None] * units(points)).T @ units(points)  # E e e'
    v = sight.bearing_noise**2
    near = max(1.0, sight.min_range**2 / square)
    if not r:
        noise = np.sinh(v) * np.eye(2) - (1.0 - np.exp(-v)) * directions
        return turn, near * noise + again * curved, centre
    place = near * (np.sinh(v) * square * np.eye(2) - (1.0 - np.exp(-v)) * moments)
    place += r * (np.sinh(v) * np.eye(2) + np.exp(-v) * directions)
    noise = np.block([[place, r * centre[:, None]], [r * centre, r + again * left]])
    return np.vstack([np.eye(2), slope]), noise, np.append(mean, length)


def lines(sight: Sight, offsets: Floats, covariances: Floats) -> Lines:
    """Twin of ``looks.lines``."""
    out = Lines(np.zeros((len(offsets), 3)), np.zeros((len(offsets), 2, 3)), np.zeros((len(offsets), 3)))
    inverse = [1.0 / each**2 for each in (sight.range_noise, sight.place_noise) if each]
    across = sight.min_range * sight.bearing_noise
    most = max([*inverse, *([across**-2] if across else [])])
    for n, (offset, (xx, xy, yy)) in enumerate(zip(offsets, covariances, strict=True)):
        distance = float(np.hypot(*offset))
        radial = offset / distance if distance else np.array([1.0, 0.0])
        axes = np.stack([radial, [-radial[1], radial[0]]])
        H, R, expected = line(sight, distance, axes @ np.array([[xx, xy], [xy, yy]]) @ axes.T)
        gain = axes.T @ np.linalg.solve(R, H).T
        information = gain @ H @ axes
        share = min(1.0, most / max(float(np.linalg.eigvalsh(information)[1]), 1e-300))
        out.information[n] = share * information[[0, 0, 1], [0, 1, 1]]
        out.gain[n, :, : len(expected)] = share * gain
        out.expected[n, : len(expected)] = expected
    return out


def foreseen(
    sight: Sight, view: tuple[float, float], poses: Floats, points: Floats, covariances: Floats
) -> Floats:
    """Twin of ``looks.foreseen``: look by look."""
    out = np.zeros((len(poses), len(points), poses.shape[1], 3))
    for c, m, k in np.ndindex(out.shape[:3]):
        pose, offset, (xx, xy, yy) = poses[c, k], points[m, k] - poses[c, k, :2], covariances[m, k]
        radial = offset / max(float(np.hypot(*offset)), 1e-300)
        axes = np.stack([radial, [-radial[1], radial[0]]])
        along, _ = cloud(axes @ offset, axes @ np.array([[xx, xy], [xy, yy]]) @ axes.T)
        if _sees(pose, offset[None], view)[0]:
            share = _W @ _sees(pose, along @ axes, view)
            out[c, m, k] = share * lines(sight, offset[None], covariances[m, k][None]).information[0]
    return out


def _sees(pose: Floats, offsets: Floats, view: tuple[float, float]) -> NDArray[np.bool_]:
    aside = np.arctan2(offsets[:, 1], offsets[:, 0]) - pose[2]
    inside = np.abs((aside + math.pi) % (2.0 * math.pi) - math.pi) <= view[1]
    return np.asarray((np.hypot(*offsets.T) <= view[0]) & inside)

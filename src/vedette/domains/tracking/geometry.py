"""Angles, lines of sight and symmetric matrices in the plane."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray


def geometry(
    poses: ArrayLike, points: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return range (...) [m] and unit vectors (..., 2) along the line of sight and across it, to its left."""
    offset = offset_of(poses, points)
    r = np.hypot(offset[..., 0], offset[..., 1])
    radial = np.where(r[..., None] > 0.0, offset / np.maximum(r, 1e-300)[..., None], np.array([1.0, 0.0]))
    return r, radial, np.stack([-radial[..., 1], radial[..., 0]], -1)


def wrapped(angle: ArrayLike) -> NDArray[np.float64]:
    """Return angles [rad] as the same directions in (-pi, pi]."""
    return np.asarray(math.pi - np.mod(math.pi - np.asarray(angle, np.float64), 2.0 * math.pi))


def packed(covariances: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return symmetric matrices (..., 2, 2) as xx, xy, yy (..., 3)."""
    return np.stack([covariances[..., 0, 0], covariances[..., 0, 1], covariances[..., 1, 1]], -1)


def debiased(angle: float, deviation: float) -> NDArray[np.float64]:
    """``(cos, sin) / e^{-sigma^2 / 2}`` of a noisy angle: on average those of the true one."""
    return np.array([math.cos(angle), math.sin(angle)]) / math.exp(-(deviation**2) / 2.0)


def offset_of(poses: ArrayLike, points: ArrayLike) -> NDArray[np.float64]:
    """Return the ways (..., 2) from poses (..., 3) to points (..., 2) [m]."""
    return np.asarray(points, np.float64) - np.asarray(poses, np.float64)[..., :2]


def outer(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    """``(a b' + b a') / 2`` as xx, xy, yy."""
    ax, ay, bx, by = a[..., 0], a[..., 1], b[..., 0], b[..., 1]
    return np.stack([ax * bx, (ax * by + ay * bx) / 2.0, ay * by], -1)

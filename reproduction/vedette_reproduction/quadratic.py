"""Quadratic objectives of continuous controls: best replies at once and in turn."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

MOST_STEPS = 2000
Float = NDArray[np.float64]


def random_hessian(rng: np.random.Generator, span: tuple[float, float]) -> Float:
    """Return a positive definite matrix of unit diagonal whose largest sum beside it lies in ``span``."""
    while True:
        off = rng.standard_normal((10, 10))
        off = off + off.T
        np.fill_diagonal(off, 0.0)
        off *= rng.uniform(*span) / np.abs(off).sum(axis=1).max()
        q: Float = np.eye(10) + off
        if np.linalg.eigvalsh(q)[0] > 1e-3:
            return q


def jacobi_step(q: Float, b: Float, u: Float) -> Float:
    """Everybody's best reply at once (paper, eq. (29)) for a Hessian -q of unit diagonal."""
    return np.asarray(b - (q - np.eye(len(q))) @ u)


def token_step(q: Float, b: Float, u: Float) -> Float:
    """Everybody's best reply in turn."""
    u = u.copy()
    for i in range(len(q)):
        u[i] = b[i] - q[i] @ u + u[i]
    return u


def spectral_radius(q: Float) -> float:
    """Return by what an iterate of ``jacobi_step`` shrinks errors in the end."""
    return float(np.abs(np.linalg.eigvalsh(np.eye(len(q)) - q)).max())


def steps_to_optimum(
    q: Float, b: Float, step: Callable[[Float, Float, Float], Float], tolerance: float = 1e-9
) -> int | None:
    """Return the number of iterates to the optimum, ``None`` if it is not reached."""
    u, optimum = np.zeros(len(b)), np.linalg.solve(q, b)
    for k in range(1, MOST_STEPS + 1):
        u = step(q, b, u)
        if np.abs(u - optimum).max() < tolerance * max(1.0, float(np.abs(optimum).max())):
            return k
        if not np.isfinite(u).all() or np.abs(u).max() > 1e9:
            return None
    return None

"""One filter step in information form, and whether an estimate is consistent with the truth."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vedette.domains.tracking.belief import Tracks, inverses


def predict(tracks: Tracks, steps: int = 1) -> Tracks:
    """``P' = F P F' + Q``, ``x' = F x``: the tracks some steps later, without measurements (paper, eq. (2)).

    Goes by the moments, so that Q may be singular and a static target's is zero.
    """
    means, (covariances, transitions, noises) = tracks.means - tracks.shift, tracks.motion
    for _ in range(steps):
        means = (transitions @ means[:, :, None])[:, :, 0]
        covariances = transitions @ covariances @ transitions.swapaxes(1, 2) + noises
    information = inverses((covariances + covariances.swapaxes(1, 2)) / 2.0)
    y = (information @ means[:, :, None])[:, :, 0]
    return replace(tracks, k0=tracks.k0 + steps, Y=information, y=y)


def update(tracks: Tracks, information: NDArray[np.float64], vector: NDArray[np.float64]) -> Tracks:
    """``Y' = Y + I``, ``y' = y + i``: the tracks after measurements (paper, eqs. (20) and (21)).

    Args:
        tracks: T targets.
        information: (T, 4, 4) sum over the platforms of ``H' R^-1 H``.
        vector: (T, 4) sum over the platforms of ``H' R^-1 (z - h(x) + H (x - o))``, o the tracks' origin.
    """
    return replace(tracks, Y=tracks.Y + information, y=tracks.y + vector)


def nees(tracks: Tracks, truth: ArrayLike) -> NDArray[np.float64]:
    """``e' P^-1 e``, (T,): normalised error squared, chi-square with d degrees if the filter is consistent.

    Args:
        tracks: T targets with d components each.
        truth: (T, 4) true states; what a target does not have is ignored.
    """
    errors = tracks.means - np.asarray(truth, np.float64)
    own = zip(errors, tracks.Y, tracks.models, strict=True)
    squared = [e[: m.d] @ Y[: m.d, : m.d] @ e[: m.d] for e, Y, m in own]
    return np.array(squared, np.float64)

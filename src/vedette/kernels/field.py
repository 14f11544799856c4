"""Gaussian Markov random fields on a grid: banded Cholesky factors, parts of the inverse, what ways gain.

A symmetric matrix of half bandwidth b is an array (n, b + 1) of its lower rows: entry (i, j) with
i - b <= j <= i is number j - i + b of row i; what would lie left of the first column is 0.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vedette import _kernels

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Rows:
    """Sparse rows: row r has ``columns[starts[r] : starts[r + 1]]``, none of them twice, with ``weights``."""

    starts: Indices  # (m + 1,) from 0 up
    columns: Indices
    weights: Floats

    @property
    def arrays(self) -> tuple[Indices, Indices, Floats]:
        """All of it, as the kernels take it."""
        return self.starts, self.columns, self.weights


def factor(band: Floats, rows: Rows, information: Floats) -> tuple[Floats, float]:
    """Return the factor L of ``A + W' diag(information) W``, banded as A is, and the sum's ``ln det``.

    Raises:
        ValueError: not positive definite, or a row of W reaches beyond the band.
    """
    return _kernels.field_factor(band, *rows.arrays, information)


def covariance(factor: Floats, rows: Rows) -> Floats:
    """``H A^-1 H'``, (m, m), of sparse rows H."""
    return _kernels.field_covariance(factor, *rows.arrays)


def variances(factor: Floats) -> Floats:
    """Return the diagonal of ``A^-1``, (n,)."""
    return _kernels.field_variances(factor)


def gains(covariance: Floats, ways: Rows) -> Floats:
    """``1/2 ln det(I + R C R)`` of each way: its places among C's, and the diagonal of R there."""
    return _kernels.field_gains(covariance, *ways.arrays)

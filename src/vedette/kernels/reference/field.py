"""The kernels of fields in plain Python: their specification, and the oracle of their tests."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vedette.kernels.field import Rows

Floats = NDArray[np.float64]


def whole(band: Floats) -> Floats:
    """Return the symmetric matrix (n, n) of a band."""
    n, width = band.shape[0], band.shape[1] - 1
    matrix = np.zeros((n, n))
    for i in range(n):
        for j in range(max(0, i - width), i + 1):
            matrix[i, j] = matrix[j, i] = band[i, j - i + width]
    return matrix


def dense(rows: Rows, n: int) -> Floats:
    """Return sparse rows as a matrix (m, n)."""
    matrix = np.zeros((len(rows.starts) - 1, n))
    for r, (start, end) in enumerate(zip(rows.starts[:-1], rows.starts[1:], strict=True)):
        matrix[r, rows.columns[start:end]] = rows.weights[start:end]
    return matrix


def factor(band: Floats, rows: Rows, information: Floats) -> tuple[Floats, float]:
    """As ``vedette.kernels.field.factor``."""
    n, width = band.shape[0], band.shape[1] - 1
    weights = dense(rows, n)
    matrix = whole(band) + weights.T @ np.diag(information) @ weights
    try:
        lower = np.linalg.cholesky(matrix)
    except np.linalg.LinAlgError as error:
        raise ValueError("the matrix is not positive definite") from error
    banded = np.zeros_like(band)
    for i in range(n):
        for j in range(max(0, i - width), i + 1):
            banded[i, j - i + width] = lower[i, j]
    return banded, float(2.0 * np.log(np.diag(lower)).sum())


def covariance(factor: Floats, rows: Rows) -> Floats:
    """As ``vedette.kernels.field.covariance``."""
    lower = np.tril(whole(factor))
    half = np.linalg.solve(lower, dense(rows, len(lower)).T)
    return np.asarray(half.T @ half)


def variances(factor: Floats) -> Floats:
    """As ``vedette.kernels.field.variances``."""
    lower = np.tril(whole(factor))
    return np.asarray(np.diag(np.linalg.inv(lower @ lower.T)))


def gains(covariance: Floats, ways: Rows) -> Floats:
    """As ``vedette.kernels.field.gains``."""
    out = []
    for root in dense(ways, len(covariance)):
        inner = np.eye(len(root)) + root[:, None] * covariance * root
        out.append(0.5 * np.linalg.slogdet(inner)[1])
    return np.array(out, np.float64)

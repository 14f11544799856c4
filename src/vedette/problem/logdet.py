"""Information about a Gaussian state: what the team's measurements take off its entropy."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from vedette.errors import InputError
from vedette.problem.arrays import first_misfit, misfit
from vedette.problem.objective import Objective

_ROUNDING = 1e-9  # of a matrix, as a share of its largest number


class LogDet(Objective[NDArray[np.float64], NDArray[np.float64]]):
    """``psi(I) = 1/2 ln det(Y + I) - 1/2 ln det Y`` [nat], with ``*`` the sum of information matrices.

    Belief: the prior information matrix ``Y = P^-1``, (d, d), positive definite. Impact: ``H' R^-1 H`` of a
    platform's measurement, (d, d), positive semi-definite. The paper maximises ``det(Y + I)``, which has the
    same best choice; the logarithm is the entropy removed, and is submodular.
    Source: paper, eqs. (23)-(28); docs/theory.md (V4).
    """

    monotone = True
    submodular = True

    def nothing(self, belief: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the zero matrix."""
        return np.zeros_like(belief, dtype=np.float64)

    def combine(self, a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return ``a + b``: information of independent measurements adds."""
        return a + b  # paper, eq. (27)

    def remove(self, total: NDArray[np.float64], own: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return ``total - own`` (paper, eq. (31) and its footnote 2)."""
        return total - own

    def value(self, belief: NDArray[np.float64], impact: NDArray[np.float64]) -> float:
        """Return the entropy removed [nat]."""
        return float(_half_log_det(belief + impact) - _half_log_det(belief))

    def values(
        self, belief: NDArray[np.float64], others: NDArray[np.float64], own: Sequence[NDArray[np.float64]]
    ) -> NDArray[np.float64]:
        """Return the entropy removed with each own impact [nat], by one stacked factorisation."""
        if len(own) == 0:
            return np.empty(0)
        return _half_log_det(belief + others + np.stack(own)) - _half_log_det(belief)

    def wrong_belief(self, belief: NDArray[np.float64]) -> str | None:
        """The prior is square, symmetric and positive definite."""
        if (wrong := misfit(belief, "information", dtype=np.float64)) is not None:
            return wrong
        if belief.ndim != 2 or belief.shape[0] != belief.shape[1] or belief.size == 0:
            return f"information must be a square matrix; got shape {belief.shape}"
        if _skewed(belief):
            return _skew(belief)
        if _singular(belief):
            least = np.linalg.eigvalsh(belief)[0]
            return f"information must be positive definite; its least eigenvalue is {least:.6g}"
        return None

    def wrong_impact(
        self, belief: NDArray[np.float64], own: Sequence[NDArray[np.float64]]
    ) -> tuple[int, str] | None:
        """Information is symmetric, positive semi-definite but for rounding, and of the prior's size."""
        if (wrong := first_misfit(own, "information", belief.shape, dtype=np.float64)) is not None:
            return wrong
        stacked = np.stack(own)
        for k in np.flatnonzero(_skewed(stacked))[:1]:
            return int(k), _skew(stacked[k])
        eigenvalues = np.linalg.eigvalsh(stacked)  # (K, d), ascending
        for k in np.flatnonzero(eigenvalues[:, 0] < -_ROUNDING * np.abs(eigenvalues[:, -1]))[:1]:
            least = eigenvalues[k, 0]
            return int(k), f"information must be positive semi-definite; its least eigenvalue is {least:.6g}"
        return None


def _singular(matrix: NDArray[np.float64]) -> bool:
    """Return whether only rounding, if anything, makes a symmetric matrix positive definite, in any units."""
    diagonal = matrix.diagonal()
    if diagonal.min() <= 0.0:
        return True
    scale = 1.0 / np.sqrt(diagonal)
    least = np.linalg.eigvalsh(matrix * scale[:, None] * scale)[0]
    return bool(least <= len(matrix) * np.finfo(np.float64).eps)


def _skewed(matrices: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return for one or a stack of square matrices whether it is not symmetric but for rounding."""
    apart = np.abs(matrices - np.swapaxes(matrices, -1, -2)).max(axis=(-2, -1))
    return np.asarray(apart > _ROUNDING * np.abs(matrices).max(axis=(-2, -1)))


def _skew(matrix: NDArray[np.float64]) -> str:
    """Return where a square matrix is least symmetric."""
    worst = int(np.argmax(np.abs(np.triu(matrix) - np.tril(matrix).T)))
    i, j = divmod(worst, len(matrix))
    return f"information must be symmetric; got {matrix[i, j]} at [{i}, {j}] and {matrix[j, i]} at [{j}, {i}]"


def _half_log_det(information: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return ``1/2 ln det`` of one (d, d) or a stack of (K, d, d) information matrices."""
    sign, log_det = np.linalg.slogdet(information)
    if not np.all(sign > 0):
        raise InputError("LogDet: the information matrix must be positive definite; give a proper prior")
    return np.asarray(0.5 * log_det, dtype=np.float64)

"""Information about a Gaussian state: what the team's measurements take off its entropy."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from vedette.errors import InputError
from vedette.problem.objective import Objective


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


def _half_log_det(information: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return ``1/2 ln det`` of one (d, d) or a stack of (K, d, d) information matrices."""
    sign, log_det = np.linalg.slogdet(information)
    if not np.all(sign > 0):
        raise InputError("LogDet: the information matrix must be positive definite; give a proper prior")
    return np.asarray(0.5 * log_det, dtype=np.float64)

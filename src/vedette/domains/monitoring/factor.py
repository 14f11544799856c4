"""Sparse positive definite matrices, factorised once: log-determinants, solutions, parts of the inverse."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.linalg import splu

from vedette.errors import InputError

Floats = NDArray[np.float64]


class Factor:
    """``P A P' = L D L'`` by SuperLU in its symmetric mode, without pivoting.

    Raises:
        InputError: the matrix is not positive definite.
    """

    def __init__(self, matrix: sp.csc_matrix, what: str = "precision") -> None:
        """Factorise a symmetric matrix (n, n)."""
        options = {"SymmetricMode": True}
        try:
            self._lu = splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options)
            pivots = self._lu.U.diagonal()
        except RuntimeError:  # singular
            pivots = np.zeros(1)
        if not (pivots > 0.0).all():  # Sylvester: as many positive eigenvalues as pivots
            raise InputError(f"{what} is not positive definite; its least pivot is {pivots.min():.3g}")
        self.log_det = float(np.log(pivots).sum())

    def solve(self, right: Floats) -> Floats:
        """Return ``A^-1 b``, for one right side (n,) or many (n, m)."""
        solution: Floats = self._lu.solve(right)
        return solution

"""Expected coverage: what the team learns where at least one platform sees (paper, eqs. (38)-(41))."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from vedette.errors import InputError
from vedette.problem.arrays import LARGEST, first_misfit, misfit
from vedette.problem.objective import Objective

_UNIT = 2.0**-32  # of a counted log-miss [nat]: fine enough to be invisible, coarse enough never to overflow
_MOST = 2**42  # of an impact: the log-miss of the least float, 2^41.5 units, is below
_MISSES = "miss probabilities"


class Coverage(Objective[NDArray[np.float64], NDArray[np.float64]]):
    """``psi(m) = sum_s w(s) (1 - m(s))``, with ``*`` the element-wise product of miss probabilities.

    Belief: weights ``w >= 0``, any shape, say the entropy of each cell [nat], or (layers, cells) with the
    weight of seeing a cell in a time layer. Impact: the probability in [0, 1] that a platform misses each
    cell, same shape. The probabilities count as independent, so that overlap is priced softly.
    Source: paper, eqs. (39)-(41), in gain form; docs/theory.md (V3).
    """

    monotone = True
    submodular = True

    def nothing(self, belief: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return ones: everything is missed."""
        return np.ones_like(belief, dtype=np.float64)

    def combine(self, a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return ``a * b`` element-wise: missed by both."""
        return a * b  # paper, eq. (40)

    def value(self, belief: NDArray[np.float64], impact: NDArray[np.float64]) -> float:
        """Return ``sum w (1 - m)``."""
        return float(np.vdot(belief, 1.0 - impact))  # paper, eq. (41)

    def values(
        self, belief: NDArray[np.float64], others: NDArray[np.float64], own: Sequence[NDArray[np.float64]]
    ) -> NDArray[np.float64]:
        """Return ``value(others) + sum (w others) (1 - own_k)`` for every k."""
        left = belief * others  # what the rest of the team would leave
        gains = np.array([np.vdot(left, 1.0 - k) for k in own], dtype=np.float64)
        return self.value(belief, others) + gains

    def thin(self, impact: NDArray[np.float64], chance: float) -> NDArray[np.float64]:
        """Return ``1 - p (1 - m)``: missed by a platform that is there with probability p; (V107)."""
        return 1.0 - chance * (1.0 - impact)

    def wrong_belief(self, belief: NDArray[np.float64]) -> str | None:
        """Weights are finite and not negative."""
        return misfit(belief, "weights", within=(0.0, LARGEST))

    def wrong_impact(
        self, belief: NDArray[np.float64], own: Sequence[NDArray[np.float64]]
    ) -> tuple[int, str] | None:
        """Miss probabilities are in [0, 1], one a weight."""
        return first_misfit(own, _MISSES, belief.shape, (0.0, 1.0))


class CountedCoverage(Objective[NDArray[np.float64], NDArray[np.int64]]):
    """``Coverage`` over a group: certain sightings are counted and log-misses added, so both can be removed.

    A miss probability of 0 has no inverse under the product. As the pair (number of exact zeros, sum of
    ``-ln`` of the others in units of 2^-32 nat) it has: ``*`` is integer addition, exactly associative.
    Impact: int64 of shape (2, ...) where the weights' is (...), made by ``counted``.
    Source: docs/theory.md (V8).
    """

    monotone = True
    submodular = True

    def nothing(self, belief: NDArray[np.float64]) -> NDArray[np.int64]:
        """Return zeros: no certain sighting, no log-miss."""
        return np.zeros((2, *belief.shape), dtype=np.int64)

    def combine(self, a: NDArray[np.int64], b: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return ``a + b``."""
        return a + b

    def remove(self, total: NDArray[np.int64], own: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return ``total - own``, exactly (paper, eq. (31))."""
        return total - own

    def value(self, belief: NDArray[np.float64], impact: NDArray[np.int64]) -> float:
        """Return ``sum w (1 - m)``."""
        return float(np.vdot(belief, seen(impact)))

    def wrong_belief(self, belief: NDArray[np.float64]) -> str | None:
        """Weights are finite and not negative."""
        return misfit(belief, "weights", within=(0.0, LARGEST))

    def wrong_impact(
        self, belief: NDArray[np.float64], own: Sequence[NDArray[np.int64]]
    ) -> tuple[int, str] | None:
        """Impacts are as ``counted`` makes them."""
        return first_misfit(own, "impacts by counted()", (2, *belief.shape), (0, _MOST), np.int64)


def counted(miss: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return miss probabilities of shape (...) as ``CountedCoverage`` takes them: int64 of shape (2, ...).

    Raises:
        InputError: no array, or a probability outside [0, 1].
    """
    if (wrong := misfit(miss, _MISSES, within=(0.0, 1.0))) is not None:
        raise InputError(f"counted: {wrong}")
    zeros = miss == 0.0
    log_miss = np.rint(-np.log(np.where(zeros, 1.0, miss)) / _UNIT)
    return np.stack((zeros.astype(np.int64), log_miss.astype(np.int64)))


def seen(impact: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return the probability ``1 - m`` (...) that each cell is seen, of an impact (2, ...) of ``counted``.

    ``m = 0`` where a sighting is certain, else ``exp(-log-miss)``.
    """
    zeros, log_miss = impact
    return np.where(zeros > 0, 1.0, -np.expm1(-_UNIT * log_miss))

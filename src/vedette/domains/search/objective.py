"""The team's search objective: the probability that somebody detects the target, by when."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from vedette.domains.search.belief import SearchBelief
from vedette.domains.search.impact import NOTHING, Impact, clip
from vedette.domains.search.paths import shared_paths
from vedette.kernels import coverage, search
from vedette.problem import Objective, Reach


class SearchObjective(Objective[SearchBelief, Impact]):
    """``psi = sum_k w_k d_k = E[w(first detection)]``, d_k as in docs/search.md (V43), psi as in (V45).

    ``d_k = sum_x q_k (1 - m_k)``, ``q_0 = T p``, ``q_{k+1} = T (q_k m_k)``, ``m_k = prod_i m_{i,k}``: the
    forward filter of a target that nobody has detected. For a target that stays T = 1, and this is the
    paper's eq. (41) with P(x) for H_s, by time.

    Monotone and submodular: given the target's path ``x_0, x_1, ...`` psi is
    ``sum_k (w_k - w_{k+1}) (1 - exp(-sum_{j <= k} min(C, sum_i l_{i,j}(x_j))))`` with l the log-misses and C
    where they saturate. The cut sum is monotone and submodular in the set of platforms i; so is an increasing
    concave function of it, a sum of those with ``w_k - w_{k+1} >= 0``, and the mean over paths, which is psi;
    docs/search.md (V46).
    """

    monotone = True
    submodular = True

    def nothing(self, belief: SearchBelief) -> Impact:
        """Return the impact of a team that does not look."""
        return NOTHING

    def combine(self, a: Impact, b: Impact) -> Impact:
        """``a * b``: products of misses, as saturating sums of log-misses; paper, eq. (40); (V44)."""
        return Impact(*coverage.combine(*a.sparse, *b.sparse, layers=1))

    def clip(self, belief: SearchBelief, impact: Impact, reach: Reach) -> Impact:
        """Return what can matter to platforms that look within ``reach`` only; docs/theory.md (V14)."""
        return clip(impact, belief.frame, belief.layers, reach)

    def value(self, belief: SearchBelief, impact: Impact) -> float:
        """``sum_k w_k d_k``, at most 1 with the weights of ``worth``."""
        return float(belief.worth.weights @ self.detected(belief, impact))

    def values(self, belief: SearchBelief, others: Impact, own: Sequence[Impact]) -> NDArray[np.float64]:
        """``value(others * own_k)`` for every k, by one kernel call on the looks that they share."""
        paths, ends = shared_paths(own, belief.layers)
        gains = search.path_gains(
            belief.mass, belief.stencil, belief.horizon, belief.worth.weights, others.sparse, paths
        )
        return self.value(belief, others) + gains[ends]

    def detected(self, belief: SearchBelief, impact: Impact) -> NDArray[np.float64]:
        """``d_k``, ``(layers,)``: probability that the target is first detected in each layer."""
        return search.detected_mass(
            belief.mass, belief.stencil, belief.horizon, belief.layers, *impact.sparse
        )

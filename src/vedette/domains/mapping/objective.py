"""The team's mapping objective: the entropy that its strategies are expected to remove, less their prices."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from vedette.domains.mapping.belief import MapBelief
from vedette.domains.mapping.impact import NOTHING, PRICE_STEPS, Impact
from vedette.kernels import coverage
from vedette.kernels.coverage import LAYERS
from vedette.problem import Objective, Reach


class MappingObjective(Objective[MapBelief, Impact]):
    """``psi(impact) = sum_s H_s sum_b w_b (1 - prod_i m_i(s, b)) - sum_i c_i``  [nats].

    With one layer this is the paper's eq. (41) in gain form; with weights ``1/t_b - 1/t_{b+1}`` it is its eq.
    (42) made exactly partially separable.  docs/mapping.md (V21)-(V23), docs/theory.md (V190)
    """

    monotone = True
    submodular = True

    def nothing(self, belief: MapBelief) -> Impact:
        """Return the impact of a team that observes nothing."""
        return NOTHING

    def combine(self, a: Impact, b: Impact) -> Impact:
        """``a * b``: products of misses, as saturating sums of log-misses; prices add; paper, eq. (40)."""
        return Impact(*coverage.combine(*a.sparse, *b.sparse), a.price + b.price)

    def clip(self, belief: MapBelief, impact: Impact, reach: Reach) -> Impact:
        """Return what lies in planning cells that a box touches, in all layers, at its price; (V14)."""
        frame = belief.planning
        boxes = [(frame.cell(x0, y0), frame.cell(x1, y1)) for x0, y0, x1, y1 in reach]
        return Impact(*impact.within(LAYERS, frame.cols, boxes).sparse, impact.price)

    def value(self, belief: MapBelief, impact: Impact) -> float:
        """Expected weighted entropy reduction, less the price [nats]."""
        return float(self._marginals(belief, NOTHING, [impact])[0])

    def price(self, impact: Impact) -> float:
        """Return what it costs [nats]."""
        return impact.price / PRICE_STEPS

    def values(self, belief: MapBelief, others: Impact, own: Sequence[Impact]) -> NDArray[np.float64]:
        """``value(others * own_k)`` for every k, by one kernel call."""
        return self.value(belief, others) + self._marginals(belief, others, own)

    def _marginals(self, belief: MapBelief, others: Impact, own: Sequence[Impact]) -> NDArray[np.float64]:
        starts = np.cumsum([0, *(len(impact.keys) for impact in own)], dtype=np.int64)
        keys = np.concatenate([NOTHING.keys, *(impact.keys for impact in own)])
        misses = np.concatenate([NOTHING.misses, *(impact.misses for impact in own)])
        weights = belief.weights, belief.layers.weights
        gains = coverage.marginals(*weights, others.sparse, starts, keys, misses)
        return gains - [self.price(impact) for impact in own]

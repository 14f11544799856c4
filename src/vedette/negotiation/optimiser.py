"""A platform that replies by optimising a continuous control."""

from __future__ import annotations

import math
from collections.abc import Hashable
from typing import cast

import numpy as np
from numpy.typing import NDArray

from vedette.negotiation.valued import Valued
from vedette.problem.checked import value_of
from vedette.problem.controls import Controls
from vedette.problem.objective import BeliefT, ImpactT, Objective

Float = NDArray[np.float64]

_BESIDE = 1e-3  # where it is flat, a control is tried so far to either side, as a share of what it can be


class Optimiser(Valued[BeliefT, ImpactT]):
    """``u <- argmax psi(Y(u) * a_{-i})`` over a box, from the present control uphill (paper, eq. (30)).

    A reply counts if the control changes by more than its threshold, and the value rises (paper, Table 1,
    step 6). It is the nearest top, the best of all where J is concave in u. A strategy is a tuple of
    numbers. Source: docs/theory.md (V103).
    """

    def __init__(
        self,
        objective: Objective[BeliefT, ImpactT],
        belief: BeliefT,
        controls: Controls[ImpactT],
        *,
        base: float = 0.0,
    ) -> None:
        """Sit down at the start; ``base``: ``psi`` of nothing, if that is not 0."""
        super().__init__(objective, belief, base)
        self._controls = controls
        self._take(controls.start.copy())

    @property
    def strategy(self) -> tuple[float, ...]:
        """Present control."""
        return tuple(self.control.tolist())

    def adopt(self, strategy: Hashable) -> None:
        """Take up a control that this platform had before."""
        self._take(np.array(cast("tuple[float, ...]", strategy)))

    def reply(self, others: ImpactT) -> bool:
        """Climb against the rest of the team; tell if the control has changed by more than the threshold."""
        from scipy.optimize import Bounds, OptimizeResult, minimize  # takes long to import

        low, width = self._controls.low, self._controls.high - self._controls.low
        scale = max(abs(self._worth(self.control, others)), 1e-300)

        def depth(share: Float) -> float:
            return -self._worth(low + share * width, others) / scale

        def climbed(begin: Float) -> OptimizeResult:
            return minimize(
                depth, begin, method="L-BFGS-B", jac="3-point", bounds=Bounds(0.0, 1.0),
                options={"ftol": 1e-16, "gtol": 1e-12},
            )  # fmt: skip

        begin = (self.control - low) / width
        here, found = depth(begin), climbed(begin)
        if not found.fun < here:  # flat: a top, or the bottom between two
            moves = _BESIDE * np.eye(len(begin))
            beside = min(np.clip(begin + np.vstack((moves, -moves)), 0.0, 1.0), key=depth)
            found = climbed(beside) if depth(beside) < here else found
        best = np.clip(low + found.x * width, low, self._controls.high)
        if np.abs(best - self.control).max() <= self._controls.threshold or not found.fun < here:
            return False
        self._take(best)
        return True

    def _take(self, control: Float) -> None:
        self.control, self.impact = control, self._controls.impact(control.copy())

    def _worth(self, control: Float, others: ImpactT) -> float:
        """``psi(Y(u) * a_{-i})``."""
        impact = self._controls.impact(np.clip(control, self._controls.low, self._controls.high))
        return value_of(self._objective, self._belief, self._objective.combine(others, impact))

    def slack(self, base: ImpactT) -> float:
        """Infinite: nobody has looked at all controls."""
        return math.inf

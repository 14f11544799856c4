"""Does the paper's condition for its simultaneous replies to converge hold?"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import reduce

import numpy as np
from numpy.typing import NDArray

from vedette.errors import InputError, brief
from vedette.number import is_whole
from vedette.problem.checked import value_of
from vedette.problem.controls import Controls
from vedette.problem.door import check_belief, check_impacts, check_list
from vedette.problem.objective import BeliefT, ImpactT, Objective

Float = NDArray[np.float64]

_STEP = 1e-3  # of the differences, as a share of what a control can be


@dataclass(frozen=True, eq=False)
class Dominance:
    """How the Hessian of the team's value by all controls compares with its diagonal, where that is worst."""

    share: float  # largest sum of a row beside the diagonal over it; infinite where J is not concave
    platform: int  # whose row that is
    at: tuple[Float, ...]  # everybody's control there

    @property
    def holds(self) -> bool:
        """Whether the diagonal dominates at all points looked at: Jacobi must converge if it does at all."""
        return self.share < 1.0


def diagonally_dominant(
    objective: Objective[BeliefT, ImpactT],
    belief: BeliefT,
    controls: Sequence[Controls[ImpactT]],
    *,
    points: int = 20,
    seed: int = 0,
) -> Dominance:
    """``-J_rr > sum_{c != r} |J_rc|`` in every row, by central differences at points of the box.

    With it everywhere, simultaneous best replies contract in the largest norm, so ``jacobi`` converges,
    to the optimum. Without it they need not, however concave J is; the token does not depend on it. The
    points are everybody's start and random ones: a J whose curvature changes between them may be missed. The
    condition depends on the controls' units. Source: paper, section 3.4; docs/theory.md (V104).

    Args:
        objective: the team's ``*`` and ``psi``.
        belief: what the value depends on.
        controls: each platform's.
        points: looked at, the start among them.
        seed: of the others.

    Raises:
        InputError: bad arguments, or an objective whose value is not a finite number.
    """
    check_belief(objective, belief)
    check_list(controls, "controls", "each platform's Controls")
    if len(controls) == 0 or not all(isinstance(own, Controls) for own in controls):
        raise InputError("controls must hold a Controls for each platform, and at least one")
    for i, own in enumerate(controls):
        check_impacts(objective, belief, own.examples, f"controls[{i}]: impact")
    if not is_whole(points) or points < 1:
        raise InputError(f"points must be a whole number >= 1; got {brief(points)}")
    if not is_whole(seed) or seed < 0:
        raise InputError(f"seed must be a whole number >= 0; got {brief(seed)}")
    low, high, start = (
        np.concatenate([getattr(c, end) for c in controls]) for end in ("low", "high", "start")
    )
    cuts = np.cumsum([len(own.low) for own in controls])[:-1]
    rng = np.random.default_rng(seed)
    tried = np.vstack((start, rng.uniform(low, high, (points - 1, len(low)))))
    step = _STEP * (high - low)
    rows = np.repeat(np.arange(len(controls)), [len(own.low) for own in controls])

    def value(u: Float) -> float:
        impacts = [own.impact(part) for own, part in zip(controls, np.split(u, cuts), strict=True)]
        return value_of(objective, belief, reduce(objective.combine, impacts))

    worst = Dominance(-math.inf, 0, ())
    for point in np.clip(tried, low + 2.0 * step, high - 2.0 * step):
        hessian = _hessian(value, point, step)
        diagonal = np.diag(hessian)
        beside = np.abs(hessian).sum(axis=1) - np.abs(diagonal)
        shares = np.where(diagonal < 0.0, beside / np.maximum(-diagonal, 1e-300), np.inf)
        row = int(np.argmax(shares))
        if shares[row] > worst.share:
            worst = Dominance(float(shares[row]), int(rows[row]), tuple(np.split(point, cuts)))
    return worst


def _hessian(value: Callable[[Float], float], point: Float, step: Float) -> Float:
    """Return the second derivatives (D, D) by central differences."""
    here, moves = value(point), np.diag(step)
    along = np.array([[value(point + sign * move) for sign in (1.0, -1.0)] for move in moves])
    hessian = np.diag((along.sum(axis=1) - 2.0 * here) / step**2)
    for r in range(len(point)):
        for c in range(r):
            corners = [
                sign * value(point + one * moves[r] + other * moves[c])
                for one, other, sign in ((1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1))
            ]
            hessian[r, c] = hessian[c, r] = sum(corners) / (4.0 * step[r] * step[c])
    return hessian

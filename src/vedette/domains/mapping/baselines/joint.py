"""The best joint choice, found without looking at those that cannot be better."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from vedette.domains.mapping.belief import MapBelief
from vedette.domains.mapping.impact import Impact
from vedette.domains.mapping.objective import MappingObjective

_OBJECTIVE = MappingObjective()
_ROUNDING = 1e-9  # relative: no better than this is no better


def joint_optimum(belief: MapBelief, candidates: Sequence[Sequence[Impact]]) -> tuple[tuple[int, ...], float]:
    """``max_v psi(Y_1(v_1) * ... * Y_n(v_n))`` over all joint choices (paper, eq. (16)), by branch and bound.

    Robots choose one after the other, the best first. What those still to come could each add alone is no
    less than what they add together, so a branch that cannot pass the best choice so far is cut: nothing is
    lost.
    docs/theory.md (V63)

    Args:
        belief: what the value depends on.
        candidates: ``candidates[i]``, not empty, is the list of robot i's impacts.

    Returns:
        The index of each robot's candidate, and the value [nats].
    """
    best: tuple[tuple[int, ...], float] = (), -np.inf

    def visit(choice: tuple[int, ...], team: Impact, value: float) -> None:
        nonlocal best
        depth = len(choice)
        if depth == len(candidates):
            best = choice, value
            return
        values = [_OBJECTIVE.values(belief, team, own) for own in candidates[depth:]]
        later = sum(float(own.max()) - value for own in values[1:])
        for k in _best_first(values[0]):
            if values[0][k] + later <= best[1] * (1.0 + _ROUNDING):
                return
            visit((*choice, k), _OBJECTIVE.combine(team, candidates[depth][k]), float(values[0][k]))

    visit((), _OBJECTIVE.nothing(belief), 0.0)
    return best


def _best_first(values: NDArray[np.float64]) -> list[int]:
    order: list[int] = np.argsort(-values, kind="stable").tolist()
    return order

"""The guarded way to call a user's objective: bad numbers and bad candidate lists stop here."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from vedette.errors import InputError
from vedette.problem.objective import BeliefT, ImpactT, Objective


def value_of(objective: Objective[BeliefT, ImpactT], belief: BeliefT, impact: ImpactT) -> float:
    """Return ``objective.value``; ``InputError`` if it is not a finite number."""
    value = float(objective.value(belief, impact))
    if not math.isfinite(value):
        raise InputError(f"{type(objective).__name__}.value returned {value}; values must be finite")
    return value


def values_of(
    objective: Objective[BeliefT, ImpactT], belief: BeliefT, others: ImpactT, own: Sequence[ImpactT]
) -> NDArray[np.float64]:
    """Return ``objective.values``, shape (K,); ``InputError`` if the shape or a number is wrong."""
    values = np.asarray(objective.values(belief, others, own), dtype=np.float64)
    name = f"{type(objective).__name__}.values"
    if values.shape != (len(own),):
        raise InputError(f"{name} returned shape {values.shape} for {len(own)} impacts; want ({len(own)},)")
    finite = np.isfinite(values)
    if not finite.all():
        k = int(np.argmin(finite))
        raise InputError(f"{name} returned {values[k]} for own[{k}]; values must be finite")
    return values


def check_candidates(candidates: Sequence[Sequence[ImpactT]]) -> None:
    """Raise ``InputError`` unless the team has a platform and every platform has a candidate."""
    if len(candidates) == 0:
        raise InputError("candidates is empty: a team needs at least one platform")
    for i, own in enumerate(candidates):
        if len(own) == 0:
            raise InputError(
                f"candidates[{i}] is empty: give platform {i} at least one impact, "
                "objective.nothing(belief) if it can do nothing"
            )

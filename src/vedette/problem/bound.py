"""How far from the optimum a choice can be, without knowing the optimum."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import reduce

from vedette.errors import InputError
from vedette.problem.checked import check_candidates, value_of, values_of
from vedette.problem.objective import BeliefT, ImpactT, Objective


def slack(
    objective: Objective[BeliefT, ImpactT], belief: BeliefT, base: ImpactT, own: Sequence[ImpactT]
) -> float:
    """``max_k [psi(base * own_k) - psi(base)]``: the most that one platform could add to ``base``.

    Infinite unless the objective declares itself monotone and submodular: then nothing is promised.
    Source: docs/theory.md (V12).
    """
    if not (objective.monotone and objective.submodular):
        return math.inf
    gain = float(values_of(objective, belief, base, own).max()) - value_of(objective, belief, base)
    return max(gain, 0.0)  # below 0 only by rounding


def bound(
    objective: Objective[BeliefT, ImpactT],
    belief: BeliefT,
    candidates: Sequence[Sequence[ImpactT]],
    choice: Sequence[int],
) -> float | None:
    """``min_B {psi(B) + sum_i slack_i(B)}`` over B = nobody, B = the team at ``choice``: optimum <= bound.

    The first is tight where the platforms do not interact, the second where they have covered what there is.
    ``None`` unless the objective is monotone and submodular. Source: docs/theory.md (V12).

    Raises:
        InputError: no platform, a platform without candidates, a choice that is not one index per platform.
    """
    check_candidates(candidates)
    if len(choice) != len(candidates):
        raise InputError(f"choice has {len(choice)} indexes for {len(candidates)} platforms; give one each")
    for i, (k, own) in enumerate(zip(choice, candidates, strict=True)):
        if not 0 <= k < len(own):
            raise InputError(f"choice[{i}] = {k}, but platform {i} has candidates 0 to {len(own) - 1}")
    nobody = objective.nothing(belief)
    chosen = [own[k] for k, own in zip(choice, candidates, strict=True)]
    team = reduce(objective.combine, chosen, nobody)
    value = value_of(objective, belief, team)
    ceiling = sum(slack(objective, belief, nobody, own) for own in candidates)
    above = value + sum(slack(objective, belief, team, own) for own in candidates)
    return tightest(value, ceiling, above)


def attains(value: float, most: float, epsilon: float) -> bool:
    """``value >= most - epsilon |value|``: all but a share is reached, in whatever unit values are."""
    return value >= most - epsilon * abs(value)


def tightest(value: float, *bounds: float) -> float | None:
    """Return the smallest finite bound, not below ``value`` by rounding; ``None`` if there is none."""
    least = min(bounds)
    return max(value, least) if math.isfinite(least) else None

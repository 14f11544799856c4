"""How far from the optimum a choice can be, without knowing the optimum."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import reduce

from vedette.errors import InputError
from vedette.problem.checked import value_of, values_of
from vedette.problem.door import check_belief, check_choice, check_own, check_problem
from vedette.problem.objective import BeliefT, ImpactT, Objective
from vedette.problem.trial import Trial

MOST_VALUE = 1e100  # that platforms tell each other


def slack(
    objective: Objective[BeliefT, ImpactT], belief: BeliefT, base: ImpactT, own: Sequence[ImpactT]
) -> float:
    """``max_k [psi(base * own_k) - psi(base)]``: the most that one platform could add to ``base``.

    Infinite unless the objective declares itself monotone and submodular: then nothing is promised.
    Source: docs/theory.md (V12).

    Raises:
        InputError: bad arguments, or an objective whose value is not a finite number.
    """
    check_belief(objective, belief)
    check_own(objective, belief, own, "own", "the platform")
    if (wrong := objective.wrong_impact(belief, [base])) is not None:
        raise InputError(f"base: {wrong[1]}")
    return slack_of(objective, belief, base, own)


def slack_of(
    objective: Objective[BeliefT, ImpactT], belief: BeliefT, base: ImpactT, own: Sequence[ImpactT]
) -> float:
    """Return `slack` of what has been checked."""
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
    """``min_B {gross(B) + sum_i slack_i(B)}`` over B = nobody, B = the team at ``choice``: optimum <= bound.

    The first is tight where the platforms do not interact, the second where they have covered what there is.
    ``None`` unless the objective is monotone and submodular. Source: docs/theory.md (V12), (V193).

    Raises:
        InputError: as `negotiate`, or a choice that is not one index per platform.
    """
    check_problem(objective, belief, candidates)
    choice = check_choice(choice, candidates, "choice")
    Trial(objective, belief, candidates).laws()
    nobody = objective.nothing(belief)
    chosen = [own[k] for k, own in zip(choice, candidates, strict=True)]
    team = reduce(objective.combine, chosen, nobody)
    value = value_of(objective, belief, team) - value_of(objective, belief, nobody)
    ceiling = sum(slack_of(objective, belief, nobody, own) for own in candidates)
    above = value + objective.price(team) + sum(slack_of(objective, belief, team, own) for own in candidates)
    return tightest(value, ceiling, above)


def attains(value: float, most: float, epsilon: float) -> bool:
    """``value >= most - epsilon |value|``: all but a share is reached, in whatever unit values are."""
    return value >= most - epsilon * abs(value)


def tightest(value: float, *bounds: float) -> float | None:
    """Return the smallest bound, not below ``value`` by rounding; ``None`` if none can be told of."""
    least = min(bounds)
    return max(value, least) if least <= MOST_VALUE else None

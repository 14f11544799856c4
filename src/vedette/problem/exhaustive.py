"""The optimum by trying everything: the reference that every scheme is measured against."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from vedette.errors import InputError
from vedette.problem.checked import value_of, values_of
from vedette.problem.door import check_problem
from vedette.problem.objective import BeliefT, ImpactT, Objective
from vedette.problem.trial import Trial

MOST_COMBINATIONS = 2_000_000  # about a minute of Python


@dataclass(frozen=True)
class Exhaustive:
    """The best joint choice, the lexicographically first among equals."""

    choice: tuple[int, ...]  # candidate index of each platform
    value: float  # over nothing, in the objective's unit


def exhaustive(
    objective: Objective[BeliefT, ImpactT], belief: BeliefT, candidates: Sequence[Sequence[ImpactT]]
) -> Exhaustive:
    """``max_v psi(Y_1(v_1) * ... * Y_n(v_n))`` over all joint choices (paper, eq. (16)).

    Args:
        objective: the team's ``*`` and ``psi``.
        belief: what the value depends on.
        candidates: ``candidates[i]`` is the list of platform i's impacts.

    Raises:
        InputError: as `negotiate`, or more than two million combinations.
    """
    check_problem(objective, belief, candidates)
    combinations = math.prod(len(own) for own in candidates)
    if combinations > MOST_COMBINATIONS:
        raise InputError(
            f"exhaustive: {combinations} combinations, at most {MOST_COMBINATIONS}; shorten the lists"
        )
    Trial(objective, belief, candidates).laws()
    best = Exhaustive((), -math.inf)
    before: tuple[int, ...] = ()
    partial = [objective.nothing(belief)]  # partial[i]: platforms 0..i-1 combined
    *first, last = candidates
    for head in itertools.product(*(range(len(own)) for own in first)):
        shared = next((i for i, (a, b) in enumerate(zip(before, head, strict=False)) if a != b), len(before))
        del partial[shared + 1 :]
        for i in range(shared, len(head)):
            partial.append(objective.combine(partial[-1], first[i][head[i]]))
        values = values_of(objective, belief, partial[-1], last)
        k = int(np.argmax(values))
        if values[k] > best.value:
            best = Exhaustive((*head, k), float(values[k]))
        before = head
    return replace(best, value=best.value - value_of(objective, belief, partial[0]))

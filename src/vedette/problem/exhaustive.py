"""The optimum by trying everything: the reference that every scheme is measured against."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vedette.errors import InputError
from vedette.problem.checked import check_candidates, values_of
from vedette.problem.objective import BeliefT, ImpactT, Objective

MOST_COMBINATIONS = 2_000_000  # about a minute of Python


@dataclass(frozen=True)
class Exhaustive:
    """The best joint choice, the lexicographically first among equals."""

    choice: tuple[int, ...]  # candidate index of each platform
    value: float  # in the objective's unit


def exhaustive(
    objective: Objective[BeliefT, ImpactT], belief: BeliefT, candidates: Sequence[Sequence[ImpactT]]
) -> Exhaustive:
    """``max_v psi(Y_1(v_1) * ... * Y_n(v_n))`` over all joint choices (paper, eq. (16)).

    Args:
        objective: the team's ``*`` and ``psi``.
        belief: what the value depends on.
        candidates: ``candidates[i]`` is the list of platform i's impacts.

    Raises:
        InputError: no platform, a platform without candidates, more than two million combinations.
    """
    check_candidates(candidates)
    combinations = math.prod(len(own) for own in candidates)
    if combinations > MOST_COMBINATIONS:
        raise InputError(
            f"exhaustive: {combinations} combinations, at most {MOST_COMBINATIONS}; shorten the lists"
        )
    best = Exhaustive((), -math.inf)
    before: tuple[int, ...] = ()
    partial = [objective.nothing(belief)]  # partial[i]: platforms 0..i-1 combined
    for head in itertools.product(*(range(len(own)) for own in candidates[:-1])):
        shared = next((i for i, (a, b) in enumerate(zip(before, head, strict=False)) if a != b), len(before))
        del partial[shared + 1 :]
        for i in range(shared, len(head)):
            partial.append(objective.combine(partial[-1], candidates[i][head[i]]))
        values = values_of(objective, belief, partial[-1], candidates[-1])
        last = int(np.argmax(values))
        if values[last] > best.value:
            best = Exhaustive((*head, last), float(values[last]))
        before = head
    return best

"""What a team negotiates about is checked once, before anything is computed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from vedette.errors import InputError, brief
from vedette.number import is_whole, many
from vedette.problem.objective import BeliefT, ImpactT, Objective


def check_problem(
    objective: Objective[BeliefT, ImpactT], belief: BeliefT, candidates: Sequence[Sequence[ImpactT]]
) -> None:
    """Raise ``InputError``, naming platform and index, for what nobody can negotiate about.

    That is: what is no objective, a belief or an impact that it is not made for, a team of nobody, a platform
    without impacts.
    """
    check_belief(objective, belief)
    check_list(candidates, "candidates", "a list of every platform's list of impacts")
    if len(candidates) == 0:
        raise InputError("candidates is empty: a team needs at least one platform")
    for i, own in enumerate(candidates):
        check_own(objective, belief, own, f"candidates[{i}]", f"platform {i}")


def check_belief(objective: Objective[BeliefT, ImpactT], belief: BeliefT) -> None:
    """Raise ``InputError`` for what is no objective, or a belief that it is not made for."""
    if not isinstance(objective, Objective):
        if isinstance(objective, type):
            raise InputError(f"objective is the class {objective.__name__}; give {objective.__name__}()")
        raise InputError(f"objective is {brief(objective)}; give an instance of a subclass of Objective")
    if (wrong := objective.wrong_belief(belief)) is not None:
        raise InputError(f"belief: {wrong}")


def check_own(
    objective: Objective[BeliefT, ImpactT], belief: BeliefT, own: Sequence[ImpactT], name: str, whose: str
) -> None:
    """Raise ``InputError`` for no list, an empty one, or an impact that the objective is not made for."""
    check_list(own, name, f"a list of the impacts of {whose}")
    if len(own) == 0:
        raise InputError(
            f"{name} is empty: give {whose} at least one impact, "
            "objective.nothing(belief) if it can do nothing"
        )
    check_impacts(objective, belief, own, name)


def check_impacts(
    objective: Objective[BeliefT, ImpactT], belief: BeliefT, own: Sequence[ImpactT], name: str
) -> None:
    """Raise ``InputError`` for an impact that is None, or that the objective is not made for."""
    for k, impact in enumerate(own):
        if impact is None:
            raise InputError(f"{name}[{k}] is None, which is no impact; objective.nothing(belief) is one")
    if (wrong := objective.wrong_impact(belief, own)) is not None:
        raise InputError(f"{name}[{wrong[0]}]: {wrong[1]}")


def check_choice(choice: Sequence[int], candidates: Sequence[Sequence[Any]], name: str) -> tuple[int, ...]:
    """Return one candidate's index for each platform; ``InputError`` if that is not what is given."""
    check_list(choice, name, "a list of one index for each platform")
    if len(choice) != len(candidates):
        raise InputError(
            f"{name} has {len(choice)} for {many(len(candidates), 'platform')}; give an index each"
        )
    for i, own in enumerate(candidates):
        if not is_whole(choice[i]) or not 0 <= choice[i] < len(own):
            got = choice[i] if is_whole(choice[i]) else brief(choice[i])
            raise InputError(f"{name}[{i}] = {got}, but platform {i} has candidates 0 to {len(own) - 1}")
    return tuple(int(choice[i]) for i in range(len(candidates)))


def check_list(given: object, name: str, want: str) -> None:
    """Raise ``InputError`` for what has no order or no length: text, numbers, sets, generators."""
    ordered = hasattr(given, "__getitem__") and hasattr(given, "__len__") and getattr(given, "ndim", 1) > 0
    if not ordered or isinstance(given, str | bytes | Mapping | type):
        raise InputError(f"{name} is {brief(given)}; give {want}")

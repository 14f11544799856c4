"""An objective on trial, once a negotiation: two impacts show whether it can be believed at all."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import islice
from typing import Any, Generic, TypeVar

import numpy as np

from vedette.errors import InputError
from vedette.problem.alike import copied, equal
from vedette.problem.checked import value_of, values_of
from vedette.problem.objective import BeliefT, ImpactT, Invertible, Objective
from vedette.problem.reach import Clippable, Reach

ResultT = TypeVar("ResultT")

TOLERANCE = 1e-6  # as a share: gross errors only; vedette.testing.check_objective asks for more
MOST_LOOKED_AT = 64  # candidates, for two that are not nothing


class Trial(Generic[BeliefT, ImpactT]):
    """Tries out an objective on copies of two candidates.

    Whether it changes what it is given can be told of what can be copied and compared: arrays, numbers,
    collections, dataclasses, and whatever has an ``==`` of its own.
    """

    def __init__(
        self, objective: Objective[BeliefT, ImpactT], belief: BeliefT, candidates: Sequence[Sequence[ImpactT]]
    ) -> None:
        """Take candidates that have been checked, and two of them that are not nothing if there are."""
        self._objective, self._name = objective, type(objective).__name__
        nothing = self._impact("nothing", objective.nothing(belief))
        (i, k), (j, m) = _two(candidates, nothing)
        self._a_name, self._b_name = f"candidates[{i}][{k}]", f"candidates[{j}][{m}]"
        a, b = candidates[i][k], candidates[j][m]
        self._belief = copied(belief) if isinstance(belief, np.ndarray) else belief
        self._nothing, self._a, self._b = copied(nothing), copied(a), copied(b)
        self._watched: list[tuple[Any, Any]] = [  # what is used, and what it has to stay like
            (self._belief, belief), (self._nothing, nothing), (self._a, a), (self._b, b)
        ]  # fmt: skip

    def laws(self) -> None:
        """Raise ``InputError`` if arguments change, nothing or order matters to ``*`` or psi is no number."""
        combine, e, a, b = self._objective.combine, self._nothing, self._a, self._b
        alone = self._impact("combine", self._call("combine", combine, e, a))
        self._watched.append((alone, copied(alone)))
        both, reverse = self._call("combine", combine, a, b), self._call("combine", combine, b, a)
        for impact in (e, both):
            self._call("value", value_of, self._objective, self._belief, impact)
        self._call("values", values_of, self._objective, self._belief, a, [a, b])
        self._same(alone, a, f"combine(nothing, {self._a_name})", self._a_name)
        self._same(both, reverse, f"combine({self._a_name}, {self._b_name})", "the reverse")

    def inverse(self) -> None:
        """Raise ``InputError`` if ``remove`` changes an argument, or does not undo ``combine``."""
        assert isinstance(self._objective, Invertible)
        both = self._objective.combine(self._a, self._b)
        self._watched.append((both, copied(both)))
        left = self._impact("remove", self._call("remove", self._objective.remove, both, self._b))
        removed = f"remove(combine({self._a_name}, {self._b_name}), {self._b_name})"
        self._same(left, self._a, removed, self._a_name)

    def clip(self, reach: Reach) -> None:
        """Raise ``InputError`` if ``clip`` changes an argument."""
        assert isinstance(self._objective, Clippable)
        self._impact("clip", self._call("clip", self._objective.clip, self._belief, self._b, reach))

    def _call(self, function: str, run: Callable[..., ResultT], *args: object) -> ResultT:
        """Call a function of the objective, and look whether anything that is known has changed."""
        result = run(*args)
        if any(used is not kept and not equal(used, kept) for used, kept in self._watched):
            wrong = f"{self._name}.{function} changes what it is given or has returned"
            raise InputError(f"{wrong}; let it return something new")
        return result

    def _impact(self, function: str, returned: ImpactT) -> ImpactT:
        """Return what a function of the objective returned; ``InputError`` for None, which is no impact."""
        if returned is None:
            raise InputError(f"{self._name}.{function} returned None; it must return an impact")
        return returned

    def _same(self, one: ImpactT, other: ImpactT, left: str, right: str) -> None:
        """Raise ``InputError`` for two impacts that differ, and are worth something else."""
        if equal(one, other, TOLERANCE, self._a, self._b):
            return
        x, y = (value_of(self._objective, self._belief, each) for each in (one, other))
        if abs(x - y) > TOLERANCE * max(abs(x), abs(y)):
            raise InputError(f"{self._name}.{left} is not {right}: worth {x:.9g}, not {y:.9g}")


def _two(
    candidates: Sequence[Sequence[ImpactT]], nothing: ImpactT
) -> tuple[tuple[int, int], tuple[int, int]]:
    """Return the places of the first two candidates that are neither nothing nor equal, or of the ends."""
    every = ((i, k) for i, own in enumerate(candidates) for k in range(len(own)))
    places = list(islice(every, MOST_LOOKED_AT))
    some = (place for place in places if not equal(candidates[place[0]][place[1]], nothing))
    i, k = first = next(some, places[0])
    other = (place for place in some if not equal(candidates[place[0]][place[1]], candidates[i][k]))
    return first, next(other, places[-1])

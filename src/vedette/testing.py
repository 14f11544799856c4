"""The laws that an objective must obey, checked on examples: the first test of any new one."""

from __future__ import annotations

import copy
import itertools
from collections.abc import Callable, Sequence
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from vedette.errors import InputError, brief
from vedette.number import is_number
from vedette.problem import Invertible, Objective
from vedette.problem.alike import copied, equal
from vedette.problem.checked import number_of, numbers_of
from vedette.problem.door import check_belief, check_impacts, check_list
from vedette.problem.objective import BeliefT, ImpactT

ResultT = TypeVar("ResultT")

MOST_IN_TRIPLES = 8  # laws of three impacts are tried on the first so many


class LawBroken(AssertionError):
    """A law fails; the message states it with the example: which impacts, which numbers."""


def check_objective(
    objective: Objective[BeliefT, ImpactT],
    belief: BeliefT,
    impacts: Sequence[ImpactT],
    *,
    tolerance: float = 1e-9,
) -> None:
    """Check that ``*`` is a commutative monoid and that ``psi`` keeps what it declares, on these impacts.

    Laws: arguments unchanged; identity; commutative; associative; value 0 at nothing; ``values`` agrees
    with ``value``; ``remove`` undoes ``combine`` where there is one; monotone and diminishing returns where
    declared. Integers must agree exactly, floats to the share ``tolerance`` of the largest in the same part
    of the examples, values to that of the largest value. Impacts may be arrays, numbers, collections,
    dataclasses, or anything with ``==``.

    Args:
        objective: the plug-in.
        belief: a belief it takes.
        impacts: examples, best a handful that differ, with extremes among them.
        tolerance: for floats, as a share.

    Raises:
        LawBroken: the first law that fails.
        InputError: no impacts, or a belief or impacts that the objective refuses.
    """
    check_belief(objective, belief)
    check_list(impacts, "impacts", "a list of examples")
    if len(impacts) == 0:
        raise InputError("check_objective: impacts is empty; give at least one example")
    check_impacts(objective, belief, impacts, "impacts")
    if not is_number(tolerance) or tolerance < 0.0:
        raise InputError(f"tolerance must be a number >= 0; got {brief(tolerance)}")
    laws = _Laws(objective, belief, list(impacts), tolerance)
    laws.leaves_arguments_alone()
    laws.monoid()
    laws.inverse()
    laws.values()
    laws.prices_add()
    laws.returns()


class _Laws:
    """The laws of one objective on one list of examples."""

    def __init__(
        self, objective: Objective[Any, Any], belief: object, impacts: list[Any], tolerance: float
    ) -> None:
        for i, impact in enumerate(impacts):
            if not equal(copy.deepcopy(impact), impact):
                kind = type(impact).__name__
                raise InputError(f"impacts[{i}] does not equal its own copy; give {kind} an __eq__ by value")
        self.objective = objective
        self.belief = belief
        self.impacts = impacts
        self.some = list(enumerate(impacts))[:MOST_IN_TRIPLES]
        self.tolerance = tolerance
        self.nothing = objective.nothing(belief)
        self.worth = 0.0  # size of the largest value of an example
        self.prices = np.array([self._price(a, f"impacts[{i}]") for i, a in enumerate(self.impacts)])

    def leaves_arguments_alone(self) -> None:
        """No function changes what it is given or has returned: impacts are shared between messages."""
        belief, last, kept_last = copied(self.belief), None, None
        for (i, a), (j, b) in itertools.product(self.some, repeat=2):
            kept = copy.deepcopy((a, b))
            both = self.objective.combine(a, b)
            self._unchanged((a, b), kept, f"combine(impacts[{i}], impacts[{j}]) changes an argument")
            self._unchanged(last, kept_last, f"combine(impacts[{i}], impacts[{j}]) changes an earlier result")
            last, kept_last = both, copy.deepcopy(both)
            self.objective.value(self.belief, a)
            self.objective.values(self.belief, a, [b])
            self._unchanged((a, b), kept, f"value or values of impacts[{i}] changes an argument")
        if belief is not self.belief and not equal(self.belief, belief):
            raise LawBroken("value or values changes the belief")

    def monoid(self) -> None:
        """``*`` has an identity, commutes and associates."""
        combine, e = self.objective.combine, self.nothing
        for i, a in enumerate(self.impacts):
            self._same(combine(a, e), a, f"combine(impacts[{i}], nothing) != impacts[{i}]")
            self._same(combine(e, a), a, f"combine(nothing, impacts[{i}]) != impacts[{i}]")
        for (i, a), (j, b) in itertools.combinations(enumerate(self.impacts), 2):
            law = f"combine is not commutative: (impacts[{i}], impacts[{j}]) against the reverse"
            self._same(combine(a, b), combine(b, a), law, a, b)
        for (i, a), (j, b), (k, c) in itertools.product(self.some, repeat=3):
            law = (
                f"combine is not associative: impacts[{i}] * impacts[{j}] * impacts[{k}], left against right"
            )
            self._same(combine(combine(a, b), c), combine(a, combine(b, c)), law, a, b, c)

    def inverse(self) -> None:
        """``remove`` undoes ``combine``, where there is one."""
        if not isinstance(self.objective, Invertible):
            return
        for (i, a), (j, b) in itertools.product(enumerate(self.impacts), repeat=2):
            both = self.objective.combine(a, b)
            kept, removed = (
                copy.deepcopy((both, b)),
                f"remove(combine(impacts[{i}], impacts[{j}]), impacts[{j}])",
            )
            left = self.objective.remove(both, b)
            self._unchanged((both, b), kept, f"{removed} changes an argument")
            self._same(left, a, f"{removed} != impacts[{i}]", b)

    def values(self) -> None:
        """``psi`` is 0 at nothing, and ``values`` agrees with it."""
        self.worth = max(abs(self._value(a, f"impacts[{i}]")) for i, a in enumerate(self.impacts))
        self._close(self._value(self.nothing, "nothing"), 0.0, "value(nothing) != 0")
        if np.shape(self.objective.values(self.belief, self.nothing, [])) != (0,):
            raise LawBroken("values of no impacts must have shape (0,)")
        for name, others in self._bases():
            many = self._values(others, name)
            for k, own in enumerate(self.impacts):
                one = self._value(self.objective.combine(others, own), f"combine({name}, impacts[{k}])")
                self._close(float(many[k]), one, f"values({name}, impacts)[{k}] != value(combine(...))")

    def prices_add(self) -> None:
        """Prices are not below 0, and add up."""
        if (self.prices < 0.0).any():
            k = int(np.argmin(self.prices))
            raise LawBroken(f"price(impacts[{k}]) is {self.prices[k]:.9g}, below 0")
        for (i, a), (j, b) in itertools.product(self.some, repeat=2):
            name = f"combine(impacts[{i}], impacts[{j}])"
            both, apart = self._price(self.objective.combine(a, b), name), self.prices[i] + self.prices[j]
            self._close(both, float(apart), f"price({name}) != the sum of their prices")

    def returns(self) -> None:
        """More never hurts, and brings less the more there is: where declared."""
        for name, base in self._bases():
            gains, rounding = self._gains(base, name)
            gross = gains + self.prices
            if self.objective.monotone and (gross < -rounding).any():
                k = int(np.argmin(gross))
                raise LawBroken(f"not monotone: impacts[{k}] added to {name} gains {gross[k]:.9g}")
            for j, more in self.some if self.objective.submodular else []:
                later, its = self._gains(self.objective.combine(base, more), f"combine({name}, impacts[{j}])")
                if (excess := later - gains).max() > max(rounding, its):
                    k = int(np.argmax(excess))
                    raise LawBroken(
                        f"returns do not diminish: impacts[{k}] added to {name} gains {gains[k]:.9g}, "
                        f"after impacts[{j}] {later[k]:.9g}"
                    )

    def _bases(self) -> list[tuple[str, Any]]:
        return [("nothing", self.nothing), *((f"impacts[{i}]", a) for i, a in self.some)]

    def _gains(self, base: object, name: str) -> tuple[NDArray[np.float64], float]:
        """Return what each impact adds to a base, and what of it may be rounding."""
        value, values = self._value(base, name), self._values(base, name)
        return values - value, self.tolerance * max(self.worth, abs(value), float(np.abs(values).max()))

    def _value(self, impact: object, name: str) -> float:
        returned = self.objective.value(self.belief, impact)
        return _law(number_of, returned, f"value({name})")

    def _price(self, impact: object, name: str) -> float:
        return _law(number_of, self.objective.price(impact), f"price({name})")

    def _values(self, others: object, name: str) -> NDArray[np.float64]:
        returned = self.objective.values(self.belief, others, self.impacts)
        return _law(numbers_of, returned, len(self.impacts), f"values({name}, impacts)")

    def _close(self, x: float, y: float, law: str) -> None:
        if abs(x - y) > self.tolerance * max(self.worth, abs(x), abs(y)):
            raise LawBroken(f"{law}: {x} against {y}")

    def _same(self, a: object, b: object, law: str, *of: object) -> None:
        if not equal(a, b, self.tolerance, *of):
            raise LawBroken(f"{law}: {brief(a)} against {brief(b)}")

    def _unchanged(self, used: object, kept: object, law: str) -> None:
        if not equal(used, kept):
            raise LawBroken(f"{law}: {brief(used)} against {brief(kept)}")


def _law(check: Callable[..., ResultT], *of: object) -> ResultT:
    """Return what a check returns; what it refuses breaks a law."""
    try:
        return check(*of)
    except InputError as wrong:
        raise LawBroken(str(wrong)) from None

"""The laws that an objective must obey, checked on examples: the first test of any new one."""

from __future__ import annotations

import copy
import dataclasses
import itertools
from collections.abc import Mapping, Sequence
from typing import Any, cast

import numpy as np

from vedette.errors import InputError
from vedette.problem import Invertible, Objective
from vedette.problem.objective import BeliefT, ImpactT

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
    declared. Integers must agree exactly, floats to ``tolerance`` (relative where above 1). Impacts may be
    arrays, numbers, collections, dataclasses, or anything with ``==``.

    Args:
        objective: the plug-in.
        belief: a belief it takes.
        impacts: examples, best a handful that differ, with extremes among them.
        tolerance: for floats.

    Raises:
        LawBroken: the first law that fails.
        InputError: no impacts.
    """
    if len(impacts) == 0:
        raise InputError("check_objective: impacts is empty; give at least one example")
    laws = _Laws(objective, belief, list(impacts), tolerance)
    laws.leaves_arguments_alone()
    laws.monoid()
    laws.inverse()
    laws.values()
    laws.returns()


class _Laws:
    """The laws of one objective on one list of examples."""

    def __init__(
        self, objective: Objective[Any, Any], belief: object, impacts: list[Any], tolerance: float
    ) -> None:
        self.objective = objective
        self.belief = belief
        self.impacts = impacts
        self.some = list(enumerate(impacts))[:MOST_IN_TRIPLES]
        self.tolerance = tolerance
        self.nothing = objective.nothing(belief)

    def leaves_arguments_alone(self) -> None:
        """No function changes what it is given: impacts are shared between messages."""
        for (i, a), (j, b) in itertools.product(self.some, repeat=2):
            kept = copy.deepcopy((a, b))
            self.objective.combine(a, b)
            self._same((a, b), kept, f"combine(impacts[{i}], impacts[{j}]) changes an argument")
            self.objective.value(self.belief, a)
            self.objective.values(self.belief, a, [b])
            self._same((a, b), kept, f"value or values of impacts[{i}] changes an argument")

    def monoid(self) -> None:
        """``*`` has an identity, commutes and associates."""
        combine, e = self.objective.combine, self.nothing
        for i, a in enumerate(self.impacts):
            self._same(combine(a, e), a, f"combine(impacts[{i}], nothing) != impacts[{i}]")
            self._same(combine(e, a), a, f"combine(nothing, impacts[{i}]) != impacts[{i}]")
        for (i, a), (j, b) in itertools.combinations(enumerate(self.impacts), 2):
            law = f"combine is not commutative: (impacts[{i}], impacts[{j}]) against the reverse"
            self._same(combine(a, b), combine(b, a), law)
        for (i, a), (j, b), (k, c) in itertools.product(self.some, repeat=3):
            law = (
                f"combine is not associative: impacts[{i}] * impacts[{j}] * impacts[{k}], left against right"
            )
            self._same(combine(combine(a, b), c), combine(a, combine(b, c)), law)

    def inverse(self) -> None:
        """``remove`` undoes ``combine``, where there is one."""
        if not isinstance(self.objective, Invertible):
            return
        for (i, a), (j, b) in itertools.product(enumerate(self.impacts), repeat=2):
            left = self.objective.remove(self.objective.combine(a, b), b)
            self._same(left, a, f"remove(combine(impacts[{i}], impacts[{j}]), impacts[{j}]) != impacts[{i}]")

    def values(self) -> None:
        """``psi`` is 0 at nothing, and ``values`` agrees with it."""
        self._same(self.objective.value(self.belief, self.nothing), 0.0, "value(nothing) != 0")
        if np.shape(self.objective.values(self.belief, self.nothing, [])) != (0,):
            raise LawBroken("values of no impacts must have shape (0,)")
        for name, others in [("nothing", self.nothing), *((f"impacts[{i}]", a) for i, a in self.some)]:
            many = np.asarray(self.objective.values(self.belief, others, self.impacts))
            if many.shape != (len(self.impacts),):
                raise LawBroken(f"values has shape {many.shape} for {len(self.impacts)} impacts")
            for k, own in enumerate(self.impacts):
                one = self.objective.value(self.belief, self.objective.combine(others, own))
                self._same(float(many[k]), float(one), f"values({name}, impacts)[{k}] != value(combine(...))")

    def returns(self) -> None:
        """More never hurts, and brings less the more there is: where declared."""
        bases = [("nothing", self.nothing), *((f"impacts[{i}]", a) for i, a in self.some)]
        for name, base in bases:
            gains = self._gains(base)
            if self.objective.monotone and (gains < -self._slack(gains)).any():
                k = int(np.argmin(gains))
                raise LawBroken(f"not monotone: impacts[{k}] added to {name} gains {gains[k]:.9g}")
            for j, more in self.some if self.objective.submodular else []:
                later = self._gains(self.objective.combine(base, more))
                if (excess := later - gains - self._slack(gains)).max() > 0.0:
                    k = int(np.argmax(excess))
                    raise LawBroken(
                        f"returns do not diminish: impacts[{k}] added to {name} gains {gains[k]:.9g}, "
                        f"after impacts[{j}] {later[k]:.9g}"
                    )

    def _gains(self, base: object) -> np.ndarray[Any, np.dtype[np.float64]]:
        values = np.asarray(self.objective.values(self.belief, base, self.impacts), dtype=np.float64)
        return values - self.objective.value(self.belief, base)

    def _slack(self, gains: np.ndarray[Any, np.dtype[np.float64]]) -> float:
        return self.tolerance * max(1.0, float(np.abs(gains).max()))

    def _same(self, a: object, b: object, law: str) -> None:
        if not _alike(a, b, self.tolerance):
            raise LawBroken(f"{law}: {_brief(a)} against {_brief(b)}")


def _alike(a: object, b: object, tolerance: float) -> bool:
    """Tell whether two impacts are equal: integers exactly, floats to the tolerance, the rest by parts."""
    if isinstance(a, np.ndarray | np.generic | int | float | complex):
        one, two = np.asarray(a), np.asarray(b)
        if one.shape != two.shape:
            return False
        if one.dtype.kind in "fc" or two.dtype.kind in "fc":
            return bool(np.allclose(one, two, rtol=tolerance, atol=tolerance, equal_nan=True))
        return bool(np.array_equal(one, two))
    if type(a) is not type(b):
        return False
    if isinstance(a, Mapping):
        other = cast("Mapping[object, object]", b)
        return a.keys() == other.keys() and all(_alike(a[key], other[key], tolerance) for key in a)
    if isinstance(a, list | tuple):
        others = cast("Sequence[object]", b)
        return len(a) == len(others) and all(map(lambda x, y: _alike(x, y, tolerance), a, others))
    if dataclasses.is_dataclass(a):
        names = (field.name for field in dataclasses.fields(a))
        return all(_alike(getattr(a, name), getattr(b, name), tolerance) for name in names)
    return bool(a == b)


def _brief(impact: object, limit: int = 120) -> str:
    """Return the impact on one line, cut where it is long."""
    text = " ".join(repr(impact).split())
    return text if len(text) <= limit else f"{text[: limit - 3]}..."

"""Every law that a plug-in can break is found, and the message says which and where."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pytest
from numpy.typing import NDArray

from tests.support.random_teams import Float, informations, misses
from vedette import CountedCoverage, Coverage, InputError, LogDet, Objective, counted
from vedette.testing import LawBroken, check_objective

RNG = np.random.default_rng(0)
MISSES = [own[0] for own in misses(RNG, 6, 1)]
INFORMATIONS = [own[0] for own in informations(RNG, 6, 1)]


def test_the_ready_objectives_keep_their_laws() -> None:
    weights = RNG.uniform(size=12)
    check_objective(Coverage(), weights, MISSES)
    check_objective(CountedCoverage(), weights, [counted(m) for m in MISSES])
    check_objective(LogDet(), np.eye(3), INFORMATIONS)


class Sum(Objective[float, float]):
    """Numbers that add up, worth as much as they are: keeps every law."""

    monotone = submodular = True

    def nothing(self, belief: float) -> float:
        return 0.0

    def combine(self, a: float, b: float) -> float:
        return a + b

    def value(self, belief: float, impact: float) -> float:
        return belief * impact


class WrongIdentity(Sum):
    def nothing(self, belief: float) -> float:
        return 1.0


class Minus(Sum):
    def combine(self, a: float, b: float) -> float:
        return a - b if b else a + b


class Mean(Sum):
    def combine(self, a: float, b: float) -> float:
        return (a + b) / 2 if a and b else a + b


class NotZero(Sum):
    def value(self, belief: float, impact: float) -> float:
        return impact + 1.0


class OtherValues(Sum):
    def values(self, belief: float, others: float, own: Sequence[float]) -> NDArray[np.float64]:
        return np.array([2.0 * others + k for k in own])


class OneValue(Sum):
    def values(self, belief: float, others: float, own: Sequence[float]) -> NDArray[np.float64]:
        return np.zeros(min(len(own), 1))


class NoEmptyList(Sum):
    def values(self, belief: float, others: float, own: Sequence[float]) -> NDArray[np.float64]:
        return np.zeros((len(own), 1))


class Falling(Sum):
    def value(self, belief: float, impact: float) -> float:
        return -impact


class Square(Sum):
    def value(self, belief: float, impact: float) -> float:
        return impact**2


class BadInverse(Sum):
    def remove(self, total: float, own: float) -> float:
        return total


@pytest.mark.parametrize(
    ("objective", "law"),
    [
        (WrongIdentity(), r"combine\(impacts\[0\], nothing\) != impacts\[0\]: 2.0 against 1.0"),
        (Minus(), r"combine\(nothing, impacts\[0\]\) != impacts\[0\]: -1.0 against 1.0"),
        (Mean(), r"combine is not associative: impacts\[0\] \* impacts\[0\] \* impacts\[1\]"),
        (NotZero(), r"value\(nothing\) != 0: 1.0 against 0.0"),
        (OtherValues(), r"values\(impacts\[0\], impacts\)\[0\] != value\(combine\(...\)\)"),
        (OneValue(), r"values has shape \(1,\) for 3 impacts"),
        (NoEmptyList(), r"values of no impacts must have shape \(0,\)"),
        (Falling(), r"not monotone: impacts\[2\] added to nothing gains -4"),
        (Square(), r"returns do not diminish: impacts\[2\] added to nothing gains 16, after impacts\[0\] 24"),
        (BadInverse(), r"remove\(combine\(impacts\[0\], impacts\[0\]\), impacts\[0\]\) != impacts\[0\]"),
    ],
)
def test_a_broken_law_is_stated_with_its_example(objective: Sum, law: str) -> None:
    check_objective(Sum(), 1.0, [1.0, 2.5, 4.0])
    with pytest.raises(LawBroken, match=law):
        check_objective(objective, 1.0, [1.0, 2.5, 4.0])


def test_what_is_not_declared_is_not_asked() -> None:
    class Free(Falling):
        monotone = submodular = False

    check_objective(Free(), 1.0, [1.0, 2.5, 4.0])


class InPlace(Coverage):
    def combine(self, a: Float, b: Float) -> Float:
        a *= b
        return a


def test_changing_an_argument_is_a_broken_law() -> None:
    with pytest.raises(LawBroken, match=r"combine\(impacts\[0\], impacts\[0\]\) changes an argument"):
        check_objective(InPlace(), np.ones(3), [np.full(3, 0.5)])


class FirstWins(Objective[None, tuple[int, ...]]):
    """Strings of numbers joined end to end: associative, but not commutative."""

    def nothing(self, belief: None) -> tuple[int, ...]:
        return ()

    def combine(self, a: tuple[int, ...], b: tuple[int, ...]) -> tuple[int, ...]:
        return a + b

    def value(self, belief: None, impact: tuple[int, ...]) -> float:
        return float(sum(impact))


def test_order_that_matters_is_a_broken_law() -> None:
    with pytest.raises(LawBroken, match=r"not commutative: .*: \(1, 2\) against \(2, 1\)"):
        check_objective(FirstWins(), None, [(1,), (2,)])


class Lossy(CountedCoverage):
    """Off by one in the last place when both see: integers must agree exactly."""

    def combine(self, a: NDArray[np.int64], b: NDArray[np.int64]) -> NDArray[np.int64]:
        return a + b + ((a > 10**9) & (b > 10**9) & (a > b))


def test_integers_must_agree_exactly() -> None:
    with pytest.raises(LawBroken, match="not commutative"):
        check_objective(Lossy(), np.ones(1), [counted(np.array([0.3])), counted(np.array([0.2]))])


@dataclass(frozen=True, eq=False)
class Footprint:
    """A sparse impact: an array, a number and a table in a dataclass without ``==``."""

    misses: Float
    stops: int
    seen: dict[str, frozenset[int]]


class Footprints(Objective[None, Footprint]):
    """Parts combined one by one."""

    def nothing(self, belief: None) -> Footprint:
        return Footprint(np.ones(2), 0, {"tiles": frozenset()})

    def combine(self, a: Footprint, b: Footprint) -> Footprint:
        return Footprint(a.misses * b.misses, a.stops + b.stops, {"tiles": a.seen["tiles"] | b.seen["tiles"]})

    def value(self, belief: None, impact: Footprint) -> float:
        return float(np.sum(1.0 - impact.misses)) + len(impact.seen["tiles"]) - impact.stops


def test_impacts_may_be_dataclasses_of_arrays_numbers_and_sets() -> None:
    impacts = [Footprint(RNG.uniform(size=2), k, {"tiles": frozenset({k, 9})}) for k in range(3)]
    check_objective(Footprints(), None, impacts)


def test_without_examples_there_is_nothing_to_check() -> None:
    with pytest.raises(InputError, match="impacts is empty"):
        check_objective(Sum(), 1.0, [])

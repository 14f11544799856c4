"""Every law that a plug-in can break is found, and the message says which and where."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from tests.support.junk import JUNK, assert_done_or_refused
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
        (OneValue(), r"values\(nothing, impacts\) returned shape \(1,\) for 3 impacts; want \(3,\)"),
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


class Changes(Coverage):
    """Changes something that it is given or has returned."""

    def __init__(self, what: str) -> None:
        self.what, self.buffer = what, np.empty(3)

    def combine(self, a: Float, b: Float) -> Float:
        return np.multiply(a, b, out=self.buffer) if self.what == "result" else a * b

    def remove(self, total: Float, own: Float) -> Float:
        return np.divide(total, own, out=total if self.what == "total" else None)

    def value(self, belief: Float, impact: Float) -> float:
        if self.what == "belief":
            belief -= 0.0 * belief + 1e-12  # too little for any value to show it
        if self.what == "impact":
            impact *= 1.0 - 1e-12
        return super().value(belief, impact)


@pytest.mark.parametrize(
    ("what", "law"),
    [
        ("result", r"combine\(impacts\[0\], impacts\[1\]\) changes an earlier result"),
        ("impact", r"value or values of impacts\[0\] changes an argument"),
        ("belief", r"value or values changes the belief"),
        ("total", r"remove\(combine\(impacts\[0\], impacts\[0\]\), impacts\[0\]\) changes an argument"),
    ],
)
def test_changing_anything_however_little_is_a_broken_law(what: str, law: str) -> None:
    check_objective(Changes("nothing"), np.ones(3), [np.full(3, 0.5), np.full(3, 0.25)])
    with pytest.raises(LawBroken, match=law):
        check_objective(Changes(what), np.ones(3), [np.full(3, 0.5), np.full(3, 0.25)])


class Times(Sum):
    """In another unit, with one law broken."""

    def __init__(self, broken: Sum, factor: float) -> None:
        self.broken, self.factor = broken, factor

    def combine(self, a: float, b: float) -> float:
        return self.factor * self.broken.combine(a / self.factor, b / self.factor)

    def value(self, belief: float, impact: float) -> float:
        return self.factor * self.broken.value(belief, impact / self.factor)


@pytest.mark.parametrize("factor", [2.0**-40, 1.0, 2.0**40])
def test_laws_hold_or_break_whatever_the_unit(factor: float) -> None:
    impacts = [factor * x for x in (1.0, 2.5, 4.0)]
    check_objective(Times(Sum(), factor), 1.0, impacts)
    for broken, law in [
        (Minus(), "combine"),
        (Mean(), "not associative"),
        (NotZero(), r"value\(nothing\) != 0"),
        (Falling(), "not monotone"),
        (Square(), "returns do not diminish"),
    ]:
        with pytest.raises(LawBroken, match=law):
            check_objective(Times(broken, factor), 1.0, impacts)


def test_rounding_breaks_no_law_where_large_and_small_meet() -> None:
    check_objective(LogDet(), np.eye(2), [1e-7 * np.diag([1.0, 2.0]), np.diag([3e4, 1.0]), np.zeros((2, 2))])
    check_objective(CostlySum(), 1.0, [1e6, 3e-3, 0.1])


class CostlySum(Sum):
    """A gain less its cost: what is left is small beside both."""

    def value(self, belief: float, impact: float) -> float:
        return (1e6 + belief) * impact - 1e6 * impact

    def remove(self, total: float, own: float) -> float:
        return total - own


class Unlike(Sum):
    """Says something of what is worth 4 that is no number."""

    def __init__(self, returned: object) -> None:
        self.returned = returned

    def value(self, belief: float, impact: float) -> float:
        return self.returned if impact == 4.0 else impact  # type: ignore[return-value]

    def values(self, belief: float, others: float, own: Sequence[float]) -> NDArray[np.float64]:
        return others + np.array(own, dtype=np.float64)


@pytest.mark.parametrize(
    ("returned", "law"),
    [
        (np.nan, r"value\(impacts\[2\]\) returned nan; values must be finite, of size 1e\+90 at most"),
        (-np.inf, r"value\(impacts\[2\]\) returned -inf; values must be finite"),
        (None, r"value\(impacts\[2\]\) returned None; it must return a number"),
        ("4", r"value\(impacts\[2\]\) returned '4'; it must return a number"),
    ],
)
def test_a_value_that_is_no_finite_number_is_a_broken_law(returned: object, law: str) -> None:
    with pytest.raises(LawBroken, match=law):
        check_objective(Unlike(returned), 1.0, [1.0, 2.5, 4.0])


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


class Handle:
    """Equal to nothing but itself."""


def test_what_there_is_nothing_to_check_with_is_refused_in_one_line() -> None:
    check: Any = check_objective  # given what no type allows
    calls: list[tuple[Callable[[], object], str]] = [
        (
            lambda: check(Sum(), 1.0, []),
            "check_objective: impacts is empty; give at least one example",
        ),
        (lambda: check(Sum(), 1.0, 3.0), "impacts is 3.0; give a list of examples"),
        (
            lambda: check(Sum, 1.0, [1.0]),
            "objective is the class Sum; give Sum()",
        ),
        (
            lambda: check(Coverage(), -np.ones(3), [np.ones(3)]),
            "belief: weights must be finite and >= 0; got -1.0 at [0]",
        ),
        (
            lambda: check(Coverage(), np.ones(3), [np.ones(3), np.full(3, 1.5)]),
            "impacts[1]: miss probabilities must be in [0, 1]; got 1.5 at [0]",
        ),
        (
            lambda: check(Sum(), 1.0, [1.0], tolerance=np.nan),
            "tolerance must be a number >= 0; got nan",
        ),
        (
            lambda: check(Sum(), 1.0, [1.0, Handle()]),
            "impacts[1] does not equal its own copy; give Handle an __eq__ by value",
        ),
    ]
    for call, line in calls:
        with pytest.raises(InputError) as refused:
            call()
        assert str(refused.value) == line


@settings(deadline=None, max_examples=200)
@given(place=st.sampled_from(["objective", "belief", "impacts", "impact", "tolerance"]), junk=JUNK)
def test_anything_else_is_refused_too_or_breaks_a_law(place: str, junk: Any) -> None:
    examples = [np.array([0.0, 0.5, 1.0]), junk] if place == "impact" else [np.array([0.0, 0.5, 1.0])]
    given: dict[str, Any] = {"objective": Coverage(), "belief": np.ones(3), "impacts": examples}

    def check() -> None:
        try:
            check_objective(**(given if place == "impact" else given | {place: junk}))
        except LawBroken:
            assert place == "tolerance"  # so small that rounding counts

    assert_done_or_refused(check)

"""An objective that cannot be believed is found out before anything is negotiated; its own errors pass."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from threading import Lock
from typing import Any

import numpy as np
import pytest

from tests.support.random_teams import Float, misses
from vedette import (
    CountedCoverage,
    Coverage,
    InputError,
    Objective,
    Tree,
    bound,
    counted,
    exhaustive,
    negotiate,
)
from vedette.negotiation import SCHEMES
from vedette.problem.reach import Reach

W = np.array([3.0, 2.0, 1.0])
TEAM = [[np.ones(3), np.array([0.0, 1.0, 1.0])], [np.ones(3), np.array([1.0, 0.5, 0.5])]]


class InPlace(Coverage):
    """Multiplies into its first argument."""

    def combine(self, a: Float, b: Float) -> Float:
        a *= b
        return a


class InPlaceSecond(Coverage):
    """Multiplies into its second argument."""

    def combine(self, a: Float, b: Float) -> Float:
        b *= a
        return b


class OneBuffer(Coverage):
    """Returns the same array again and again."""

    buffer = np.empty(3)

    def combine(self, a: Float, b: Float) -> Float:
        return np.multiply(a, b, out=self.buffer)


class Eats(Coverage):
    """Turns misses into what is seen, to take the sum of that."""

    def value(self, belief: Float, impact: Float) -> float:
        np.subtract(1.0, impact, out=impact)
        return float(belief @ impact)


class EatsBelief(Coverage):
    """Weighs in place."""

    def value(self, belief: Float, impact: Float) -> float:
        belief *= 1.0 - impact
        return float(belief.sum())


class EatsOthers(Coverage):
    """Prices a list in place."""

    def values(self, belief: Float, others: Float, own: Sequence[Float]) -> Float:
        others *= belief
        return np.array([belief.sum() - others @ k for k in own])


class Mean(Objective[None, float]):
    """Has no identity."""

    def nothing(self, belief: None) -> float:
        return 0.0

    def combine(self, a: float, b: float) -> float:
        return (a + b) / 2.0

    def value(self, belief: None, impact: float) -> float:
        return impact


class FirstWins(Objective[None, float]):
    """Keeps what came first."""

    def nothing(self, belief: None) -> float:
        return 0.0

    def combine(self, a: float, b: float) -> float:
        return a or b

    def value(self, belief: None, impact: float) -> float:
        return impact


@pytest.mark.parametrize(
    ("objective", "line"),
    [
        (InPlace(), "InPlace.combine changes what it is given or has returned; let it return something new"),
        (
            InPlaceSecond(),
            "InPlaceSecond.combine changes what it is given or has returned; let it return something new",
        ),
        (
            OneBuffer(),
            "OneBuffer.combine changes what it is given or has returned; let it return something new",
        ),
        (Eats(), "Eats.value changes what it is given or has returned; let it return something new"),
        (
            EatsBelief(),
            "EatsBelief.value changes what it is given or has returned; let it return something new",
        ),
        (
            EatsOthers(),
            "EatsOthers.values changes what it is given or has returned; let it return something new",
        ),
    ],
)
def test_an_objective_that_changes_its_arguments_is_refused_and_has_changed_nothing(
    objective: Coverage, line: str
) -> None:
    weights, candidates = W.copy(), [[impact.copy() for impact in own] for own in TEAM]
    for call in (
        lambda: negotiate(objective, weights, candidates, Tree.chain(2)),
        lambda: negotiate(objective, weights, candidates, Tree.chain(2), "jacobi"),
        lambda: exhaustive(objective, weights, candidates),
        lambda: bound(objective, weights, candidates, [0, 0]),
    ):
        with pytest.raises(InputError) as refused:
            call()
        assert str(refused.value) == line
    np.testing.assert_array_equal(weights, W)
    np.testing.assert_array_equal(candidates, TEAM)


def test_an_operator_without_identity_or_with_an_order_is_refused() -> None:
    with pytest.raises(InputError) as refused:
        negotiate(Mean(), None, [[1.0], [2.0]], Tree.chain(2))
    assert str(refused.value) == (
        "Mean.combine(nothing, candidates[0][0]) is not candidates[0][0]: worth 0.5, not 1"
    )
    with pytest.raises(InputError) as refused:
        negotiate(FirstWins(), None, [[0.0, 1.0], [2.0]], Tree.chain(2))
    assert str(refused.value) == (
        "FirstWins.combine(candidates[0][1], candidates[1][0]) is not the reverse: worth 1, not 2"
    )


class Forgets(CountedCoverage):
    """Does not return what it made."""

    def __init__(self, what: str) -> None:
        self.what = what

    def nothing(self, belief: Float) -> Any:
        return None if self.what == "nothing" else super().nothing(belief)

    def combine(self, a: Any, b: Any) -> Any:
        return None if self.what == "combine" else super().combine(a, b)

    def remove(self, total: Any, own: Any) -> Any:
        return None if self.what == "remove" else super().remove(total, own)

    def clip(self, belief: Float, impact: Any, reach: Reach) -> Any:
        return None if self.what == "clip" else impact


@pytest.mark.parametrize("what", ["nothing", "combine", "remove", "clip"])
def test_an_objective_that_returns_none_is_refused(what: str) -> None:
    run: Any = (W, [[counted(impact) for impact in own] for own in TEAM], Tree.chain(2))
    more: dict[str, dict[str, Any]] = {
        "remove": {"scheme": "jacobi", "inverse": True},
        "clip": {"reach": [((0.0, 0.0, 1.0, 1.0),)] * 2},
    }
    for options in more.values():
        negotiate(Forgets("no"), *run, **options)
    with pytest.raises(InputError) as refused:
        negotiate(Forgets(what), *run, **more.get(what, {}))
    assert str(refused.value) == f"Forgets.{what} returned None; it must return an impact"


class Sightings(Objective[None, list[int]]):
    """Lists joined end to end, of which the order is worth nothing."""

    def nothing(self, belief: None) -> list[int]:
        return []

    def combine(self, a: list[int], b: list[int]) -> list[int]:
        return a + b

    def value(self, belief: None, impact: list[int]) -> float:
        return float(len(set(impact)))


def test_what_differs_but_is_worth_the_same_is_let_pass() -> None:
    found = negotiate(Sightings(), None, [[[1], [2, 3]], [[2, 3], [1, 4, 5]]], Tree.chain(2))
    assert found.value == exhaustive(Sightings(), None, [[[1], [2, 3]], [[2, 3], [1, 4, 5]]]).value == 5.0


class Views(Coverage):
    """Returns an argument itself, or a view of it, where the other is nothing."""

    def combine(self, a: Float, b: Float) -> Float:
        if (b == 1.0).all():
            return a
        return b[:] if (a == 1.0).all() else a * b


@pytest.mark.parametrize("scheme", SCHEMES)
def test_a_view_of_an_argument_may_be_returned(scheme: str) -> None:
    rng = np.random.default_rng(0)
    weights, candidates = rng.uniform(size=12), misses(rng, 5, 4)
    kept = [[impact.copy() for impact in own] for own in candidates]
    for own in candidates:
        own.append(np.ones(12))
    plain = negotiate(Coverage(), weights, candidates, Tree.star(5), scheme)
    assert negotiate(Views(), weights, candidates, Tree.star(5), scheme) == plain
    np.testing.assert_array_equal([own[:4] for own in candidates], kept)


class NoInverse(CountedCoverage):
    """Takes too little out again."""

    def remove(self, total: Any, own: Any) -> Any:
        return total - own // 2


class InPlaceInverse(CountedCoverage):
    """Takes out of what it is given."""

    def remove(self, total: Any, own: Any) -> Any:
        total -= own
        return total


class InPlaceClip(Coverage):
    """Forgets in what it is given."""

    def clip(self, belief: Float, impact: Float, reach: Reach) -> Float:
        impact[0] = 1.0
        return impact


def test_an_inverse_that_is_none_or_changes_its_arguments_is_refused_and_so_is_such_a_clip() -> None:
    run: Any = (W, [[counted(impact) for impact in own] for own in TEAM], Tree.chain(2), "jacobi")
    with pytest.raises(InputError) as refused:
        negotiate(NoInverse(), *run, inverse=True)
    removed = "NoInverse.remove(combine(candidates[0][1], candidates[1][1]), candidates[1][1])"
    assert str(refused.value).startswith(f"{removed} is not candidates[0][1]: worth ")
    with pytest.raises(InputError, match=r"^InPlaceInverse\.remove changes what it is given"):
        negotiate(InPlaceInverse(), *run, inverse=True)
    clipping = [[np.array([0.0, 0.5, 1.0])]] * 2
    with pytest.raises(InputError, match=r"^InPlaceClip\.clip changes what it is given"):
        negotiate(InPlaceClip(), W, clipping, Tree.chain(2), reach=[((0.0, 0.0, 1.0, 1.0),)] * 2)


class Offset(Coverage):
    """The paper's own form, eq. (41): what is left unseen, a cost."""

    def value(self, belief: Float, impact: Float) -> float:
        return -float(belief @ impact)

    def values(self, belief: Float, others: Float, own: Sequence[Float]) -> Float:
        return np.array([-float(belief @ (others * k)) for k in own])


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("start", [None, [1, 2, 3, 0]])
def test_what_nothing_is_worth_is_taken_off_so_that_value_and_bound_are_gains(
    scheme: str, start: list[int] | None
) -> None:
    for seed in range(10):
        rng = np.random.default_rng(seed)
        weights, candidates, tree = rng.uniform(size=12), misses(rng, 4, 4), Tree.random(4, seed=seed)
        gain = negotiate(Coverage(), weights, candidates, tree, scheme, start=start)
        cost = negotiate(Offset(), weights, candidates, tree, scheme, start=start)
        assert (cost.choice, cost.sweeps, cost.converged) == (gain.choice, gain.sweeps, gain.converged)
        assert cost.value == pytest.approx(gain.value, abs=1e-12)
        assert cost.bound == pytest.approx(gain.bound, abs=1e-12)
        assert [step.value for step in cost.history] == pytest.approx([step.value for step in gain.history])
        best = exhaustive(Offset(), weights, candidates)
        assert best.value == pytest.approx(exhaustive(Coverage(), weights, candidates).value, abs=1e-12)
        same = bound(Coverage(), weights, candidates, best.choice)
        assert bound(Offset(), weights, candidates, best.choice) == pytest.approx(same, abs=1e-12)


class Handle:
    """An impact that can be neither copied nor compared."""

    def __init__(self, tiles: frozenset[int]) -> None:
        self.tiles, self.lock = tiles, Lock()


class Handles(Objective[Lock, Handle]):
    """Unions of them; the belief cannot be copied either."""

    def nothing(self, belief: Lock) -> Handle:
        return Handle(frozenset())

    def combine(self, a: Handle, b: Handle) -> Handle:
        return Handle(a.tiles | b.tiles)

    def value(self, belief: Lock, impact: Handle) -> float:
        return float(len(impact.tiles))


def test_impacts_that_can_be_neither_copied_nor_compared_are_negotiated_all_the_same() -> None:
    candidates = [[Handle(frozenset({1})), Handle(frozenset({1, 2}))], [Handle(frozenset({3}))]]
    found = negotiate(Handles(), Lock(), candidates, Tree.chain(2))
    assert (found.choice, found.value) == ((1, 0), 3.0)


class Trouble(Exception):
    """Of the objective itself."""


class Troubled(Coverage):
    """Fails in one of its functions once everything has been tried out."""

    def __init__(self, where: str, after: int, trouble: Exception) -> None:
        self.where, self.left, self.trouble = where, after, trouble

    def _count(self, where: str) -> None:
        if where == self.where:
            self.left -= 1
            if self.left < 0:
                raise self.trouble

    def combine(self, a: Float, b: Float) -> Float:
        self._count("combine")
        return super().combine(a, b)

    def value(self, belief: Float, impact: Float) -> float:
        self._count("value")
        return super().value(belief, impact)

    def values(self, belief: Float, others: Float, own: Sequence[Float]) -> Float:
        self._count("values")
        return super().values(belief, others, own)


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("where", ["combine", "value", "values"])
@pytest.mark.parametrize("trouble", [Trouble("mine"), ValueError("mine"), TypeError("mine"), KeyError(3)])
def test_an_objectives_own_error_passes_through_unchanged(
    scheme: str, where: str, trouble: Exception
) -> None:
    rng = np.random.default_rng(1)
    weights, candidates = rng.uniform(size=12), misses(rng, 4, 3)
    calls: list[Callable[[Coverage], object]] = [
        lambda objective: negotiate(objective, weights, candidates, Tree.chain(4), scheme),
        lambda objective: exhaustive(objective, weights, candidates),
    ]
    for call in calls:
        for after in (0, 3, 5):
            with pytest.raises(type(trouble)) as raised:
                call(Troubled(where, after, trouble))
            assert raised.value is trouble

"""What `exhaustive`, `bound`, `slack` and the ready objectives are given is used as meant, or refused."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.support.junk import JUNK, assert_done_or_refused
from tests.support.random_teams import Float
from vedette import CountedCoverage, Coverage, InputError, LogDet, Objective, Tree, problem
from vedette import negotiate as agree

# given what no type allows
bound: Any = problem.bound
counted: Any = problem.counted
exhaustive: Any = problem.exhaustive
slack: Any = problem.slack

W = np.array([3.0, 2.0, 1.0])
SEE, MISS = np.array([0.0, 0.5, 1.0]), np.ones(3)
EYE, ALONG = np.eye(2), np.array([[1.0, 0.0], [0.0, 0.0]])


class Sum(Objective[None, Any]):
    """Numbers that add up."""

    def nothing(self, belief: None) -> float:
        return 0.0

    def combine(self, a: float, b: float) -> float:
        return a + b

    def value(self, belief: None, impact: Any) -> Any:
        return impact


class Returns(Sum):
    """Says that everything but nothing is worth something that is no number."""

    def __init__(self, returned: object) -> None:
        self.returned = returned

    def value(self, belief: None, impact: Any) -> Any:
        return impact and self.returned


class Prices(Returns):
    """Says it of a list."""

    def value(self, belief: None, impact: Any) -> Any:
        return impact

    def values(self, belief: None, others: Any, own: Sequence[Any]) -> Any:
        return self.returned


def numbered(values: Any, index: int, value: float) -> Float:
    array = np.array(values, dtype=np.float64)
    array.flat[index] = value
    return array


LINES: list[tuple[Callable[[], object], str]] = [
    # candidates
    (lambda: exhaustive(Sum(), None, []), "candidates is empty: a team needs at least one platform"),
    (
        lambda: exhaustive(Sum(), None, [[1.0], []]),
        "candidates[1] is empty: give platform 1 at least one impact, objective.nothing(belief) if it can do "
        "nothing",
    ),
    (
        lambda: exhaustive(Sum(), None, 3),
        "candidates is 3; give a list of every platform's list of impacts",
    ),
    (
        lambda: exhaustive(Sum(), None, "ab"),
        "candidates is 'ab'; give a list of every platform's list of impacts",
    ),
    (
        lambda: exhaustive(Sum(), None, [[1.0], {1.0: 2.0}]),
        "candidates[1] is {1.0: 2.0}; give a list of the impacts of platform 1",
    ),
    (
        lambda: exhaustive(Sum(), None, [[1.0], {1.0}]),
        "candidates[1] is {1.0}; give a list of the impacts of platform 1",
    ),
    (
        lambda: exhaustive(Sum(), None, np.ones(2)),
        f"candidates[0] is {np.float64(1.0)!r}; give a list of the impacts of platform 0",
    ),
    (
        lambda: exhaustive(Sum(), None, [[0.0] * 10] * 7),
        "exhaustive: 10000000 combinations, at most 2000000; shorten the lists",
    ),
    (
        lambda: exhaustive(Sum(), None, [[1.0], [2.0, None]]),
        "candidates[1][1] is None, which is no impact; objective.nothing(belief) is one",
    ),
    # objective
    (
        lambda: exhaustive(Coverage, W, [[SEE]]),
        "objective is the class Coverage; give Coverage()",
    ),
    (
        lambda: exhaustive(None, W, [[SEE]]),
        "objective is None; give an instance of a subclass of Objective",
    ),
    (
        lambda: exhaustive(Returns(float("nan")), None, [[1.0]]),
        "Returns.value returned nan; values must be finite, of size 1e+90 at most",
    ),
    (
        lambda: exhaustive(Returns(-1e91), None, [[1.0]]),
        "Returns.value returned -1e+91; values must be finite, of size 1e+90 at most",
    ),
    (
        lambda: exhaustive(Returns(None), None, [[1.0]]),
        "Returns.value returned None; it must return a number",
    ),
    (lambda: exhaustive(Returns("9"), None, [[1.0]]), "Returns.value returned '9'; it must return a number"),
    (
        lambda: exhaustive(Returns(np.ones(1)), None, [[1.0]]),
        "Returns.value returned array([1.]); it must return a number",
    ),
    (lambda: exhaustive(Returns(1j), None, [[1.0]]), "Returns.value returned 1j; it must return a number"),
    (
        lambda: exhaustive(Prices(np.zeros((2, 2))), None, [[1.0, 2.0]]),
        "Prices.values returned shape (2, 2) for 2 impacts; want (2,)",
    ),
    (
        lambda: exhaustive(Prices([1.0, np.inf]), None, [[1.0, 2.0]]),
        "Prices.values returned inf for own[1]; values must be finite, of size 1e+90 at most",
    ),
    (
        lambda: exhaustive(Prices([1.0, [2.0]]), None, [[1.0, 2.0]]),
        "Prices.values returned [1.0, [2.0]]; it must return 2 numbers",
    ),
    (
        lambda: exhaustive(Prices(["1", "2"]), None, [[1.0, 2.0]]),
        "Prices.values returned ['1', '2']; it must return 2 numbers",
    ),
    # Coverage
    (
        lambda: exhaustive(Coverage(), numbered(W, 1, -0.3), [[SEE]]),
        "belief: weights must be finite and >= 0; got -0.3 at [1]",
    ),
    (
        lambda: exhaustive(Coverage(), numbered(W, 2, np.inf), [[SEE]]),
        "belief: weights must be finite and >= 0; got inf at [2]",
    ),
    (
        lambda: exhaustive(Coverage(), numbered(W, 0, np.inf).astype(np.float16), [[SEE]]),
        "belief: weights must be finite and >= 0; got inf at [0]",
    ),
    (
        lambda: exhaustive(Coverage(), [3.0, 2.0, 1.0], [[SEE]]),
        "belief: weights must be a NumPy array; got list",
    ),
    (
        lambda: exhaustive(Coverage(), W.astype(object), [[SEE]]),
        "belief: weights must be real numbers; got object",
    ),
    (
        lambda: exhaustive(Coverage(), W, [[SEE], [MISS, numbered(SEE, 2, 1.5)]]),
        "candidates[1][1]: miss probabilities must be in [0, 1]; got 1.5 at [2]",
    ),
    (
        lambda: exhaustive(Coverage(), W[None], [[SEE[None]], [numbered(SEE, 0, np.nan)[None]]]),
        "candidates[1][0]: miss probabilities must be in [0, 1]; got nan at [0, 0]",
    ),
    (
        lambda: exhaustive(Coverage(), W, [[SEE], [MISS[:2]]]),
        "candidates[1][0]: miss probabilities must have shape (3,); got (2,)",
    ),
    (
        lambda: exhaustive(Coverage(), W, [[SEE], [[0.0, 1.0, 1.0]]]),
        "candidates[1][0]: miss probabilities must be a NumPy array; got list",
    ),
    (
        lambda: exhaustive(Coverage(), W, [[np.ma.masked_array(SEE, mask=[True, False, False])]]),
        "candidates[0][0]: miss probabilities must be a NumPy array; got MaskedArray",
    ),
    # CountedCoverage
    (
        lambda: exhaustive(CountedCoverage(), W, [[counted(SEE), SEE]]),
        "candidates[0][1]: impacts by counted() must be int64; got float64",
    ),
    (
        lambda: exhaustive(CountedCoverage(), W, [[counted(SEE[:2])]]),
        "candidates[0][0]: impacts by counted() must have shape (2, 3); got (2, 2)",
    ),
    (
        lambda: exhaustive(CountedCoverage(), W, [[-counted(SEE)]]),
        "candidates[0][0]: impacts by counted() must be in [0, 4398046511104]; got -1 at [0, 0]",
    ),
    (
        lambda: exhaustive(CountedCoverage(), -W, [[counted(SEE)]]),
        "belief: weights must be finite and >= 0; got -3.0 at [0]",
    ),
    (lambda: counted(np.array([0.5, 1.5])), "counted: miss probabilities must be in [0, 1]; got 1.5 at [1]"),
    (lambda: counted(np.array([np.nan])), "counted: miss probabilities must be in [0, 1]; got nan at [0]"),
    (
        lambda: counted([0.5]),
        "counted: miss probabilities must be a NumPy array; got list",
    ),
    # LogDet
    (
        lambda: exhaustive(LogDet(), np.diag([1.0, -0.5]), [[ALONG]]),
        "belief: information must be positive definite; its least eigenvalue is -0.5",
    ),
    (
        lambda: exhaustive(LogDet(), np.array([[2.0, 1.0], [0.0, 2.0]]), [[ALONG]]),
        "belief: information must be symmetric; got 1.0 at [0, 1] and 0.0 at [1, 0]",
    ),
    (
        lambda: exhaustive(LogDet(), np.ones((2, 3)), [[ALONG]]),
        "belief: information must be a square matrix; got shape (2, 3)",
    ),
    (
        lambda: exhaustive(LogDet(), numbered(EYE.ravel(), 3, np.inf).reshape(2, 2), [[ALONG]]),
        "belief: information must be finite; got inf at [1, 1]",
    ),
    (
        lambda: exhaustive(LogDet(), np.eye(2, dtype=int), [[ALONG]]),
        "belief: information must be float64; got int64",
    ),
    (
        lambda: exhaustive(LogDet(), EYE, [[ALONG], [ALONG, ALONG - 0.25 * EYE]]),
        "candidates[1][1]: information must be positive semi-definite; its least eigenvalue is -0.25",
    ),
    (
        lambda: exhaustive(LogDet(), EYE, [[np.triu(np.ones((2, 2)))]]),
        "candidates[0][0]: information must be symmetric; got 1.0 at [0, 1] and 0.0 at [1, 0]",
    ),
    (
        lambda: exhaustive(LogDet(), EYE, [[np.eye(3)]]),
        "candidates[0][0]: information must have shape (2, 2); got (3, 3)",
    ),
    # bound and slack
    (lambda: bound(Sum(), None, [[1.0]], [0, 0]), "choice has 2 for 1 platform; give an index each"),
    (lambda: bound(Sum(), None, [[1.0]], [1]), "choice[0] = 1, but platform 0 has candidates 0 to 0"),
    (
        lambda: bound(Sum(), None, [[1.0, 2.0]], np.array([0.5])),
        f"choice[0] = {np.float64(0.5)!r}, but platform 0 has candidates 0 to 1",
    ),
    (
        lambda: bound(Sum(), None, [[1.0]], 0),
        "choice is 0; give a list of one index for each platform",
    ),
    (
        lambda: bound(Coverage(), W, [[SEE], [-SEE]], [0, 0]),
        "candidates[1][0]: miss probabilities must be in [0, 1]; got -0.5 at [1]",
    ),
    (
        lambda: slack(Coverage(), W, MISS, []),
        "own is empty: give the platform at least one impact, objective.nothing(belief) if it can do nothing",
    ),
    (
        lambda: slack(Coverage(), W, MISS, [SEE, 2.0 * MISS]),
        "own[1]: miss probabilities must be in [0, 1]; got 2.0 at [0]",
    ),
    (
        lambda: slack(Coverage(), W, 2.0 * MISS, [SEE]),
        "base: miss probabilities must be in [0, 1]; got 2.0 at [0]",
    ),
]


@pytest.mark.parametrize(("call", "line"), LINES, ids=[line[:40] for _, line in LINES])
def test_what_cannot_be_is_refused_in_one_line_that_names_platform_index_and_value(
    call: Callable[[], object], line: str
) -> None:
    with pytest.raises(InputError) as refused:
        call()
    assert str(refused.value) == line


def test_generators_are_refused_for_lists_before_anything_is_taken_from_them() -> None:
    impacts = (impact for impact in (SEE, MISS))
    with pytest.raises(InputError, match=r"^candidates\[1\] is <generator .*; give a list of the impacts of"):
        exhaustive(Coverage(), W, [[SEE], impacts])
    assert len(list(impacts)) == 2


@settings(deadline=None, max_examples=150)
@given(st.data())
def test_numbers_that_are_believed_give_a_bound_that_holds(data: st.DataObject) -> None:
    number = st.one_of(st.sampled_from([0.0, 0.5, 1.0, -1e-300, 1.0 + 1e-15]), st.floats())
    weights = np.array(data.draw(st.lists(number, min_size=3, max_size=3)))
    misses = np.array(data.draw(st.lists(number, min_size=12, max_size=12))).reshape(2, 2, 3)
    right = bool(
        (np.isfinite(weights) & (weights >= 0.0)).all() and ((misses >= 0.0) & (misses <= 1.0)).all()
    )
    candidates = [list(own) for own in misses]
    if not right:
        with pytest.raises(
            InputError, match=r"^(belief: weights|candidates\[\d\]\[\d\]: miss prob\w+) must be"
        ):
            agree(Coverage(), weights, candidates, Tree.chain(2))
    elif weights.max() < 1e90:
        found = agree(Coverage(), weights, candidates, Tree.chain(2))
        best = exhaustive(Coverage(), weights, candidates).value
        assert found.bound is not None
        assert found.value <= best * (1.0 + 1e-12)
        assert best <= found.bound * (1.0 + 1e-12)


@pytest.mark.parametrize("units", [(1.0, 1.0), (1e-12, 1e12), (1e150, 1e-150)], ids=str)
def test_a_prior_that_only_rounding_makes_definite_is_refused_in_any_units(
    units: tuple[float, float],
) -> None:
    scale = np.diag(units)
    alike = scale @ np.full((2, 2), 0.5) @ scale
    with pytest.raises(InputError, match=r"^belief: information must be positive definite"):
        agree(LogDet(), alike, [[EYE]], Tree.chain(1))
    apart = scale @ np.array([[0.5, 0.5 - 1e-12], [0.5 - 1e-12, 0.5]]) @ scale
    assert agree(LogDet(), apart, [[np.zeros((2, 2))]], Tree.chain(1)).value == 0.0


@settings(deadline=None, max_examples=150)
@given(st.data())
def test_matrices_that_are_believed_give_a_bound_that_holds(data: st.DataObject) -> None:
    entry = st.sampled_from([0.0, 0.25, 0.5, 1.0, 2.0, -0.5, -1.0])
    three = st.tuples(entry, entry, entry)
    prior, *measured = (np.array([[a, b], [b, c]]) for a, b, c in data.draw(st.tuples(*[three] * 5)))
    candidates = [measured[:2], measured[2:]]
    right = np.linalg.eigvalsh(prior)[0] > 1e-12 and np.linalg.eigvalsh(measured).min() >= -1e-12
    if not right:
        with pytest.raises(
            InputError, match=r"^(belief|candidates\[\d\]\[\d\]): information must be positive"
        ):
            agree(LogDet(), prior, candidates, Tree.chain(2))
    else:
        found = agree(LogDet(), prior, candidates, Tree.chain(2))
        best = exhaustive(LogDet(), prior, candidates).value
        assert found.bound is not None
        assert found.value - 1e-12 <= best <= found.bound + 1e-12


def test_the_kinds_of_array_that_mean_the_same_are_worth_the_same() -> None:
    rng = np.random.default_rng(0)
    plain = rng.choice([0.0, 1.0], size=(2, 2, 3))
    read_only = plain.copy()
    read_only.flags.writeable = False
    backwards = np.ascontiguousarray(plain[..., ::-1])[..., ::-1]
    want = exhaustive(Coverage(), W, [list(own) for own in plain])
    kinds: list[Any] = [read_only, backwards, plain.astype(bool), plain.astype(np.float32), plain.astype(int)]
    for kind in kinds:
        assert exhaustive(Coverage(), W, [list(own) for own in kind]) == want
        assert agree(Coverage(), W, kind, Tree.chain(2)).value <= want.value
    lone = plain[0, 0]
    assert exhaustive(Coverage(), W, [[lone] * 2] * 3) == exhaustive(Coverage(), W, [[lone.copy()] * 2] * 3)


@settings(deadline=None, max_examples=300)
@given(name=st.sampled_from(["objective", "belief", "candidates", "own", "impact", "choice"]), junk=JUNK)
@pytest.mark.parametrize(
    ("objective", "belief", "impact"),
    [(Coverage(), W, SEE), (CountedCoverage(), W, counted(SEE)), (LogDet(), np.eye(3), np.eye(3))],
    ids=["Coverage", "CountedCoverage", "LogDet"],
)
def test_anything_else_is_refused_too(
    objective: Objective[Any, Any], belief: Any, impact: Any, name: str, junk: Any
) -> None:
    given = {"objective": objective, "belief": belief, "candidates": [[impact], [impact, impact]]}
    choice: Any = [0, 1]
    match name:
        case "own":
            given["candidates"] = [[impact], junk]
        case "impact":
            given["candidates"] = [[impact, junk], [impact]]
        case "choice":
            choice = junk
        case _:
            given[name] = junk
    for call in (lambda: exhaustive(**given), lambda: bound(**given, choice=choice)):
        assert_done_or_refused(call)


def test_the_objectives_of_the_issue_are_refused() -> None:
    rng = np.random.default_rng(499)
    weights = rng.normal(size=6)
    candidates = [[rng.choice([0.0, 0.5, 1.0], 6) for _ in range(3)] for _ in range(3)]
    with pytest.raises(InputError, match="belief: weights must be finite and >= 0"):
        agree(Coverage(), weights, candidates, Tree.chain(3))

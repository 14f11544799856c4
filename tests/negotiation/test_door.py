"""What `negotiate` and `Tree` are given is used as it is meant, or refused in one line."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.support.junk import JUNK, assert_done_or_refused
from tests.support.places import ROOT
from tests.support.random_teams import Float, misses
from vedette import CountedCoverage, Coverage, InputError, LogDet, counted, negotiation
from vedette.problem.reach import Reach

# given what no type allows
negotiate: Any = negotiation.negotiate
Tree: Any = negotiation.Tree

W, SEE, MISS = np.array([3.0, 2.0, 1.0]), np.array([0.0, 0.5, 1.0]), np.ones(3)
TEAM, PAIR = [[SEE, MISS], [MISS, SEE]], Tree.chain(2)


class Strip(Coverage):
    """Coverage of cells at x = 0.5, 1.5, 2.5."""

    def clip(self, belief: Float, impact: Float, reach: Reach) -> Float:
        """Forget what lies in none of the boxes."""
        x = np.arange(3) + 0.5
        inside = np.array([any(box[0] <= each <= box[2] for box in reach) for each in x])
        return np.where(inside, impact, 1.0)


class Plain:
    """Float64 arrays as their bytes."""

    def encode(self, impact: Float) -> bytes:
        return impact.tobytes()

    def decode(self, data: bytes) -> Any:
        return np.frombuffer(data)


class Text(Plain):
    def encode(self, impact: Float) -> Any:
        return impact.tobytes().hex()


class Empty(Plain):
    def decode(self, data: bytes) -> Any:
        return None


LINES: list[tuple[dict[str, Any], str]] = [
    ({"tree": 2}, "tree is 2; give a Tree, say Tree.chain(2)"),
    ({"tree": [(0, 1)]}, "tree is [(0, 1)]; give a Tree, say Tree.chain(2)"),
    ({"tree": Tree.chain(3)}, "candidates has 2 lists for a tree of 3; give one each"),
    ({"scheme": "tokn"}, "unknown scheme 'tokn'; did you mean 'token'?"),
    ({"scheme": None}, "unknown scheme None; known: token, multistart, fork, async, jacobi"),
    ({"start": [0]}, "start has 1 for 2 platforms; give an index each"),
    ({"start": [0, 2]}, "start[1] = 2, but platform 1 has candidates 0 to 1"),
    ({"start": np.array([-1, 0])}, "start[0] = -1, but platform 0 has candidates 0 to 1"),
    ({"start": [0, 1.0]}, "start[1] = 1.0, but platform 1 has candidates 0 to 1"),
    ({"start": [True, 0]}, "start[0] = True, but platform 0 has candidates 0 to 1"),
    ({"start": 0}, "start is 0; give a list of one index for each platform"),
    ({"start": {0, 1}}, "start is {0, 1}; give a list of one index for each platform"),
    ({"epsilon": float("nan")}, "epsilon must be a number >= 0; got nan"),
    ({"epsilon": -1e-9}, "epsilon must be a number >= 0; got -1e-09"),
    ({"epsilon": "1e-9"}, "epsilon must be a number >= 0; got '1e-9'"),
    ({"epsilon": np.array(1e-9)}, "epsilon must be a number >= 0; got array(1.e-09)"),
    ({"max_sweeps": 0}, "max_sweeps must be at least 1; got 0"),
    ({"max_sweeps": 2.5}, "max_sweeps must be a whole number; got 2.5"),
    ({"max_sweeps": float("inf")}, "max_sweeps must be a whole number; got inf"),
    ({"inverse": "no"}, "inverse must be True or False; got 'no'"),
    ({"inverse": True}, "inverse=True belongs to scheme 'jacobi'; got 'token'"),
    (
        {"inverse": True, "scheme": "jacobi"},
        "inverse=True needs Coverage.remove(total, own); leave inverse out",
    ),
    ({"codec": "zlib"}, "codec is 'zlib'; give an object with encode(impact) and decode(data)"),
    ({"codec": Text()}, f"Text.encode returned {SEE.tobytes().hex()!r}; it must return bytes"),
    ({"codec": Empty()}, "Empty.decode returned None; it must return the impact"),
    (
        {"codec": Plain(), "belief": W[None], "candidates": [[SEE[None]], [MISS[None]]]},
        "Plain.decode of an encoded impact: miss probabilities must have shape (1, 3); got (3,)",
    ),
    ({"guard": 1}, "guard must be True or False; got 1"),
    ({"guard": False}, "guard=False belongs to scheme 'async'; got 'token'"),
    ({"reach": [(), ()]}, "reach needs Coverage.clip(belief, impact, reach); leave it out"),
    (
        {"reach": [(), ()], "scheme": "jacobi"},
        "reach goes with token, fork and async; got scheme 'jacobi'; leave reach out",
    ),
    ({"objective": Strip(), "reach": [()]}, "reach has 1 for 2 platforms; give one each"),
    ({"objective": Strip(), "reach": 4.0}, "reach is 4.0; give a list of boxes for each platform"),
    ({"objective": Strip(), "reach": [(), 4.0]}, "reach[1] is 4.0; give a list of boxes"),
    (
        {"objective": Strip(), "reach": [(), (0.0, 0.0, 1.0, 1.0)]},
        "reach[1] has 0.0; a box is lowest x, lowest y, highest x, highest y",
    ),
    (
        {"objective": Strip(), "reach": [(), ((0.0, 0.0, float("nan"), 1.0),)]},
        "reach[1] has (0.0, 0.0, nan, 1.0); a box is lowest x, lowest y, highest x, highest y",
    ),
    (
        {"objective": Strip(), "reach": [(), (("0", 0.0, 1.0, 1.0),)]},
        "reach[1] has ('0', 0.0, 1.0, 1.0); a box is lowest x, lowest y, highest x, highest y",
    ),
    (
        {"objective": Strip(), "reach": [(), (("0", 0.0, 1.0),)]},
        "reach[1] has ('0', 0.0, 1.0); a box is lowest x, lowest y, highest x, highest y",
    ),
    ({"candidates": []}, "candidates is empty: a team needs at least one platform"),
    (
        {"candidates": [[SEE], [MISS, 1.5 * SEE - 1.0]]},
        "candidates[1][1]: miss probabilities must be in [0, 1]; got -1.0 at [0]",
    ),
    ({"belief": -W}, "belief: weights must be finite and >= 0; got -3.0 at [0]"),
]


def run(**instead: Any) -> object:
    """A negotiation in which some of what it is given is something else."""
    return negotiate(**({"objective": Coverage(), "belief": W, "candidates": TEAM, "tree": PAIR} | instead))


@pytest.mark.parametrize(("instead", "line"), LINES, ids=[line[:40] for _, line in LINES])
def test_what_cannot_be_negotiated_is_refused_in_one_line_that_names_it(
    instead: dict[str, Any], line: str
) -> None:
    with pytest.raises(InputError) as refused:
        run(**instead)
    assert str(refused.value) == line


def test_the_papers_own_sweep_needs_a_chain() -> None:
    candidates = [[counted(SEE)]] * 4
    with pytest.raises(InputError) as refused:
        negotiate(CountedCoverage(), W, candidates, Tree.star(4), "jacobi", inverse=True)
    assert str(refused.value) == (
        "inverse=True needs a chain; use Tree.chain(n), or leave inverse out on other trees"
    )


def test_arrays_and_numpys_numbers_will_do_wherever_lists_and_pythons_do() -> None:
    rng = np.random.default_rng(0)
    weights, candidates, n = rng.uniform(size=12), misses(rng, 4, 3), np.int64(4)
    plain = negotiate(Coverage(), weights, candidates, Tree.chain(4), start=[0, 1, 2, 0], max_sweeps=9)
    given: dict[str, Any] = {"start": np.array([0, 1, 2, 0], np.uint8), "max_sweeps": np.int32(9)}
    assert negotiate(Coverage(), weights, np.array(candidates), Tree.chain(n), **given) == plain
    assert all(type(k) is int for k in plain.choice)


def test_boxes_may_be_lists_arrays_and_without_end() -> None:
    boxes = [[np.array([0, 0, 2, 1])], [[0.0, -np.inf, np.inf, np.inf]]]
    whole: Any = negotiate(Strip(), W, TEAM, PAIR)
    clipped: Any = negotiate(Strip(), W, TEAM, PAIR, reach=boxes)
    assert (clipped.choice, clipped.value, clipped.bound) == (whole.choice, whole.value, whole.bound)


def test_the_how_to_shows_the_lines_that_are_told() -> None:
    told = []
    for call in (
        lambda: run(tree=Tree.chain(3)),
        lambda: run(candidates=[[SEE], []]),
        lambda: run(candidates=[[SEE], [SEE + 0.5 * (SEE == 1.0)]]),
        lambda: run(objective=LogDet(), belief=np.diag([1.0, -0.5])),
        lambda: run(start=[0, 3]),
        lambda: run(scheme="tokn"),
        lambda: Tree(3, ((0, 1), (1, 2), (0, 2))),
    ):
        with pytest.raises(InputError) as refused:
            call()
        told.append(str(refused.value))
    text = (ROOT / "docs/how-to/own-problem.md").read_text(encoding="utf-8")
    shown = text.partition("## Bad input")[2].partition("```text\n")[2].partition("```")[0]
    assert shown.splitlines() == told


NAMES = ["objective", "belief", "candidates", "tree", "scheme", "start", "epsilon", "max_sweeps", "inverse"]
PLACES = ["own", "impact", "first", "boxes", "box", "edge", "codec", "reach", *NAMES]


@settings(deadline=None, max_examples=500)
@given(place=st.sampled_from(PLACES), scheme=st.sampled_from(["token", "jacobi"]), junk=JUNK)
def test_anything_else_is_refused_too(place: str, scheme: str, junk: Any) -> None:
    box = (0.0, 0.0, 1.0, 1.0)
    nested: dict[str, dict[str, Any]] = {
        "own": {"candidates": [[SEE], junk]},
        "impact": {"candidates": [[SEE, junk], [MISS]]},
        "first": {"start": [0, junk]},
        "boxes": {"objective": Strip(), "reach": [(box,), junk]},
        "box": {"objective": Strip(), "reach": [(box,), (junk,)]},
        "reach": {"objective": Strip(), "reach": junk},
    }
    if place == "edge":
        assert_done_or_refused(lambda: run(tree=Tree(2, (junk,))))
        return
    assert_done_or_refused(lambda: run(**({"scheme": scheme} | nested.get(place, {place: junk}))))


TREES: list[tuple[Callable[[], object], str]] = [
    (lambda: Tree.chain(0), "tree: n must be at least 1; got 0"),
    (lambda: Tree.chain(2.0), "tree: n must be a whole number; got 2.0"),
    (lambda: Tree.star(True), "tree: n must be a whole number; got True"),
    (lambda: Tree.balanced("3"), "tree: n must be a whole number; got '3'"),
    (lambda: Tree.balanced(3, 0), "tree: branching must be at least 1; got 0"),
    (lambda: Tree.balanced(3, 1.5), "tree: branching must be a whole number; got 1.5"),
    (lambda: Tree.random(3, seed=-1), "tree: seed must be a whole number >= 0 or a Generator; got -1"),
    (
        lambda: Tree.random(1, seed=None),
        "tree: seed must be a whole number >= 0 or a Generator; got None",
    ),
    (
        lambda: Tree(2, [(0, 0.5)]),
        "tree: edges must be pairs of platform numbers, as [(0, 1), (1, 2)]; got [(0, 0.5)]",
    ),
    (
        lambda: Tree(2, 1),
        "tree: edges must be pairs of platform numbers, as [(0, 1), (1, 2)]; got 1",
    ),
    (
        lambda: Tree.from_edges([(0, 1, 2)]),
        "tree: edges must be pairs of platform numbers, as [(0, 1), (1, 2)]; got [(0, 1, 2)]",
    ),
    (lambda: Tree.chain(3).neighbours(3), "tree: there is no platform 3; they are 0 to 2"),
    (lambda: Tree.chain(3).parents(-1), "tree: there is no platform -1; they are 0 to 2"),
    (lambda: Tree.chain(3).tour(0.0), "tree: there is no platform 0.0; they are 0 to 2"),
]


@pytest.mark.parametrize(("make", "line"), TREES, ids=[line[:40] for _, line in TREES])
def test_what_is_no_tree_is_refused_in_one_line_that_names_it(make: Callable[[], object], line: str) -> None:
    with pytest.raises(InputError) as refused:
        make()
    assert str(refused.value) == line


@settings(deadline=None, max_examples=200)
@given(kind=st.sampled_from(["n", "edges", "chain", "star", "balanced", "branching", "seed"]), junk=JUNK)
def test_any_other_tree_is_refused_too(kind: str, junk: Any) -> None:
    if kind != "edges" and isinstance(junk, int) and junk > 10**6:
        return  # a tree, but a large one
    makes: dict[str, Callable[[], object]] = {
        "n": lambda: Tree(junk, ((0, 1),)),
        "edges": lambda: Tree.from_edges(junk),
        "chain": lambda: Tree.chain(junk),
        "star": lambda: Tree.star(junk),
        "balanced": lambda: Tree.balanced(junk),
        "branching": lambda: Tree.balanced(4, junk),
        "seed": lambda: Tree.random(4, seed=junk),
    }
    assert_done_or_refused(makes[kind])


def test_equal_trees_are_equal_however_their_links_are_written() -> None:
    tree = Tree(np.int64(3), [[1, 0], np.array([2, 1])])
    assert tree == Tree(3, ((0, 1), (1, 2)))
    assert hash(tree) == hash(Tree.chain(3))
    assert Tree.from_edges(iter([(1, 0), (2, 1)])) == tree

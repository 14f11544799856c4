"""Trees: shapes, tours, and what is not a tree."""

from __future__ import annotations

import itertools
from collections import Counter

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vedette import InputError, Tree


def test_named_shapes() -> None:
    assert Tree.chain(4).edges == ((0, 1), (1, 2), (2, 3))
    assert Tree.star(4).edges == ((0, 1), (0, 2), (0, 3))
    assert Tree.balanced(6).edges == ((0, 1), (0, 2), (1, 3), (1, 4), (2, 5))
    assert Tree.balanced(5, branching=3).edges == ((0, 1), (0, 2), (0, 3), (1, 4))
    assert Tree.from_edges([(2, 1), (0, 2)]) == Tree(3, ((1, 2), (0, 2)))
    assert Tree.from_edges([]) == Tree.chain(1) == Tree.star(1) == Tree.balanced(1) == Tree.random(1, seed=0)


def test_neighbours_and_parents_of_a_small_tree() -> None:
    tree = Tree.from_edges([(0, 3), (3, 1), (3, 2)])
    assert [tree.neighbours(i) for i in range(4)] == [(3,), (3,), (3,), (0, 1, 2)]
    assert tree.parents() == (None, 3, 3, 0)
    assert tree.parents(root=2) == (3, 3, None, 2)
    assert tree.tour() == (0, 3, 1, 3, 2, 3, 0)


@settings(deadline=None, max_examples=60)
@given(n=st.integers(1, 40), seed=st.integers(0, 1000), pick=st.integers(0, 1000))
def test_the_tour_takes_every_link_once_each_way_and_comes_home(n: int, seed: int, pick: int) -> None:
    tree, root = Tree.random(n, seed=seed), pick % n
    visits = tree.tour(root)
    both_ways = [*tree.edges, *((b, a) for a, b in tree.edges)]
    assert Counter(itertools.pairwise(visits)) == Counter(both_ways)
    assert visits[0] == visits[-1] == root
    for i, parent in enumerate(tree.parents(root)):
        assert (parent is None) if i == root else visits[visits.index(i) - 1] == parent


def test_random_trees_are_all_labelled_trees_about_equally_often() -> None:
    drawn = Counter(tuple(sorted(Tree.random(4, seed=seed).edges)) for seed in range(3200))
    assert len(drawn) == 16  # Cayley: 4^2
    assert min(drawn.values()) > 130  # 200 expected
    assert Tree.random(9, seed=5) == Tree.random(9, seed=5)


def test_only_paths_are_chains() -> None:
    assert Tree.from_edges([(2, 0), (0, 1)]).is_chain
    assert not Tree.star(4).is_chain


@pytest.mark.parametrize(
    ("n", "edges", "words"),
    [
        (0, (), "n must be at least 1; got 0"),
        (3, ((0, 1),), "3 platforms need 2 edges"),
        (2, ((0, 2),), r"edge \(0, 2\) is out of range; platforms are 0 to 1"),
        (2, ((-1, 0),), "out of range"),
        (3, ((0, 1), (1, 2), (0, 2)), r"edge \(0, 2\) closes a cycle"),
        (4, ((0, 1), (2, 3), (3, 2)), r"edge \(3, 2\) closes a cycle"),
        (2, ((1, 1),), r"edge \(1, 1\) closes a cycle"),
    ],
)
def test_what_is_not_a_tree_is_refused(n: int, edges: tuple[tuple[int, int], ...], words: str) -> None:
    with pytest.raises(InputError, match=words):
        Tree(n, edges)


def test_from_edges_refuses_gaps_and_things_that_are_not_pairs() -> None:
    with pytest.raises(InputError, match="1000000000 platforms need"):
        Tree.from_edges([(0, 999_999_999)])
    for bad in ([(0, 1, 2)], [0, 1], [(0.5, 1)]):
        with pytest.raises(InputError, match="pairs of platform numbers"):
            Tree.from_edges(bad)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="branching must be at least 1"):
        Tree.balanced(3, branching=0)

"""Reaches on their way round the tree: all hear of all beyond each link, and anywhere stays anywhere."""

from __future__ import annotations

from vedette.agent.reaches import reaches_to_tell
from vedette.negotiation import Tree
from vedette.problem import Reach


def heard_by_all(tree: Tree, own: list[Reach | None]) -> list[dict[int, Reach | None]]:
    """Let reaches go up to platform 0 and down again, as ``Flushed`` and ``Freeze`` carry them."""
    parents = tree.parents(0)
    order = [0]
    for i in order:
        order.extend(k for k in tree.neighbours(i) if k != parents[i])
    heard: list[dict[int, Reach | None]] = [{} for _ in own]
    for i in reversed(order):
        if (parent := parents[i]) is not None:
            heard[parent][i] = reaches_to_tell(own[i], heard[i], tree.neighbours(i))[parent]
    for i in order:
        told = reaches_to_tell(own[i], heard[i], tree.neighbours(i))
        for k in tree.neighbours(i):
            if k != parents[i]:
                heard[k][i] = told[k]
    return heard


def beyond(tree: Tree, i: int, k: int) -> set[int]:
    """Return the platforms beyond the link from i to k."""
    found, open_ = {k}, [k]
    while open_:
        for j in tree.neighbours(open_.pop()):
            if j not in found and j != i:
                found.add(j)
                open_.append(j)
    return found


def test_what_is_heard_holds_the_reach_of_everybody_beyond_the_link_in_whole_metres() -> None:
    for seed in range(10):
        tree = Tree.random(9, seed=seed)
        own: list[Reach | None] = [((7.3 * i, -i - 0.5, 7.3 * i + 4.2, i + 0.5),) for i in range(9)]
        for i, heard in enumerate(heard_by_all(tree, own)):
            assert heard.keys() == set(tree.neighbours(i))
            for k, reach in heard.items():
                assert reach is not None
                assert all(isinstance(edge, int) for box in reach for edge in box)
                for j in beyond(tree, i, k):
                    ((x0, y0, x1, y1),) = own[j] or ()
                    assert any(a <= x0 and b <= y0 and x1 <= c and y1 <= d for a, b, c, d in reach)


def test_one_robot_that_may_go_anywhere_unbounds_exactly_the_sides_it_is_on() -> None:
    found = set()
    for seed in range(10):
        tree = Tree.random(7, seed=seed)
        own: list[Reach | None] = [((0.0, 0.0, 1.0, 1.0),)] * 7
        own[seed % 7] = None
        for i, heard in enumerate(heard_by_all(tree, own)):
            for k, reach in heard.items():
                assert (reach is None) == (seed % 7 in beyond(tree, i, k))
                found.add(reach is None)
    assert found == {False, True}

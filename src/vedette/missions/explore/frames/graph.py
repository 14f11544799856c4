"""Which contributors are joined, and where their frames lie in each other: the pose graph, solved.

docs/align.md, section 6
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vedette.fusion.frame_edges import FrameEdge
from vedette.fusion.link import Key
from vedette.maps.transform import IDENTITY, Transform

CLOSED = 0.3, math.radians(2.0)  # an edge that disagrees more with heavier ones counts for nothing [m, rad]
TOLERANCE = 0.05, math.radians(0.5)  # within which two robots' solutions are one [m, rad]
ARM = 5.0  # about the middle of a map, places of which edges say where they lie [m]
MOST_MET = 700  # that a meeting weighs, as walls in common [cm]: no more than any match
STEPS = 6  # of Gauss and Newton

Floats = NDArray[np.float64]


class Placed(NamedTuple):
    """Where a contributor's frame lies."""

    anchor: Key  # the lowest of those that are joined, whose frame is theirs
    there: Transform  # T_anchor_contributor
    met: bool = False  # a meeting is among the edges between the two


Graph = Mapping[Key, Placed]


Agrees = Callable[[Key, Key, Transform], bool]


def solved(
    edges: Iterable[FrameEdge],
    keys: Collection[Key],
    middles: Mapping[Key, tuple[float, float]],
    allowed: Agrees,
) -> dict[Key, Placed]:
    """Return where all contributors lie that edges join; one that nothing joins lies in its own frame.

    A meeting counts if evidence does not speak against it; of edges between two the heaviest. Heavier ones go
    first, and one that would close a cycle has to close it. Where two that are joined contradict each other,
    the lightest edge between them is left out, and so on until nobody does.

    Args:
        edges: matches that evidence bears out, and meetings that both who met tell.
        keys: contributors.
        middles: of each one's map [m], its own frame.
        allowed: whether the evidence of two does not speak against it that b lies in a's frame so.
    """
    counting = [
        edge
        for edge in (edge.upwards for edge in edges)
        if edge.a in keys and edge.b in keys
        if not edge.met or allowed(edge.a, edge.b, edge.there)
    ]
    left = _heaviest(counting)
    while True:
        graph, tree = _joined(left, keys, middles)
        wrong = _contradicted(graph, tree, allowed)
        if wrong is None:
            return {key: _said(placed, key, tree) for key, placed in graph.items()}
        left.remove(wrong)


def told_by_both(
    told: Mapping[Key, Sequence[FrameEdge]], middles: Mapping[Key, tuple[float, float]]
) -> list[FrameEdge]:
    """Return the meetings of which both robots tell, and about the same, as certain as the less certain is.

    Args:
        told: by contributor, edges of any kind.
        middles: of each one's map [m], its own frame.
    """
    met = {
        key: [edge if edge.a == key else edge.inverse for edge in edges if edge.met and key in edge[:2]]
        for key, edges in told.items()
    }
    kept = set[FrameEdge]()
    for a, edges in met.items():
        for edge in edges:
            if not {a, edge.b} <= middles.keys():
                continue
            theirs = [other.inverse for other in met.get(edge.b, ()) if other.b == a]
            alike = [other.weight for other in theirs if _is_closed(edge, other.there, middles)]
            if alike:
                kept.add(edge._replace(weight=min(edge.weight, max(alike), MOST_MET)))
    return sorted(kept)


def _is_closed(edge: FrameEdge, there: Transform, middles: Mapping[Key, tuple[float, float]]) -> bool:
    """Tell whether an edge says about the same as ``T_a_b`` by other edges."""
    shift, turn = there.apart(edge.there, *middles[edge.b])
    return shift <= CLOSED[0] and turn <= CLOSED[1]


def _heaviest(edges: Iterable[FrameEdge]) -> list[FrameEdge]:
    """Return one edge for two contributors, heaviest first."""
    best: dict[tuple[Key, Key], FrameEdge] = {}
    for edge in edges:
        pair = edge.a, edge.b
        if pair not in best or _rank(edge) < _rank(best[pair]):
            best[pair] = edge
    return sorted(best.values(), key=_rank)


def _rank(edge: FrameEdge) -> tuple[int, FrameEdge]:
    return -edge.weight, edge


def _joined(
    edges: Sequence[FrameEdge], keys: Collection[Key], middles: Mapping[Key, tuple[float, float]]
) -> tuple[dict[Key, Placed], list[FrameEdge]]:
    """Return where contributors lie by a tree of the heaviest edges and what agrees with it; and the tree."""
    graph = {key: Placed(key, IDENTITY) for key in sorted(keys)}
    tree, closing = list[FrameEdge](), list[FrameEdge]()
    for edge in edges:
        a, b = graph[edge.a], graph[edge.b]
        if a.anchor == b.anchor:
            if _is_closed(edge, a.there.inverse().after(b.there), middles):
                closing.append(edge)
            continue
        tree.append(edge)
        onto = a.there.after(edge.there).after(b.there.inverse())  # T_anchor_anchor
        first, then = (a.anchor, b.anchor) if a.anchor < b.anchor else (b.anchor, a.anchor)
        move = onto if first == a.anchor else onto.inverse()
        for key, placed in graph.items():
            if placed.anchor == then:
                graph[key] = Placed(first, move.after(placed.there))
    if closing:
        graph = _relaxed(graph, [*tree, *closing], middles)
    return graph, tree


def _said(placed: Placed, key: Key, tree: Sequence[FrameEdge]) -> Placed:
    """Say whether a contributor lies where it does by a meeting."""
    return placed._replace(met=any(edge.met for edge in _way(tree, placed.anchor, key)))


def _contradicted(graph: Graph, tree: Sequence[FrameEdge], allowed: Agrees) -> FrameEdge | None:
    """Return the lightest edge between two that are joined and contradict each other; None: nobody does."""
    keys = sorted(graph)
    for at, a in enumerate(keys):
        for b in keys[at + 1 :]:
            one, other = graph[a], graph[b]
            between = one.there.inverse().after(other.there)
            if one.anchor == other.anchor and not allowed(a, b, between):
                return max(_way(tree, a, b), key=_rank)
    return None


def _way(tree: Sequence[FrameEdge], a: Key, b: Key) -> list[FrameEdge]:
    """Return the edges of a tree between two."""
    came: dict[Key, tuple[Key, FrameEdge] | None] = {a: None}
    open_ = [a]
    while open_:
        at = open_.pop()
        for edge in tree:
            if at in (edge.a, edge.b):
                beyond = edge.b if at == edge.a else edge.a
                if beyond not in came:
                    came[beyond] = at, edge
                    open_.append(beyond)
    way = []
    step = came[b]
    while step is not None:
        way.append(step[1])
        step = came[step[0]]
    return way


def _relaxed(
    graph: Graph, edges: Sequence[FrameEdge], middles: Mapping[Key, tuple[float, float]]
) -> dict[Key, Placed]:
    """Return where contributors lie by least squares over all edges, (V144)."""
    free = [key for key, placed in graph.items() if placed.anchor != key]
    at = {key: 3 * number for number, key in enumerate(free)}
    poses = {key: np.array((*_metres(placed.there), placed.there.radians)) for key, placed in graph.items()}
    for _ in range(STEPS):
        matrix, right = 1e-9 * np.eye(3 * len(free)), np.zeros(3 * len(free))
        for edge in edges:
            told = edge.there.places(_arms(middles[edge.b]))  # in a's frame
            rows = np.zeros((6, 3 * len(free)))
            where_a, by_a = _moved(poses[edge.a], told)
            where_b, by_b = _moved(poses[edge.b], _arms(middles[edge.b]))
            for key, by, sign in ((edge.a, by_a, 1.0), (edge.b, by_b, -1.0)):
                if key in at:
                    rows[:, at[key] : at[key] + 3] += sign * by
            weight = 1.0 + edge.weight
            matrix += weight * rows.T @ rows
            right -= weight * rows.T @ (where_a - where_b).ravel()
        step = np.linalg.solve(matrix, right)
        for key, first in at.items():
            poses[key] = poses[key] + step[first : first + 3]
    return {key: Placed(placed.anchor, Transform.of(*poses[key].tolist())) for key, placed in graph.items()}


def _arms(middle: tuple[float, float]) -> Floats:
    """Return three places of a map ``(3, 2)`` by which it is known how it lies [m]."""
    return np.array(middle) + ARM * np.array([[1.0, 0.0], [-0.5, 0.75], [-0.5, -0.75]])


def _moved(pose: Floats, points: Floats) -> tuple[Floats, Floats]:
    """Return where points lie after a motion ``(x, y, angle)``, and the derivatives of that, ``(6, 3)``."""
    cos, sin = math.cos(pose[2]), math.sin(pose[2])
    rotation = np.array([[cos, -sin], [sin, cos]])
    turned = points @ rotation.T
    by = np.zeros((len(points), 2, 3))
    by[:, 0, 0] = by[:, 1, 1] = 1.0
    by[:, 0, 2], by[:, 1, 2] = -turned[:, 1], turned[:, 0]
    return turned + pose[:2], by.reshape(-1, 3)


def _metres(there: Transform) -> tuple[float, float]:
    return there.x / 1000.0, there.y / 1000.0


def within(one: Transform, other: Transform, x: float, y: float) -> bool:
    """Tell whether two transforms take a place and its surroundings to about the same."""
    shift, turn = one.apart(other, x, y)
    return shift <= TOLERANCE[0] and turn <= TOLERANCE[1]

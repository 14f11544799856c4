"""Routes over all stops, the longest as short as can be found: insertion, then exchange and 2-opt."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

TIE = 0.01  # weight of the total length beside the longest route's
LEAST = 1e-6  # a change must save so much [m]; also ends the search

Routes = list[list[int]]


def plan_routes(first: NDArray[np.float64], between: NDArray[np.float64]) -> Routes:
    """``min_r [max_i L_i(r) + 0.01 sum_i L_i(r)]`` over open routes of n robots through K stops.

    By local search: stops are inserted where their route stays shortest, once the hardest to insert first and
    once the easiest; then single stops move or change places, and stretches are reversed, while that helps.
    The better of the two is returned.
    docs/theory.md (V62)

    Args:
        first: (n, K) path lengths from each robot to each stop [m], infinite where it cannot go.
        between: (K, K) between stops [m], symmetric.

    Returns:
        Each robot's stops in order; stops that nobody can reach are in none.
    """
    graph = Graph.of(first, between)
    found = [improve(graph, insert_all(graph, hardest_first)) for hardest_first in (True, False)]
    return min(found, key=lambda routes: float(graph.cost(graph.lengths(routes))))


@dataclass(frozen=True, eq=False)
class Graph:
    """Stops 0 to K - 1, robots K to K + n - 1, and the end of all routes, which costs nothing to get to."""

    steps: NDArray[np.float64]  # (K + n + 1, K + n + 1) [m]
    robots: int

    @classmethod
    def of(cls, first: NDArray[np.float64], between: NDArray[np.float64]) -> Graph:
        """Join the robots to the stops."""
        robots, stops = first.shape
        steps = np.zeros((stops + robots + 1, stops + robots + 1))
        steps[:stops, :stops] = between
        steps[stops:-1, :stops] = first
        return cls(steps, robots)

    @property
    def stops(self) -> int:
        """How many stops there are."""
        return len(self.steps) - self.robots - 1

    def path(self, robot: int, route: list[int]) -> NDArray[np.int64]:
        """Return a route's nodes, from the robot to the end."""
        return np.array([self.stops + robot, *route, len(self.steps) - 1])

    def lengths(self, routes: Routes) -> NDArray[np.float64]:
        """Return the length of each route [m]."""
        paths = [self.path(robot, route) for robot, route in enumerate(routes)]
        return np.array([self.steps[path[:-1], path[1:]].sum() for path in paths])

    def cost(self, lengths: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return what is made small, for lengths along the last axis [m]."""
        total: NDArray[np.float64] = lengths.max(axis=-1) + TIE * lengths.sum(axis=-1)
        return total


def insert_all(graph: Graph, hardest_first: bool) -> Routes:
    """Insert every stop that can be reached where its route stays shortest, in order of that length."""
    routes: Routes = [[] for _ in range(graph.robots)]
    left = list(range(graph.stops))
    while left:
        edges = _Edges.of(graph, routes)
        longer = graph.lengths(routes)[edges.owner] + edges.detours(graph, np.array(left))
        best = longer.argmin(axis=1)
        after = longer[np.arange(len(left)), best]
        if not np.isfinite(after).any():
            break
        least = np.where(np.isfinite(after), -after, np.inf) if hardest_first else after
        stop = int(np.argmin(least))
        edge = int(best[stop])
        routes[edges.owner[edge]].insert(int(edges.place[edge]), left.pop(stop))
    return routes


def improve(graph: Graph, routes: Routes) -> Routes:
    """Take the best change of each kind in turn while one saves something; never worse than ``routes``."""
    routes = [list(route) for route in routes]
    cost = float(graph.cost(graph.lengths(routes)))
    while True:
        found = min(
            (
                (float(graph.cost(graph.lengths(new))), i, new)
                for i, new in enumerate(_changes(graph, routes))
            ),
            default=None,
        )
        if found is None or found[0] > cost - LEAST:
            return routes
        cost, _, routes = found


def _changes(graph: Graph, routes: Routes) -> Iterator[Routes]:
    """Yield the best change of each kind."""
    for change in (_best_move, _best_swap):
        changed = change(graph, routes)
        if changed is not None:
            yield changed
    for robot, route in enumerate(routes):
        if len(route) > 1:
            yield [*routes[:robot], _best_reversal(graph, robot, route), *routes[robot + 1 :]]


@dataclass(frozen=True, eq=False)
class _Edges:
    """The steps of all routes one after the other: where a stop can be inserted."""

    start: NDArray[np.int64]  # (E,) node that a step is from
    end: NDArray[np.int64]  # (E,) node that it leads to
    owner: NDArray[np.int64]  # (E,) whose route
    place: NDArray[np.int64]  # (E,) a stop inserted here has this place in the route

    @classmethod
    def of(cls, graph: Graph, routes: Routes) -> _Edges:
        paths = [graph.path(robot, route) for robot, route in enumerate(routes)]
        return cls(
            np.concatenate([path[:-1] for path in paths]),
            np.concatenate([path[1:] for path in paths]),
            np.repeat(np.arange(len(paths)), [len(path) - 1 for path in paths]),
            np.concatenate([np.arange(len(path) - 1) for path in paths]),
        )

    def detours(self, graph: Graph, stops: NDArray[np.int64]) -> NDArray[np.float64]:
        """How much longer each step becomes by way of each stop, (S, E) [m]."""
        there = graph.steps[self.start[None], stops[:, None]] + graph.steps[stops[:, None], self.end[None]]
        return there - graph.steps[self.start, self.end]

    @property
    def last(self) -> NDArray[np.intp]:
        """The step into each stop on the routes, in their order."""
        return np.flatnonzero(np.diff(self.owner, append=-1) == 0)


def _best_move(graph: Graph, routes: Routes) -> Routes | None:
    """Take one stop out and insert it elsewhere, where that is best."""
    edges = _Edges.of(graph, routes)
    into = edges.last
    if not len(into):
        return None
    stops, owner = edges.end[into], edges.owner[into]
    before, after = edges.start[into], edges.end[into + 1]
    saved = graph.steps[before, stops] + graph.steps[stops, after] - graph.steps[before, after]
    longer = edges.detours(graph, stops)
    lengths = np.broadcast_to(graph.lengths(routes), (*longer.shape, len(routes))).copy()
    s, e = np.indices(longer.shape)
    lengths[s, e, owner[:, None]] -= saved[:, None]
    lengths[s, e, edges.owner[None]] += longer
    cost = graph.cost(lengths)
    cost[np.arange(len(into)), into] = cost[np.arange(len(into)), into + 1] = np.inf  # its own two steps
    which, edge = np.unravel_index(int(np.argmin(cost)), cost.shape)
    if not np.isfinite(cost[which, edge]):
        return None
    changed = [list(route) for route in routes]
    source, target, place = int(owner[which]), int(edges.owner[edge]), int(edges.place[edge])
    from_place = int(edges.place[into[which]])
    changed[source].pop(from_place)
    changed[target].insert(place - (source == target and from_place < place), int(stops[which]))
    return changed


def _best_swap(graph: Graph, routes: Routes) -> Routes | None:
    """Let two stops of different routes change places, where that is best."""
    edges = _Edges.of(graph, routes)
    into = edges.last
    stops, owner, place = edges.end[into], edges.owner[into], edges.place[into]
    before, after = edges.start[into], edges.end[into + 1]
    now = graph.steps[before, stops] + graph.steps[stops, after]
    then = graph.steps[before[:, None], stops[None]] + graph.steps[stops[None], after[:, None]]
    lengths = np.broadcast_to(graph.lengths(routes), (*then.shape, len(routes))).copy()
    a, b = np.indices(then.shape)
    lengths[a, b, owner[:, None]] += then - now[:, None]
    lengths[a, b, owner[None]] += then.T - now[None]
    cost = np.where(owner[:, None] != owner[None], graph.cost(lengths), np.inf)
    if not np.isfinite(cost).any():
        return None
    i, j = np.unravel_index(int(np.argmin(cost)), cost.shape)
    changed = [list(route) for route in routes]
    changed[owner[i]][place[i]], changed[owner[j]][place[j]] = int(stops[j]), int(stops[i])
    return changed


def _best_reversal(graph: Graph, robot: int, route: list[int]) -> list[int]:
    """Reverse the stretch of a route that saves most (2-opt)."""
    path, steps = graph.path(robot, route), graph.steps
    i, j = np.triu_indices(len(route), 1)
    i, j = i + 1, j + 1  # as places in the path
    saved = steps[path[i - 1], path[i]] + steps[path[j], path[j + 1]]
    saved = saved - steps[path[i - 1], path[j]] - steps[path[i], path[j + 1]]
    best = int(np.argmax(saved))
    low, high = int(i[best]) - 1, int(j[best])
    return route[:low] + route[low:high][::-1] + route[high:]

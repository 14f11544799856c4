"""Routes from which a known world is seen, the longest as short as local search finds it.

Stops are inserted by what they show for each metre; then, over and over, some are taken out, others inserted,
and routes put in a better order (ruin and recreate: Shaw 1998; Schrimpf et al. 2000).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from vedette.domains.mapping.baselines.routes import Graph, Routes, improve
from vedette.domains.mapping.stops import SURE_CLEARANCE
from vedette.kernels import distance
from vedette.kernels.lidar import cast_rays, integrate_scan
from vedette.kernels.tiles import TiledGrid, Tiling
from vedette.maps.world import World, reachable_poses
from vedette.missions.explore.evidence import CLAMP, GAIN_HIT, GAIN_MISS, NUDGE
from vedette.record.explore.score import Reference
from vedette.team import PlatformSpec

STEP = 0.4  # between places to look from, and between looks on the way [m]
RAYS = 720  # of a look, more than a lidar has: it turns on its way
ALONE = np.empty((0, 3))  # nobody else in sight
TOTAL = 0.1  # weight of all ways beside the longest where a stop is inserted
NEAR = 1.0  # stops that cost less than this count as if they cost it [m]
NOISE = 0.3  # of what a stop shows for each metre, so that others are tried; logarithms
SLACK = 0.02  # so much longer routes are gone on with at first, none in the end


@dataclass(frozen=True, eq=False)
class Leg:
    """The way between two places, and what is seen on it."""

    along: NDArray[np.float64]  # (M,) where it is looked from, after the way's beginning [m]
    seen: tuple[NDArray[np.int64], ...]  # (M) the cells seen at each of them
    length: float  # [m]

    @property
    def back(self) -> Leg:
        """The same way from its end."""
        return Leg(self.length - self.along[::-1], self.seen[::-1], self.length)


class KnownWorld:
    """What a team of equal robots sees from where, in a world that it knows.

    Nodes are the places to look from, then the robots' starts. Every other of the cells that can be seen at
    all is counted, those of one colour on a chess-board.
    """

    def __init__(
        self,
        world: World,
        specs: Sequence[PlatformSpec],
        starts: NDArray[np.float64],
        places: NDArray[np.int64] | None = None,
    ) -> None:
        """Take ``places``, flat cells, to look from; all of a lattice if none are given."""
        self.world, self._reach = world, specs[0].range
        # (R, C) where a robot's centre may be
        self.open = reachable_poses(world, specs[0].radius + SURE_CLEARANCE, *starts[0, :2])
        row, col = np.indices(world.frame.shape)
        counted = Reference(world, specs, starts).coverable & ((row + col) % 2 == 0)
        # (R * C,) of each cell among the counted ones, -1 of the others
        self.number = np.where(counted, np.cumsum(counted).reshape(counted.shape) - 1, -1).ravel()
        self.cells = int(np.count_nonzero(counted))
        if places is None:
            every = max(1, round(STEP / world.frame.resolution))
            places = np.flatnonzero(self.open & (row % every == every // 2) & (col % every == every // 2))
        at = [world.frame.flat(x, y) for x, y in starts[:, :2].tolist()]
        self.nodes = np.concatenate((places, np.array(at, np.int64)))
        ways = distance.distance_matrix(self.open, self.nodes, world.frame.resolution).astype(np.float64)
        self.graph = Graph.of(ways[len(places) :, : len(places)], ways[: len(places), : len(places)])
        self._looked: dict[int, NDArray[np.int64]] = {}
        seen = [self._look(cell) for cell in places.tolist()]
        ends = np.cumsum([0, *map(len, seen)])
        hits = np.ones(ends[-1], np.int32), np.concatenate([*seen, np.empty(0, np.int64)]), ends
        # (K, N) whether a place shows a cell
        self.sight = csr_array(hits, shape=(len(places), self.cells))
        self._legs: dict[tuple[int, int], Leg] = {}

    def legs(self, robot: int, route: list[int]) -> Iterator[Leg]:
        """Yield the ways of a route."""
        nodes = self.graph.path(robot, route)[:-1].tolist()
        for a, b in pairwise(nodes):
            yield self._leg(a, b) if a > b else self._leg(b, a).back  # from starts, which may be off the ways

    def lengths(self, routes: Routes) -> NDArray[np.float64]:
        """Return the length of each route, driven as straight as bodies fit [m]."""
        return np.array([sum(leg.length for leg in self.legs(*each)) for each in enumerate(routes)])

    def cost(self, routes: Routes) -> float:
        """Return what is made small [m]."""
        return float(self.graph.cost(self.lengths(routes)))

    def seen(self, routes: Routes) -> NDArray[np.bool_]:
        """Return which of the counted cells are seen, (N,)."""
        found = np.zeros(self.cells, np.bool_)
        for _, cells in self._looks(routes):
            found[cells] = True
        return found

    def share(self, routes: Routes) -> float:
        """Return the share of the counted cells that is seen."""
        return float(self.seen(routes).mean())

    def known_after(self, routes: Routes, share: float) -> float:
        """Return how far each robot has come when so much is seen, all as fast; infinity if never [m]."""
        found = np.zeros(self.cells, np.bool_)
        for way, cells in sorted(self._looks(routes), key=lambda look: look[0]):
            found[cells] = True
            if found.mean() >= share:
                return way
        return float("inf")

    def _looks(self, routes: Routes) -> Iterator[tuple[float, NDArray[np.int64]]]:
        """Yield how far its robot has come and what it sees, for every look of a team."""
        for robot, route in enumerate(routes):
            yield 0.0, self._look(int(self.nodes[self.graph.stops + robot]))
            gone = 0.0
            for leg in self.legs(robot, route):
                yield from zip((gone + leg.along).tolist(), leg.seen, strict=True)
                gone += leg.length

    def _leg(self, a: int, b: int) -> Leg:
        if (a, b) not in self._legs:
            frame = self.world.frame
            path = distance.shortest_path(self.open, self.nodes[a], self.nodes[b], frame.resolution)
            corners = frame.centres(distance.shortcut(self.open, path))
            gone = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(corners, axis=0).T))))
            along = np.linspace(0.0, gone[-1], 1 + int(np.ceil(gone[-1] / STEP)))
            x, y = (np.interp(along, gone, axis) for axis in corners.T)
            cells = [frame.flat(*place) for place in zip(x.tolist(), y.tolist(), strict=True)]
            self._legs[a, b] = Leg(along, tuple(map(self._look, cells)), float(gone[-1]))
        return self._legs[a, b]

    def _look(self, cell: int) -> NDArray[np.int64]:
        """Return the counted cells that a lidar without noise shows from a cell's centre."""
        if cell not in self._looked:
            self._looked[cell] = self._scan(cell)
        return self._looked[cell]

    def _scan(self, cell: int) -> NDArray[np.int64]:
        frame = self.world.frame
        angles = np.linspace(0.0, 2 * np.pi, RAYS, endpoint=False)
        row, col = divmod(cell, frame.cols)
        place = (col + 0.5) * frame.resolution, (row + 0.5) * frame.resolution
        ranges = cast_rays(self.world.solid, frame.resolution, *place, angles, self._reach, ALONE)
        hits, ranges = np.isfinite(ranges), np.minimum(ranges, self._reach)
        nothing, gains = TiledGrid(Tiling(*frame.shape), np.int8), (GAIN_HIT, GAIN_MISS, CLAMP)
        nudge = NUDGE * frame.resolution
        seen = integrate_scan(nothing, frame.resolution, *place, angles, ranges, hits, *gains, nudge)
        numbers = self.number[seen]
        return np.asarray(numbers[numbers >= 0])


def plan(known: KnownWorld, share: float, rounds: int, rng: np.random.Generator) -> Routes:
    """Return routes that see a share of what is counted, or all that the places show; their places in order.

    ``rounds`` of local search, and nothing else, say how long it takes.
    """
    everything = np.zeros(known.cells, np.bool_)
    everything[known.sight.indices] = True
    wanted = int(np.ceil(min(share, everything.mean()) * known.cells - 1e-9))
    nothing: Routes = [[] for _ in range(known.graph.robots)]
    best = current = _settled(known, _inserted(known, nothing, wanted), wanted)
    for k in range(rounds):
        trial = _settled(known, _inserted(known, _ruined(known, current, rng), wanted, rng), wanted)
        if np.count_nonzero(known.seen(trial)) < wanted:
            continue
        if known.cost(trial) < known.cost(current) * (1.0 + SLACK * (1.0 - (k + 1) / rounds)):
            current = trial
        best = min(best, current, key=known.cost)
    return best


def _inserted(
    known: KnownWorld, routes: Routes, wanted: int, rng: np.random.Generator | None = None
) -> Routes:
    """Insert places, those that show most of what is lacking for each metre first, until enough is seen."""
    routes, graph = [list(route) for route in routes], known.graph
    while (lacking := wanted - np.count_nonzero(seen := known.seen(routes))) > 0:
        paths = [graph.path(*each) for each in enumerate(routes)]
        start, end = (np.concatenate([path[part] for path in paths]) for part in (slice(-1), slice(1, None)))
        owner = np.repeat(np.arange(len(paths)), [len(path) - 1 for path in paths])
        longer = graph.steps[start, : graph.stops] + graph.steps[: graph.stops, end].T
        longer -= graph.steps[start, end][:, None]
        lengths = graph.lengths(routes)
        price = np.maximum(lengths[owner][:, None] + longer - lengths.max(), 0.0) + TOTAL * longer
        edge, places = price.argmin(axis=0), np.arange(graph.stops)
        worth = np.minimum(known.sight @ ~seen, lacking) / np.maximum(price[edge, places], NEAR)
        if rng is not None:
            worth *= np.exp(NOISE * rng.standard_normal(graph.stops))
        chosen = int(worth.argmax())
        if not worth[chosen] > 0.0:
            break
        before = int(np.flatnonzero(owner == owner[edge[chosen]])[0])
        routes[owner[edge[chosen]]].insert(int(edge[chosen]) - before, chosen)
    return routes


def _settled(known: KnownWorld, routes: Routes, wanted: int) -> Routes:
    """Put routes in a better order, see what is no longer seen on the way, and leave out needless stops."""
    used, graph = sorted({stop for route in routes for stop in route}), known.graph
    if not used:
        return routes
    stops, steps = np.array(used), graph.steps
    own = Graph.of(steps[graph.stops : -1][:, stops], steps[np.ix_(stops, stops)])
    ordered = improve(own, [[used.index(stop) for stop in route] for route in routes])
    routes = _inserted(known, [[used[stop] for stop in route] for route in ordered], wanted)
    for stop in [stop for route in routes for stop in route]:
        fewer = [[other for other in route if other != stop] for route in routes]
        if np.count_nonzero(known.seen(fewer)) >= wanted and known.cost(fewer) <= known.cost(routes):
            routes = fewer
    return routes


def _ruined(known: KnownWorld, routes: Routes, rng: np.random.Generator) -> Routes:
    """Take out the stops about one of them, or of the longest route, a tenth to half of all."""
    stops = np.array([stop for route in routes for stop in route], np.int64)
    if not len(stops):
        return routes
    count = int(np.ceil(rng.uniform(0.1, 0.5) * len(stops)))
    if rng.integers(2):
        middle = rng.choice(stops)
        out = stops[np.argsort(known.graph.steps[middle, stops], kind="stable")[:count]]
    else:
        longest = routes[int(known.lengths(routes).argmax())]
        out = rng.permutation(longest)[:count]
    return [[stop for stop in route if stop not in out] for route in routes]

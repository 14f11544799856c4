"""A simulated SLAM: odometry drifts, and where the robot comes by again its whole past is put right."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vedette.agent.events import Scan
from vedette.kernels import lidar
from vedette.kernels.tiles import SIDE, TiledGrid, Tiling
from vedette.maps import FREE, OCCUPIED, UNKNOWN, GridFrame
from vedette.missions.explore.evidence import CLAMP, GAIN_HIT, GAIN_MISS, NUDGE
from vedette.missions.explore.own_map import OwnMap
from vedette.missions.explore.passers_by import PassersBy
from vedette.sim.odometry import Odometry, laid_at, seen_from
from vedette.sim.pose_graph import PoseGraph
from vedette.team import PlatformSpec

Floats = NDArray[np.float64]

PERIOD = 1.0  # between kept scans, at least [s]
AGAIN = 5.0  # the map is told again so often, news or not [s]
MOVED = 0.05, math.radians(3.0)  # since the last kept scan, the one or the other, at least [m, rad]
AROUND = 20.0  # ground beside the world on which drift may lay the map [m]
LOOP = 6.0  # way since an earlier place, and since the last closure, from which a loop can be closed [m]
BESIDE = 2.0  # an earlier place as near as this, and in sight, is recognised [m]
MATCHED = np.array((0.02, 0.02, math.radians(0.2)))  # deviation of where it is then seen [m, m, rad]
LEAST = 1e-4  # deviation of any motion that was counted [m, rad]


class _Kept(NamedTuple):
    """A scan from a place of the graph."""

    angles: Floats  # (B,) from the heading [rad]
    ranges: Floats  # (B,) [m], finite
    hits: NDArray[np.bool_]  # (B,)


@dataclass(eq=False)
class Slam:
    """Where one robot takes itself to be, and its map; places are x, y [m], heading [rad], team frame."""

    frame: GridFrame  # of the world: the map's cells are aligned with its
    spec: PlatformSpec
    start: Floats  # (3,) which is told exactly
    rng: np.random.Generator
    closures: int = 0
    _odometry: Odometry = field(init=False)
    _graph: PoseGraph = field(init=False)
    _true: Floats = field(init=False)  # (3,) now
    _truths: list[Floats] = field(default_factory=list)  # of the graph's places
    _ways: list[float] = field(default_factory=list)  # driven up to each of them [m]
    _scans: list[_Kept] = field(default_factory=list)  # one from each
    _closed: float = 0.0  # way at the last closure [m]
    _ground: GridFrame = field(init=False)  # of the map
    _drawn: TiledGrid[np.int8] = field(init=False)
    _passers_by: PassersBy = field(init=False)  # who moves is kept out of the map
    _told: float = -AGAIN  # when the map was told last [s]

    def __post_init__(self) -> None:
        margin = math.ceil(AROUND / self.frame.resolution)
        rows, cols = (slice(-margin, count + margin) for count in self.frame.shape)
        self._ground = self.frame.window(rows, cols)
        self._tiling = Tiling(*self._ground.shape)
        self._drawn = TiledGrid(self._tiling, np.int8)
        self._passers_by = PassersBy(self._ground, self.spec.radius)
        self._odometry = Odometry(self.spec.drift, self.rng)
        self._true = self.start.copy()
        self._graph = PoseGraph(self.start[None].copy())

    @property
    def place(self) -> Floats:
        """``(3,)`` where the robot takes itself to be."""
        return laid_at(self._graph.places[-1], self._odometry.counted)

    def advance(self, true: Floats) -> None:
        """Let the robot have moved to a true place."""
        self._odometry.count(self._true, true)
        self._true = true.copy()

    def look(self, scan: Scan, now: float, arrived: bool) -> OwnMap | None:
        """Keep a scan, if it is time or the robot has just arrived, and return the map if there is news."""
        kept = self._sifted(scan, now)
        moved = self._odometry.way >= MOVED[0] or self._odometry.turned >= MOVED[1] or not self._scans
        fresh = moved and (arrived or now >= self._told + PERIOD - 1e-9)
        if fresh:
            self._keep(kept)
        if not fresh and now < self._told + AGAIN:
            return None
        self._told = now
        return self._own_map()

    def _sifted(self, scan: Scan, now: float) -> _Kept:
        """Return a scan without those who move before the lidar."""
        says = ~np.isnan(scan.ranges)
        angles, told = scan.angles[says], scan.ranges[says]
        ranges, hits = np.minimum(told, self.spec.range), told < self.spec.range
        x, y, heading = self.place.tolist()
        place = x - self._ground.origin_x, y - self._ground.origin_y
        self._passers_by.sift(self._drawn, place, angles, ranges, hits, NUDGE * self._ground.resolution, now)
        return _Kept(angles - heading, ranges, hits)

    def _keep(self, scan: _Kept) -> None:
        """Put the place of a scan on the graph, and the scan into the map."""
        odometry = self._odometry
        if self._scans:
            way, turned = odometry.way, odometry.turned
            deviation = self.spec.drift * np.sqrt((way, way, way + turned))
            self._graph.add(odometry.counted, np.maximum(deviation, LEAST))
        self._ways.append(odometry.way + (self._ways[-1] if self._ways else 0.0))
        odometry.reset()
        self._truths.append(self._true)
        self._scans.append(scan)
        if self._close():
            self._draw_anew()
        else:
            self._draw(len(self._scans) - 1)

    # -- loops ------------------------------------------------------------------------------------------

    def _close(self) -> bool:
        """Tie the newest place to the earliest that is recognised, and put all right; False: none is."""
        last = len(self._truths) - 1
        if self._ways[last] - self._closed < LOOP:
            return False
        long_ago = np.flatnonzero(self._ways[last] - np.array(self._ways) >= LOOP)
        apart = seen_from(self._true, np.array(self._truths)[long_ago])
        near = np.hypot(apart[:, 0], apart[:, 1]) <= BESIDE
        seen = [k for k, place in zip(long_ago[near], apart[near], strict=True) if self._in_sight(place)]
        if not seen:
            return False
        first = int(seen[0])
        measured = seen_from(self._truths[first], self._true) + MATCHED * self.rng.standard_normal(3)
        self._graph.tie(first, last, measured, MATCHED)
        self._graph.solve()
        self._closed = self._ways[last]
        self.closures += 1
        return True

    def _in_sight(self, place: Floats) -> bool:
        """Tell whether the newest scan reaches a place as the robot sees it."""
        scan = self._scans[-1]
        away = np.remainder(scan.angles - math.atan2(place[1], place[0]) + math.pi, math.tau) - math.pi
        beam = int(np.argmin(np.abs(away)))
        return bool(scan.ranges[beam] >= math.hypot(place[0], place[1]))

    # -- the map ----------------------------------------------------------------------------------------

    def _draw(self, number: int) -> None:
        """Lay one kept scan into the map, from where it was taken as far as is known now."""
        (x, y, heading), (angles, ranges, hits) = self._graph.places[number].tolist(), self._scans[number]
        side, left, low = self._ground.resolution, self._ground.origin_x, self._ground.origin_y
        gains = GAIN_HIT, GAIN_MISS, CLAMP, NUDGE * side
        lidar.integrate_scan(self._drawn, side, x - left, y - low, angles + heading, ranges, hits, *gains)

    def _draw_anew(self) -> None:
        self._drawn = TiledGrid(self._tiling, np.int8)
        for number in range(len(self._scans)):
            self._draw(number)

    def _own_map(self) -> OwnMap:
        """Return the part of the map that says anything."""
        tops, lefts = self._tiling.corners(self._drawn.held)
        rows, cols = (slice(int(first.min()), int(first.max()) + SIDE) for first in (tops, lefts))
        odds = self._drawn.window(rows, cols)
        classes = np.select([odds > 0, odds < 0], [OCCUPIED, FREE], UNKNOWN).astype(np.uint8)
        part = self._ground.window(rows, cols)
        return OwnMap(classes, part.resolution, part.origin_x, part.origin_y, 0.0)

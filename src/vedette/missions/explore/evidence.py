"""What one robot has seen itself: its own evidence, from scans or from a map that it has made."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import hypot

import numpy as np
from numpy.typing import NDArray

from vedette.agent.events import Pose, Scan
from vedette.agent.mates import Mate
from vedette.kernels import lidar
from vedette.kernels.tiles import TiledGrid, Tiling
from vedette.maps import FREE, OCCUPIED, UNKNOWN, GridFrame
from vedette.maps.bounds import Bounds
from vedette.maps.disc import cells_under
from vedette.maps.lattice import Lattice
from vedette.missions.explore.learning import Learning
from vedette.missions.explore.own_map import OwnMap
from vedette.missions.explore.passers_by import PassersBy
from vedette.team import PlatformSpec

GAIN_HIT, GAIN_MISS, CLAMP = 4, 2, 20  # log-odds of one observation and of all [0.2 nats]
TAKEN_OVER = np.zeros(3, np.int8)  # log-odds of a cell's class in the robot's own map
TAKEN_OVER[[FREE, OCCUPIED]] = -CLAMP, CLAMP
NUDGE = 0.25  # a return lies in the wall, not on its face: it counts as so much farther [cells] ...
NUDGE_OF_NOISE = 2.5  # ... or, where noise asks for more, so many of its deviations, ...
MOST_NUDGE = 0.5  # ... but no more than that [cells]
BLUR = 1.0  # a return lies within so many deviations of where it seems to [1]
MATE_MARGIN = 0.15  # a return this near a mate's rim is the mate; more by two deviations of the pose [m]

Place = tuple[float, float]  # x, y [m]

_NOTHING = np.empty(0, np.int64)


@dataclass(eq=False)
class OwnEvidence:
    """One robot's log-odds of each cell, which of them are news, and what it learns of seeing."""

    lattice: Lattice  # the team's
    spec: PlatformSpec
    passers_by: PassersBy | None = None  # keeps out what moves where mates tell no places; None: they do
    askew: float = 0.0  # walls lie anywhere in the cells: so far from where they seem to [m]
    beyond: int = 0  # beams, or cells of its own map, that told of ground where there are no cells
    log_odds: TiledGrid[np.int8] = field(init=False)
    learning: Learning = field(init=False)
    seen: Bounds = field(default_factory=Bounds)  # of its cells
    _changed: list[NDArray[np.int64]] = field(default_factory=list)  # cells whose class changed

    def __post_init__(self) -> None:
        tiling = Tiling(*self.frame.shape)
        self.log_odds = TiledGrid(tiling, np.int8)
        self.learning = Learning(tiling, self.frame.resolution, self.spec.range, self._nudge)

    @property
    def frame(self) -> GridFrame:
        """Where the cells lie that there can be."""
        return self.lattice.frame

    @property
    def counts(self) -> NDArray[np.int64]:
        """``(ROWS, BINS)`` own sightings."""
        return self.learning.counts

    def news(self) -> NDArray[np.int64]:
        """Return the increasing cells whose class changed since the last call."""
        changed = np.unique(np.concatenate(self._changed)) if self._changed else _NOTHING
        self._changed.clear()
        return changed

    def take_over(self, own_map: OwnMap, mates: Sequence[Mate], now: float) -> None:
        """Let a map take the place of all that the robot said before; team-mates are not obstacles in it."""
        bounds = own_map.bounds(self.frame)
        was = self.seen.extent
        if was[0].stop > was[0].start:
            bounds.hold(was[0].start, was[0].stop, was[1].start, was[1].stop)
        extent = bounds.extent
        frame = self.frame.window(*extent)
        before, classes = self.log_odds.window(*extent), own_map.laid(frame)
        for mate in mates:
            body = cells_under(frame, mate.x, mate.y, mate.radius + MATE_MARGIN)
            classes.flat[body[classes.flat[body] == OCCUPIED]] = UNKNOWN
        if self.passers_by is not None:
            self.passers_by.sift_map(self.log_odds, classes, (extent[0].start, extent[1].start), now)
        evidence = TAKEN_OVER[classes]
        changed = np.flatnonzero(np.sign(before) != np.sign(evidence))
        row, col = np.divmod(changed, frame.cols)
        cells = (row + extent[0].start) * self.frame.cols + col + extent[1].start
        self.log_odds.put(cells, evidence.flat[changed])
        self._note(cells)
        if not self.lattice.bounded:
            self.beyond = own_map.beyond(self.frame)

    def add(self, scan: Scan, pose: Pose, mates: Sequence[Mate], now: float) -> None:
        """Add a scan; returns from team-mates are not obstacles, and where the robot stands is free."""
        says = ~np.isnan(scan.ranges)
        angles, told = scan.angles[says], scan.ranges[says]
        ranges, hits = np.minimum(told, self.spec.range), told < self.spec.range
        lidar_x, lidar_y = pose.x + scan.offset[0], pose.y + scan.offset[1]
        self._leave_out(mates, (lidar_x, lidar_y), pose.deviation, angles, ranges, hits, now, scan.age)
        x, y = lidar_x - self.frame.origin_x, lidar_y - self.frame.origin_y
        nudge = self._nudge
        if self.passers_by is not None:
            back = self.passers_by.sift(self.log_odds, (x, y), angles, ranges, hits, nudge, now)
            self._note(back)
        self.learning.scan(self.log_odds, angles, ranges, hits, x, y)
        beams = self.log_odds, self.frame.resolution, x, y, angles, ranges, hits
        deviation = max(pose.deviation, self.askew)
        if deviation > 0.0 or pose.heading_deviation > 0.0:
            margins = BLUR * np.hypot(deviation, ranges * pose.heading_deviation)
            changed = lidar.integrate_blurred_scan(*beams, margins, GAIN_HIT, GAIN_MISS, CLAMP, nudge)
        else:
            changed = lidar.integrate_scan(*beams, GAIN_HIT, GAIN_MISS, CLAMP, nudge)
        self._note(changed)
        self._stand(pose)
        if not self.lattice.bounded:
            self.beyond += self._ended_beyond(x, y, angles, ranges)

    def _ended_beyond(
        self, x: float, y: float, angles: NDArray[np.float64], ranges: NDArray[np.float64]
    ) -> int:
        """Count the beams from (x, y) [m], from the corner of the grid, that ended where there is no cell."""
        reach, (rows, cols), cell = self.spec.range, self.frame.shape, self.frame.resolution
        if reach <= x <= cols * cell - reach and reach <= y <= rows * cell - reach:
            return 0
        row, col = (y + ranges * np.sin(angles)) / cell, (x + ranges * np.cos(angles)) / cell
        return int(np.count_nonzero((row < 0.0) | (col < 0.0) | (row > rows) | (col > cols)))

    @property
    def _nudge(self) -> float:
        """So much farther a return counts, lest its noise puts it before the wall [m]."""
        cell, noise = self.frame.resolution, self.spec.range_noise
        return min(max(NUDGE * cell, NUDGE_OF_NOISE * noise), MOST_NUDGE * cell)

    def _stand(self, pose: Pose) -> None:
        """Where the robot stands is free, as far as it has not seen what is there."""
        under = cells_under(self.frame, pose.x, pose.y, self.spec.radius - 2.0 * pose.deviation)
        unseen = under[self.log_odds.take(under) == 0]
        self.log_odds.put(unseen, np.full(len(unseen), -GAIN_MISS, np.int8))
        self._note(unseen)

    def _note(self, changed: NDArray[np.int64]) -> None:
        """Remember cells whose class has changed."""
        if len(changed):
            self.seen.widen(*np.divmod(changed, self.frame.cols))
            self._changed.append(changed)
        self.learning.note(changed)

    def _leave_out(
        self,
        mates: Sequence[Mate],
        place: Place,
        deviation: float,
        angles: NDArray[np.float64],
        ranges: NDArray[np.float64],
        hits: NDArray[np.bool_],
        now: float,
        age: float,
    ) -> None:
        """Turn returns from mates' bodies into free space up to just before them.

        Args:
            mates: all; those out of the lidar's sight are passed over.
            place: of the lidar [m], team frame.
            deviation: of the robot's own place [m].
            angles, ranges, hits: ``(B,)`` of the beams; the last two are changed in place.
            now: [s].
            age: of the scan [s].
        """
        bodies = []  # dx, dy from the lidar, and how near a return has to be [m]
        for mate in mates:
            dx, dy = mate.x - place[0], mate.y - place[1]
            moved = mate.speed * (min(now - mate.heard, 0.5) + age)
            reach = mate.radius + MATE_MARGIN + moved + 2.0 * deviation
            if hypot(dx, dy) <= self.spec.range + reach:
                bodies.append((dx, dy, reach))
        if not bodies:
            return
        dx, dy, reach = np.array(bodies).T[:, :, None]  # (n, 1) each
        beams = np.flatnonzero(hits)
        x, y = ranges[beams] * np.cos(angles[beams]), ranges[beams] * np.sin(angles[beams])
        body = beams[((x - dx) ** 2 + (y - dy) ** 2 < reach**2).any(axis=0)]
        hits[body] = False
        before = self.frame.resolution + BLUR * deviation
        ranges[body] = np.maximum(ranges[body] - before, 0.0)

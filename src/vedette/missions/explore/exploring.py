"""Exploring a building: the mapping domain and a way of fusing, put together for the agent."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from vedette.agent.effects import Route
from vedette.agent.events import Pose, Scan, Sensed
from vedette.agent.mates import Mate
from vedette.domains.mapping.belief import (
    MapBelief,
    freeze,
    longest_frontier,
    planning_factor,
    shortest_frontier,
)
from vedette.domains.mapping.impact import Impact, MapImpactCodec, check_claim
from vedette.domains.mapping.leftovers import Leftover, given_up, leftovers
from vedette.domains.mapping.objective import MappingObjective
from vedette.domains.mapping.planners import Planner
from vedette.domains.mapping.platform import SAME_PLACE, STAY, GivenUp, MappingPlatform, Place, Tour
from vedette.domains.mapping.sightings import BIN, BINS, empty_counts
from vedette.domains.mapping.stops import (
    CLEARANCES,
    LEFT_ALONE,
    NEARBY,
    VIEW_REACH,
    Disc,
    around,
    block,
)
from vedette.domains.mapping.views import MOST_STOPS
from vedette.fusion import Fusion
from vedette.kernels import distance, frontier, lidar
from vedette.kernels.tiles import TiledGrid, Tiling
from vedette.maps import FREE, OCCUPIED, UNKNOWN, GridFrame
from vedette.maps.bounds import Bounds, Extent
from vedette.maps.disc import cells_under
from vedette.maps.lattice import Lattice
from vedette.missions.explore.doubts import Doubts
from vedette.missions.explore.looking import Looking
from vedette.missions.explore.own_map import OwnMap
from vedette.missions.explore.resort import LastResort, hemmed_in
from vedette.outcome import Outcome
from vedette.team import Most, PlatformSpec

GAIN_HIT, GAIN_MISS, CLAMP = 4, 2, 20  # log-odds of one observation and of all [0.2 nats]
TAKEN_OVER = np.zeros(3, np.int8)  # log-odds of a cell's class in the robot's own map
TAKEN_OVER[[FREE, OCCUPIED]] = -CLAMP, CLAMP
NUDGE = 0.25  # a return lies in the wall, not on its face: it counts as so much farther [cells] ...
NUDGE_OF_NOISE = 2.5  # ... or, where noise asks for more, so many of its deviations, ...
MOST_NUDGE = 0.5  # ... but no more than that [cells]
SIGHTING_STRIDE = 4  # one beam in so many teaches the sighting model
LEARNING_STEP = 2.0  # a robot learns from one scan in so many metres of its way [m]
MOST_CHANGES = 256  # scans whose changes are kept apart
COUNTS_PERIOD = 10.0  # the model's counts are shared at most so often [s]
BLUR = 1.0  # a return lies within so many deviations of where it seems to [1]
MATE_MARGIN = 0.15  # a return this near a mate's rim is the mate; more by two deviations of the pose [m]
THERE = 0.35  # a robot this near a stop's viewpoint is at it; more by two deviations of its pose [m]
WELL_SEEN = 0.5  # nothing is concluded from a look at what is nearer the end of the lidar's range ... [m]
IN_THE_WAY = 1.0  # a mate this near a frontier may hide it [m]
AVOID_TIME = 10.0  # a stop that could not be carried out is left alone for so long, longer each time [s]
TRIES = 3  # a stop that could not be carried out so often is given up
BLOCKING = 3.0  # a mate this near may have kept the robot from a stop [m]
CHANCES = 2  # a stop is taken up again so often because who kept the robot from it has gone
JOIN = 4  # cells beyond what is known from which a robot or a goal still joins it
SERVED_SHARE = 0.4  # a frontier with less than this of its unknown cells left has lost its point

Ways = tuple[Extent, NDArray[np.bool_]]  # where a robot's centre may be of some rows and columns

_NOTHING = np.empty(0, np.int64)


@dataclass(eq=False)
class Exploring:
    """One robot's share of exploring; ``vedette.agent.mission.GroundMission``."""

    lattice: Lattice
    spec: PlatformSpec
    planner: Planner
    fusion: Fusion
    strategy: Tour = STAY
    most: Most | None = None  # of any robot in the team; None: not known, so that no claim is too large
    objective: MappingObjective = field(default_factory=MappingObjective)
    codec: MapImpactCodec = field(init=False)
    platform: MappingPlatform = field(init=False)
    log_odds: TiledGrid[np.int8] = field(init=False)  # own evidence
    counts: NDArray[np.int64] = field(init=False)  # (4, BINS) own sightings
    frontiers: int | None = None  # of the latest round's map; None: there has been none
    _changed: list[NDArray[np.int64]] = field(default_factory=list)  # cells whose own class changed
    _counts_due: float = 0.0
    _seen: Bounds = field(default_factory=Bounds)  # of its own evidence
    _learned: tuple[float, float] | None = None  # where it last learned
    _then: TiledGrid[np.int8] = field(init=False)  # its evidence then, to the class
    _since: list[NDArray[np.int64]] = field(default_factory=list)  # cells whose own class changed since
    _at: tuple[float, float] = (np.inf, np.inf)  # where it last observed [m], team frame
    _looking: Looking = field(init=False)
    _resort: LastResort = field(init=False)
    _doubts: Doubts = field(init=False)
    _left: list[Leftover] | None = None  # as of the last round; None: there was a stop
    _released: list[tuple[float, float]] = field(default_factory=list)  # stops that could not be carried out
    _despaired: list[tuple[float, float]] = field(default_factory=list)  # those that were given up for that
    _ground: dict[float, tuple[int, Ways]] = field(default_factory=dict)  # by clearance, as of a digest

    def __post_init__(self) -> None:
        self.codec = MapImpactCodec(self.frame.coarse(planning_factor(self.frame.resolution)).size)
        self.platform = self.planner.platform(self.spec)
        tiling = Tiling(*self.frame.shape)
        self.log_odds, self._then = TiledGrid(tiling, np.int8), TiledGrid(tiling, np.int8)
        self.counts = empty_counts()
        self._looking = Looking(self.spec, self.frame.resolution)
        self._resort = LastResort(self._looking)
        self._doubts = Doubts(self.spec.radius)

    @property
    def frame(self) -> GridFrame:
        """Where the cells lie that there can be."""
        return self.lattice.frame

    # -- evidence -----------------------------------------------------------------------------------

    def observe(self, seen: Scan | Sensed, pose: Pose, mates: Sequence[Mate], now: float) -> None:
        """Take in a scan, or a map that the robot has made itself."""
        if isinstance(seen, Scan):
            self._add(seen, pose, mates, now)
        elif isinstance(seen.data, OwnMap):
            self._take_over(seen.data, mates)

    def _take_over(self, own_map: OwnMap, mates: Sequence[Mate]) -> None:
        """Let a map take the place of all that the robot said before; team-mates are not obstacles in it."""
        bounds = own_map.bounds(self.frame)
        was = self._seen.extent
        if was[0].stop > was[0].start:
            bounds.hold(was[0].start, was[0].stop, was[1].start, was[1].stop)
        extent = bounds.extent
        frame = self.frame.window(*extent)
        before, now = self.log_odds.window(*extent), own_map.laid(frame)
        for mate in mates:
            body = cells_under(frame, mate.x, mate.y, mate.radius + MATE_MARGIN)
            now.flat[body[now.flat[body] == OCCUPIED]] = UNKNOWN
        evidence = TAKEN_OVER[now]
        changed = np.flatnonzero(np.sign(before) != np.sign(evidence))
        row, col = np.divmod(changed, frame.cols)
        cells = (row + extent[0].start) * self.frame.cols + col + extent[1].start
        self.log_odds.put(cells, evidence.flat[changed])
        self._note(cells)

    def _add(self, scan: Scan, pose: Pose, mates: Sequence[Mate], now: float) -> None:
        """Add a scan to the robot's own evidence; returns from team-mates are not obstacles."""
        says = ~np.isnan(scan.ranges)
        angles, told = scan.angles[says], scan.ranges[says]
        ranges, hits = np.minimum(told, self.spec.range), told < self.spec.range
        lidar_x, lidar_y = pose.x + scan.offset[0], pose.y + scan.offset[1]
        for mate in mates:
            away = mate.x - lidar_x, mate.y - lidar_y
            self._leave_out(mate, away, pose.deviation, angles, ranges, hits, now - mate.heard, scan.age)
        x, y = lidar_x - self.frame.origin_x, lidar_y - self.frame.origin_y
        nudge = self._nudge
        self._learn(angles, ranges, hits, x, y)
        beams = self.log_odds, self.frame.resolution, x, y, angles, ranges, hits
        if pose.deviation > 0.0 or pose.heading_deviation > 0.0:
            margins = BLUR * np.hypot(pose.deviation, ranges * pose.heading_deviation)
            changed = lidar.integrate_blurred_scan(*beams, margins, GAIN_HIT, GAIN_MISS, CLAMP, nudge)
        else:
            changed = lidar.integrate_scan(*beams, GAIN_HIT, GAIN_MISS, CLAMP, nudge)
        self._note(changed)
        self._at = pose.x, pose.y
        self._stand(pose)
        self._looking.add(pose, scan.angles)

    @property
    def _nudge(self) -> float:
        """So much farther a return counts, lest its noise puts it before the wall [m]."""
        cell, noise = self.frame.resolution, self.spec.range_noise
        return min(max(NUDGE * cell, NUDGE_OF_NOISE * noise), MOST_NUDGE * cell)

    @property
    def known(self) -> Extent:
        """Rows and columns outside of which neither the team nor the robot itself knows anything."""
        bounds = replace(self._seen)
        rows, cols = self.fusion.known
        if rows.stop > rows.start:
            bounds.hold(rows.start, rows.stop, cols.start, cols.stop)
        return bounds.extent

    def _stand(self, pose: Pose) -> None:
        """Where the robot stands is free, as far as it has not seen what is there."""
        under = cells_under(self.frame, pose.x, pose.y, self.spec.radius - 2.0 * pose.deviation)
        unseen = under[self.log_odds.take(under) == 0]
        self.log_odds.put(unseen, np.full(len(unseen), -GAIN_MISS, np.int8))
        self._note(unseen)

    def _note(self, changed: NDArray[np.int64]) -> None:
        """Remember cells whose own class has changed."""
        if len(changed):
            self._seen.widen(*np.divmod(changed, self.frame.cols))
            self._changed.append(changed)
            self._since.append(changed)
        if len(self._since) > MOST_CHANGES:
            self._since = [np.unique(np.concatenate(self._since))]

    def _learn(
        self,
        angles: NDArray[np.float64],
        ranges: NDArray[np.float64],
        hits: NDArray[np.bool_],
        x: float,
        y: float,
    ) -> None:
        """Count what a scan reveals of what was unknown when the robot last was a way from here.

        That is what the planner asks of a stop. Counting every scan would teach it that unknown cells are
        never seen, the more so the longer a robot stands.
        """
        if self._learned is not None and np.hypot(x - self._learned[0], y - self._learned[1]) < LEARNING_STEP:
            return
        seen = lidar.count_sightings(
            self._then,
            self.frame.resolution,
            x,
            y,
            angles,
            ranges,
            hits,
            self.spec.range,
            BIN,
            SIGHTING_STRIDE,
            self._nudge,
        )
        self.counts[:, : seen.shape[1]] += seen[:, :BINS]
        self._learned = x, y
        for cells in self._since:
            self._then.put(cells, self.log_odds.take(cells))
        self._since.clear()

    def _leave_out(
        self,
        mate: Mate,
        away: tuple[float, float],
        deviation: float,
        angles: NDArray[np.float64],
        ranges: NDArray[np.float64],
        hits: NDArray[np.bool_],
        unheard: float,
        age: float,
    ) -> None:
        """Turn returns from a mate's body into free space up to just before it.

        Args:
            mate: the team-mate.
            away: where it is from the lidar [m], team frame.
            deviation: of the robot's own place [m].
            angles, ranges, hits: ``(B,)`` of the beams; the last two are changed in place.
            unheard: time since the mate was heard [s].
            age: of the scan [s].
        """
        dx, dy = away
        moved = mate.speed * (min(unheard, 0.5) + age)
        reach = mate.radius + MATE_MARGIN + moved + 2.0 * deviation
        if np.hypot(dx, dy) > self.spec.range + reach:
            return
        off = np.hypot(ranges * np.cos(angles) - dx, ranges * np.sin(angles) - dy)
        body = hits & (off < reach)
        hits[body] = False
        before = self.frame.resolution + BLUR * deviation
        ranges[body] = np.maximum(ranges[body] - before, 0.0)

    def publish(self, now: float) -> None:
        """Hand the own evidence to fusion."""
        counts = None
        if now >= self._counts_due:
            self._counts_due = now + COUNTS_PERIOD
            counts = self.counts.ravel().copy()
        changed = np.unique(np.concatenate(self._changed)) if self._changed else _NOTHING
        self._changed.clear()
        if len(changed) or counts is not None:
            self.fusion.publish(self.log_odds, changed, counts)

    # -- planning -----------------------------------------------------------------------------------

    def notes(self) -> list[tuple[int, int, int]]:
        """Return the frontiers that this robot's visits did not change: x, y [cm], unknown cells near it."""
        return [
            (round(spot.x * 100), round(spot.y * 100), spot.unknown)
            for spot in self.platform.given_up
            if spot.visited
        ]

    def hear_notes(self, notes: Sequence[tuple[int, int, int]]) -> None:
        """Leave alone what team-mates' visits did not change, until the map there changes."""
        self.platform.told = [GivenUp(x / 100, y / 100, unknown) for x, y, unknown in notes]

    def freeze(self, t0: float) -> MapBelief:
        """Snapshot the team map for a round; tours count time from when it is frozen."""
        known = self.fusion.known
        belief = freeze(
            self.fusion.classes.window(*known),
            self.frame,
            reach=max(self.spec.range, NEARBY + self.frame.resolution),
            extent=longest_frontier(self.spec.range),
            shortest=shortest_frontier(self.spec.radius),
            hidden=self.planner.hidden,
            return_price=self.planner.return_price,
            turn=self.planner.turn,
            layers=self.planner.layers,
            counts=self.fusion.counts.reshape(4, BINS).copy(),
            known=known,
            area=self.lattice.area,
        )
        self.frontiers = len(belief.frontier_starts) - 1
        return belief

    def prepare(
        self, belief: MapBelief, pose: Pose, mates: Sequence[Mate], blocked: bool, now: float
    ) -> None:
        """Find the stops of a round and restate the present tour over them; else what is left to try."""
        team = [(mate.robot, mate.x, mate.y) for mate in mates if not mate.silent(now)]
        self.platform.place(
            pose.x,
            pose.y,
            self._discs(pose, mates, blocked, now),
            [(-1, pose.x, pose.y), *team],
            now,
            self._doubtful(belief),
        )
        self.platform.prepare(belief)
        self.strategy = self.platform.carry_over(self.strategy)
        if self.platform.leads_anywhere:
            self._resort.goal, self._left = None, None
        elif self.platform.ground is not None:
            self._left = leftovers(belief, self.platform)
            frontiers = len(belief.frontier_cells) > 0
            self._resort.consider(pose, belief.frame, self.platform.ground, frontiers)

    def _doubtful(self, belief: MapBelief) -> NDArray[np.bool_]:
        """Return ``(R, C)`` which cells of a round's window are occupied, but perhaps by mistake."""
        row, col = (first * belief.factor for first in belief.first)
        own = self.log_odds.window(slice(row, row + belief.frame.rows), slice(col, col + belief.frame.cols))
        doubtful = self._doubts.about(belief.classes, own, belief.frame)
        area = self.lattice.area
        return doubtful if area is None else doubtful & area.holds(belief.frame)

    @property
    def left_out(self) -> list[Leftover]:
        """What the robot leaves as it is, as far as it knows by now."""
        return given_up(self.platform) if self._left is None else self._left

    @property
    def ending(self) -> Outcome:
        """How the mission has ended for this robot, if it has nothing left to do."""
        left = {spot.why for spot in self._left or ()} - {"unseeable"}
        if left and self.platform.ground is not None and hemmed_in(self.platform.ground):
            return Outcome.ENCLOSED
        return Outcome.UNREACHED if "unreached" in left else Outcome.COMPLETE

    def _discs(self, pose: Pose, mates: Sequence[Mate], blocked: bool, now: float) -> list[Disc]:
        """Mates that stand in the way: the silent ones, and for a robot that is blocked all those near it."""
        return [
            (mate.x, mate.y, mate.radius)
            for mate in mates
            if mate.silent(now) or (blocked and np.hypot(mate.x - pose.x, mate.y - pose.y) < BLOCKING)
        ]

    def reach(self, now: float) -> None:
        """Tours lead anywhere."""

    def admit(self, belief: MapBelief, impact: Impact, robots: int) -> None:
        """Refuse more than so many of the team's best robots can see."""
        if self.most is not None:
            side, edges = belief.planning.resolution, belief.layers.edges
            check_claim(impact, robots, self.most, MOST_STOPS, side, edges)  # a tour has no stop twice

    # -- driving ------------------------------------------------------------------------------------

    def goal(self) -> tuple[float, float] | None:
        """Return the next viewpoint of the tour; without one, where there is something left to try."""
        if not len(self.strategy):
            return self._resort.goal
        x, y = self.strategy.views[0].tolist()
        return x, y

    def served(self) -> bool:
        """Tell whether most of what the next stop was to reveal is known by now."""
        if not len(self.strategy):
            return False
        planned = int(self.strategy.unknown[0])
        return self._unknown_at(self.strategy.targets[0]) < SERVED_SHARE * planned

    def _unknown_at(self, target: NDArray[np.float64]) -> int:
        near = self.fusion.classes.window(*around(self.frame, *target))
        return int(np.count_nonzero(near == UNKNOWN))

    def reached(self, pose: Pose, mates: Sequence[Mate], now: float) -> bool:
        """Go on to the tour's next stop; the next round sees whether this one changed the map.

        False: the robot has not yet looked where it was planned to look. A stop that a mate kept the robot
        from, or stands in front of, or whose frontier is out of the lidar's range, has not been visited.
        """
        if not len(self.strategy):
            return self._resort.goal is None or self._resort.reached(pose)
        x, y = self.strategy.targets[0].tolist()
        away = np.hypot(pose.x - self.strategy.views[0, 0], pose.y - self.strategy.views[0, 1])
        in_the_way = any(
            np.hypot(mate.x - x, mate.y - y) < IN_THE_WAY for mate in mates if not mate.silent(now)
        )
        beyond = np.hypot(pose.x - x, pose.y - y) > max(
            self.spec.range - WELL_SEEN, VIEW_REACH * self.spec.range
        )
        if away > THERE + 2.0 * pose.deviation or in_the_way or beyond:
            self._put_off(now)
        elif not self.served() and self._facing(pose) is not None:
            return False
        else:
            afar = float(np.hypot(*(self.strategy.targets[0] - self.strategy.views[0])))
            self.platform.visited.append((x, y, int(self.strategy.unknown[0]), afar))
        self.strategy = self.strategy.after_first()
        return True

    def _facing(self, pose: Pose) -> float | None:
        """Return the heading to turn to next where the robot goes; None: it has looked as planned."""
        if not len(self.strategy):
            return self._resort.facing(pose)
        ahead = self.strategy.targets[0] - self.strategy.views[0]
        distance = float(np.hypot(*ahead))
        if distance < self.frame.resolution:
            return self._resort.facing(pose)
        return self._looking.toward(pose, float(np.arctan2(ahead[1], ahead[0])), distance)

    def release(self, now: float) -> None:
        """Drop the tour; leave its first stop alone for a while, after some tries until the map changes.

        What closes a way that was doubtful is not doubted here any more.
        """
        if self.platform.daring:
            self._doubts.settle(*self._at)
        elif len(self.strategy):
            self._put_off(now)
        self.strategy, self._resort.goal = STAY, None

    def _put_off(self, now: float) -> None:
        """Leave the first stop alone, longer after each try; after the last one until the map changes."""
        x, y = self.strategy.targets[0].tolist()
        self._released.append((x, y))
        near = [np.hypot(x - u, y - v) < SAME_PLACE for u, v in self._released]
        if sum(near) < TRIES:
            self.platform.avoided.append((x, y, now + AVOID_TIME * sum(near)))
        else:
            unknown = self._unknown_at(self.strategy.targets[0])
            kept_off = self._kept_off(x, y)
            self.platform.given_up.append(GivenUp(x, y, unknown, visited=False, kept_off=kept_off))
            self._despaired.append((x, y))
            self._released = [spot for spot, same in zip(self._released, near, strict=True) if not same]

    def _kept_off(self, x: float, y: float) -> tuple[Place, ...]:
        """Return who may have kept the robot from a stop, with itself; nobody, after some chances."""
        if sum(np.hypot(x - u, y - v) < SAME_PLACE for u, v in self._despaired) >= CHANCES:
            return ()
        here = self.platform.x, self.platform.y
        near = tuple(spot for spot in self.platform.team if math.dist(spot[1:], here) < BLOCKING)
        return near if len(near) > 1 else ()

    def nothing_left(self, value: float, now: float) -> bool:
        """Tell whether nothing reachable is worth seeing, now or in a while, and all was tried."""
        tried = not self.platform.cut_short and self._resort.goal is None
        return value <= 0.0 and tried and not self._postponed(now)

    def _postponed(self, now: float) -> bool:
        """Tell whether a stop of the last round is left alone for a while only."""
        considered = self.platform.considered
        return any(
            until > now and np.any(np.hypot(*(considered - (x, y)).T) < LEFT_ALONE)
            for x, y, until in self.platform.avoided
        )

    def route(
        self, pose: Pose, goal: tuple[float, float], mates: Sequence[Mate], blocked: bool, now: float
    ) -> Route | None:
        """Return the shortest way to a goal on the newest team map, straightened; None if there is none.

        A narrow way is taken only where there is no wider one.
        """
        discs = self._discs(pose, mates, blocked, now)
        for clearance, (extent, passable) in self._ways(goal):
            frame = self.frame.window(*extent)
            if discs:
                passable = passable.copy()
            for disc in discs:
                block(passable, frame, disc, self.spec.radius + clearance)
            source, target = self._cell(pose.x, pose.y, extent), self._cell(*goal, extent)
            cells = distance.shortest_path(passable, source, target, frame.resolution)
            if len(cells):
                path = self.frame.centres(self._in_all(distance.shortcut(passable, cells), extent))
                path[0] = pose.x, pose.y
                there = np.hypot(pose.x - goal[0], pose.y - goal[1]) <= THERE and goal == self.goal()
                return Route(path, passable, frame, clearance, self._facing(pose) if there else None)
        return None

    def _ways(self, goal: tuple[float, float]) -> Iterator[tuple[float, Ways]]:
        """Yield clearances and where they let the robot's centre be, the widest first, the doubtful last."""
        for clearance in CLEARANCES:
            yield clearance, self._passable_now(clearance)
        if self.platform.daring and goal == self.goal():
            yield CLEARANCES[-1], self._passable_daring(CLEARANCES[-1])

    def _cell(self, x: float, y: float, extent: Extent) -> int:
        """Return the flat cell of a part of the grid that a point lies in or is nearest to."""
        (row, col), (rows, cols) = self.frame.cell(x, y), extent
        row, col = min(max(row, rows.start), rows.stop - 1), min(max(col, cols.start), cols.stop - 1)
        return int((row - rows.start) * (cols.stop - cols.start) + col - cols.start)

    def _in_all(self, cells: NDArray[np.int64], extent: Extent) -> NDArray[np.int64]:
        """Return flat cells of a part of the grid as those of all of it."""
        rows, cols = extent
        row, col = np.divmod(cells, cols.stop - cols.start)
        flat: NDArray[np.int64] = (row + rows.start) * self.frame.cols + col + cols.start
        return flat

    def _passable_now(self, clearance: float) -> Ways:
        """Return where the robot's centre may be; nowhere else."""
        digest = self.fusion.digest
        if clearance not in self._ground or self._ground[clearance][0] != digest:
            extent = self._around_known
            classes = self.fusion.classes.window(*extent)
            self._ground[clearance] = digest, self._traversable(classes, extent, clearance)
        return self._ground[clearance][1]

    def _passable_daring(self, clearance: float) -> Ways:
        extent = self._around_known
        classes, own = self.fusion.classes.window(*extent), self.log_odds.window(*extent)
        doubtful = self._doubts.about(classes, own, self.frame.window(*extent))
        return self._traversable(np.where(doubtful, np.uint8(FREE), classes), extent, clearance)

    @property
    def _around_known(self) -> Extent:
        """Rows and columns of what the team knows, and as far beyond as a robot or a goal still joins it."""
        rows, cols = (
            slice(max(0, known.start - JOIN), min(size, known.stop + JOIN))
            for known, size in zip(self.fusion.known, self.frame.shape, strict=True)
        )
        return rows, cols

    def _traversable(self, classes: NDArray[np.uint8], extent: Extent, clearance: float) -> Ways:
        """Return where the robot's centre may be on a map of some rows and columns; never beside the area."""
        if self.lattice.area is not None:
            classes = self.lattice.area.close(classes, self.frame.window(*extent))
        return extent, frontier.traversable(classes, self.spec.radius + clearance, self.frame.resolution)

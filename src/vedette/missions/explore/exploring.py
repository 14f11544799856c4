"""Exploring a building: the mapping domain and a way of fusing, put together for the agent."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vedette.agent.effects import Route
from vedette.agent.events import Pose, Scan, Sensed
from vedette.agent.mates import Mate
from vedette.agent.orders import OrderBook
from vedette.domains.mapping.belief import (
    LN2,
    MapBelief,
    freeze,
    longest_frontier,
    planning_factor,
    shortest_frontier,
)
from vedette.domains.mapping.budget import needed
from vedette.domains.mapping.frozen import Frozen
from vedette.domains.mapping.impact import Impact, MapImpactCodec, check_claim, discounted, on_map, promised
from vedette.domains.mapping.leftovers import Leftover, given_up, leftovers
from vedette.domains.mapping.objective import MappingObjective
from vedette.domains.mapping.planners import Planner
from vedette.domains.mapping.platform import MappingPlatform
from vedette.domains.mapping.prior import PriorMap
from vedette.domains.mapping.sightings import BINS, ROWS, pooled
from vedette.domains.mapping.stops import NEARBY, Disc, around
from vedette.domains.mapping.tour import STAY, Tour
from vedette.domains.mapping.views import MOST_STOPS
from vedette.fusion import Fusion, ShownMap
from vedette.fusion.signed import SignedEvidence
from vedette.maps import UNKNOWN, GridFrame
from vedette.maps.area import Area
from vedette.maps.bounds import Extent
from vedette.maps.lattice import Lattice
from vedette.maps.leave import Leave
from vedette.missions.explore.doubts import Doubts
from vedette.missions.explore.evidence import OwnEvidence
from vedette.missions.explore.failures import BLOCKING, Failures
from vedette.missions.explore.looking import Looking
from vedette.missions.explore.notes import given_up as given_up_at
from vedette.missions.explore.notes import sifted
from vedette.missions.explore.own_map import OwnMap
from vedette.missions.explore.resort import LastResort, hemmed_in
from vedette.missions.explore.visits import THERE, Visits
from vedette.missions.explore.ways import Ways
from vedette.missions.ordered import no_go_areas, priority_areas, trusted
from vedette.outcome import Outcome
from vedette.problem import Codec, Objective
from vedette.team import Most, PlatformSpec

COUNTS_PERIOD = 10.0  # the model's counts are shared at most so often [s]


@dataclass(eq=False)
class Exploring:
    """One robot's share of exploring; ``vedette.agent.mission.GroundMission``."""

    lattice: Lattice
    spec: PlatformSpec
    planner: Planner
    fusion: Fusion
    strategy: Tour = STAY
    most: Most | None = None  # of any robot in the team; None: not known, so that no claim is too large
    prior: PriorMap | None = None  # an old map of the building, the same for all
    objective: Objective[Any, Any] = field(default_factory=MappingObjective)
    codec: Codec[Any] = field(init=False)
    platform: MappingPlatform = field(init=False)
    own: OwnEvidence = field(init=False)
    frontiers: int | None = None  # of the latest round's map; None: there has been none
    _counts_due: float = 0.0
    _t0: float = 0.0  # from which the tour's arrivals count [s]
    _at: tuple[float, float] = (np.inf, np.inf)  # where it last observed [m], team frame
    _looking: Looking = field(init=False)
    _resort: LastResort = field(init=False)
    _doubts: Doubts = field(init=False)
    _visits: Visits = field(init=False)
    _ways: Ways = field(init=False)
    _leave: Leave = field(init=False)  # where the team may work
    _priorities: list[tuple[Area, float]] = field(default_factory=list)
    _left: list[Leftover] | None = None  # as of the last round; None: there was a stop
    _at_work: bool = True  # as of the last round; a robot that is kept from work ends nothing

    def __post_init__(self) -> None:
        self.codec = MapImpactCodec(self.planning.size * self.planner.worlds)
        self.platform = self.planner.platform(self.spec)
        self.own = OwnEvidence(self.lattice, self.spec)
        self._looking = Looking(self.spec, self.frame.resolution)
        self._resort = LastResort(self._looking)
        failures = Failures(self.platform)
        self._visits = Visits(self.platform, self._looking, self._resort, failures, self._unknown_at)
        self._doubts = Doubts(self.spec.radius)
        self._leave = Leave(self.lattice.area)
        ground = self.lattice, self.spec.radius, self.fusion, self.own.log_odds, self._doubts
        self._ways = Ways(*ground, self._leave)

    @property
    def frame(self) -> GridFrame:
        """Where the cells lie that there can be."""
        return self.lattice.frame

    @property
    def planning(self) -> GridFrame:
        """Where the planning cells lie."""
        return self.frame.coarse(planning_factor(self.frame.resolution))

    @property
    def signed(self) -> SignedEvidence | None:
        """The team's evidence, where it is signed."""
        return self.fusion if isinstance(self.fusion, SignedEvidence) else None

    # -- evidence -----------------------------------------------------------------------------------

    def observe(self, seen: Scan | Sensed, pose: Pose, mates: Sequence[Mate], now: float) -> None:
        """Take in a scan, or a map that the robot has made itself."""
        self.platform.budget.move(pose.x, pose.y)
        if self.signed is not None:
            row, col = self.frame.cell(pose.x, pose.y)
            self.signed.set_out(max(row, 0), max(col, 0))
        if isinstance(seen, Scan):
            self.own.add(seen.unread if seen.mapped else seen, pose, mates, now)
            self._at = pose.x, pose.y
            self._looking.add(pose, seen.angles)
        elif isinstance(seen.data, OwnMap):
            self.own.take_over(seen.data, mates, now)

    @property
    def known(self) -> Extent:
        """Rows and columns outside of which neither the team nor the robot itself knows anything."""
        bounds = replace(self.own.seen)
        rows, cols = self.fusion.known
        if rows.stop > rows.start:
            bounds.hold(rows.start, rows.stop, cols.start, cols.stop)
        return bounds.extent

    def publish(self, now: float) -> None:
        """Hand the own evidence to fusion."""
        counts = None
        if now >= self._counts_due:
            self._counts_due = now + COUNTS_PERIOD
            counts = self._own_counts()
        changed = self.own.news()
        if self.signed is not None:
            self.signed.tell(self._own_notes())
        if len(changed) or counts is not None or self.signed is not None:
            self.fusion.publish(self.own.log_odds, changed, counts)

    def _own_counts(self) -> NDArray[np.int64]:
        """Return what the team adds up beside the map."""
        return self.own.counts.ravel().copy()

    # -- planning -----------------------------------------------------------------------------------

    def notes(self) -> list[tuple[int, int, int]]:
        """Return the frontiers that this robot's visits did not change, if it does not sign them."""
        return [] if self.signed is not None else self._own_notes()

    def _own_notes(self) -> list[tuple[int, int, int]]:
        """Return x, y [cm] and the unknown cells near each."""
        return [
            (round(spot.x * 100), round(spot.y * 100), spot.unknown)
            for spot in self.platform.left_alone.given_up
            if spot.visited
        ]

    def hear_notes(self, notes: Sequence[tuple[int, int, int]]) -> None:
        """Leave alone what team-mates' visits did not change, until the map there changes.

        Where notes are signed, they are believed by whose they are.
        """
        alone = self.platform.left_alone
        if self.signed is not None:
            alone.told, alone.hearsay = sifted(self.signed.notes().values())
        else:
            alone.told = [given_up_at(*note) for note in notes]

    def ahead(self, now: float) -> list[tuple[float, float, float, float]]:
        """Return the tour's stops: x, y [m], after how long [s], and the unknown ground near each [m^2]."""
        tour, cell = self.strategy, self.frame.resolution**2
        after = np.maximum(tour.arrivals + self._t0 - now, 0.0)
        return list(
            zip(*tour.targets.T.tolist(), after.tolist(), (tour.unknown * cell).tolist(), strict=True)
        )

    def freeze(self, t0: float) -> MapBelief:
        """Snapshot the team map for a round; tours count time from when it is frozen."""
        self._t0 = t0
        belief = self._frozen(self.fusion, self._leave, self._priorities)
        self.frontiers = len(belief.frontier_starts) - 1
        return belief

    def _frozen(self, shown: ShownMap, leave: Leave, priorities: Sequence[tuple[Area, float]]) -> MapBelief:
        """Snapshot a map of the team."""
        known = shown.known
        classes = self._to_plan_by(shown, known)
        counts = self._sightings(shown)
        about: dict[str, Any] = {
            "reach": max(self._range, NEARBY + self.frame.resolution),
            "extent": longest_frontier(self.spec.range),
            "shortest": shortest_frontier(self.spec.radius),
            "hidden": self.planner.hidden,
            "return_price": self.planner.return_price,
            "turn": self.planner.turn,
            "end_price": self.planner.end_price,
            "layers": self.planner.layers,
            "known": known,
            "leave": leave or None,
            "priorities": priorities,
            "prior": self.prior,
            "worlds": self.planner.worlds,
        }
        return Frozen.once(
            (classes, counts),
            (self.frame, *about.values()),
            lambda: freeze(classes, self.frame, counts=counts, **about),
        )

    @property
    def _range(self) -> float:
        """How far it sees [m]; where worlds are imagined all need one window: how far anybody does."""
        if self.most is None or self.planner.worlds == 1:
            return self.spec.range
        return max(self.spec.range, self.most.range)

    def _to_plan_by(self, shown: ShownMap, part: Extent) -> NDArray[np.uint8]:
        """Return what a part of a map of the team is taken to be where frontiers are looked for."""
        return shown.classes.window(*part)

    def _sightings(self, shown: ShownMap) -> NDArray[np.int64]:
        """``(ROWS, BINS)`` the team's sightings; where they are signed nobody's outweigh all others'."""
        if self.signed is None:
            return shown.counts[: ROWS * BINS].reshape(ROWS, BINS).copy()
        return pooled(self.signed.counts_of_each()[:, : ROWS * BINS].reshape(-1, ROWS, BINS))

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
        self._at_work = pose.at_work
        if not pose.at_work:
            self.platform.stand_by()
        self.strategy = self.platform.carry_over(self.strategy)
        if self.platform.leads_anywhere or not pose.at_work:
            self._resort.goal, self._left = None, None
        elif self.platform.ground is not None:
            self._left = leftovers(belief, self.platform)
            frontiers = len(belief.frontier_cells) > 0
            self._resort.consider(pose, belief.frame, self.platform.ground, frontiers)

    def _doubtful(self, belief: MapBelief) -> NDArray[np.bool_]:
        """Return ``(R, C)`` which cells of a round's window are occupied, but perhaps by mistake."""
        row, col = (first * belief.factor for first in belief.first)
        own = self.own.log_odds.window(
            slice(row, row + belief.frame.rows), slice(col, col + belief.frame.cols)
        )
        doubtful = self._doubts.about(belief.classes, own, belief.frame)
        return doubtful & self._leave.holds(belief.frame) if self._leave else doubtful

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
        """Who stands in the way: silent mates, and for a robot that is blocked all those near it."""
        passers_by = self.own.passers_by.discs(now) if blocked and self.own.passers_by is not None else []
        return passers_by + [
            (mate.x, mate.y, mate.radius)
            for mate in mates
            if mate.silent(now) or (blocked and np.hypot(mate.x - pose.x, mate.y - pose.y) < BLOCKING)
        ]

    def reach(self, now: float) -> None:
        """Tours lead anywhere."""

    def admit(self, belief: MapBelief, impact: Impact, robots: int) -> None:
        """Refuse more than so many of the team's best robots can see, and a price that they cannot have."""
        self.planner.end_price.times(LN2 / self.frame.resolution**2).check(impact, robots)
        if self.most is not None:
            side, edges = belief.planning.resolution, belief.layers.edges
            stops = MOST_STOPS  # a tour has no stop twice
            check_claim(impact, robots, self.most, stops, side, edges, self.planner.worlds)

    def promised(self, belief: MapBelief, impact: Impact) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Return the planning cells that are more likely seen than not, and after how long each [s]."""
        return promised(impact, belief.layers.edges, len(belief.worlds))

    def on_map(self, impact: Impact) -> Impact:
        """Return an impact as one over planning cells, to be shown."""
        return on_map(impact, self.planner.worlds)

    def unseen(self, belief: MapBelief, cells: NDArray[np.int64]) -> NDArray[np.bool_]:
        """Tell of which planning cells at least half is unknown."""
        row, col = np.divmod(cells, belief.planning.cols)
        row, col = row - belief.first[0], col - belief.first[1]
        rows, cols = belief.unknown.shape
        inside = (row >= 0) & (row < rows) & (col >= 0) & (col < cols)
        unseen = np.ones(len(cells), np.bool_)
        unseen[inside] = 2 * belief.unknown[row[inside], col[inside]] >= belief.factor**2
        return unseen

    def discounted(self, impact: Impact, halvings: int) -> Impact:
        """Return an impact that is so many times half as likely."""
        return discounted(impact, halvings)

    # -- energy and orders --------------------------------------------------------------------------

    def turns_back(self, pose: Pose) -> bool:
        """Tell whether the robot has to drive home now, or can do nothing more and come home."""
        budget = self.platform.budget
        if not budget.limited or budget.home is None:
            return False
        if self.platform.short and not self.platform.leads_anywhere:
            return True
        here = pose.x, pose.y
        home = self._ways.find(here, budget.home, (), False)
        legs = np.diff([here] if home is None else home.path, axis=0)
        return float(needed(np.hypot(*legs.T).sum(dtype=np.float32))) >= budget.left

    def heed(self, book: OrderBook) -> None:
        """Leave alone what is forbidden, and go first where there is priority."""
        self._leave = Leave(self.lattice.area, no_go_areas(book))
        self._priorities = priority_areas(book)
        self._ways.leave = self._leave
        self._ways.forget()
        if self.signed is not None:
            self.signed.overrule(*trusted(book))

    def way_out(self, pose: Pose) -> Route | None:
        """Return the shortest way out of where nobody may be any more; None: the robot is not in there."""
        return self._ways.out((pose.x, pose.y))

    # -- driving ------------------------------------------------------------------------------------

    def goal(self) -> tuple[float, float] | None:
        """Return the next viewpoint of the tour; without one, where there is something left to try."""
        return self._visits.goal(self.strategy)

    def served(self) -> bool:
        """Tell whether most of what the next stop was to reveal is known by now."""
        return self._visits.served(self.strategy)

    def _unknown_at(self, target: NDArray[np.float64]) -> int:
        near = self._to_plan_by(self.fusion, around(self.frame, *target))
        return int(np.count_nonzero(near == UNKNOWN))

    def reached(self, pose: Pose, mates: Sequence[Mate], now: float) -> bool:
        """Go on to the tour's next stop; False: the robot has not yet looked where it was planned to look."""
        done = self._visits.reached(self.strategy, pose, mates, now)
        if done and len(self.strategy):
            self.strategy = self.strategy.after_first()
        return done

    def stand_by(self) -> None:
        """Drop the tour; nothing is held against its stops."""
        self.strategy, self._resort.goal = STAY, None

    def release(self, now: float) -> None:
        """Drop the tour; leave its first stop alone for a while, after some tries until the map changes.

        What closes a way that was doubtful is not doubted here any more.
        """
        if self.platform.daring:
            self._doubts.settle(*self._at)
            self.platform.in_vain += 1
        elif len(self.strategy):
            self._visits.put_off(self.strategy, now)
        self.stand_by()

    def nothing_left(self, value: float, now: float) -> bool:
        """Tell whether nothing reachable is worth seeing, now or in a while, and all was tried."""
        tried = self._at_work and not self.platform.cut_short and self._resort.goal is None
        settled = self.signed is None or not self.signed.unsettled
        return value <= 0.0 and tried and settled and not self._visits.failures.postponed(now)

    def route(
        self, pose: Pose, goal: tuple[float, float], mates: Sequence[Mate], blocked: bool, now: float
    ) -> Route | None:
        """Return the shortest way to a goal on the newest team map, straightened; None if there is none."""
        ours = goal == self.goal()
        discs = self._discs(pose, mates, blocked, now)
        route = self._ways.find((pose.x, pose.y), goal, discs, self.platform.daring and ours)
        there = np.hypot(pose.x - goal[0], pose.y - goal[1]) <= THERE and ours
        if route is None or not there:
            return route
        return replace(route, facing=self._visits.facing(self.strategy, pose))

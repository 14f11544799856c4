"""A robot's share of exploring where none share a frame: it lives in its own, and rounds are on a plane."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Collection, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from vedette.agent.effects import Job
from vedette.agent.events import Pose, Scan, Sensed
from vedette.agent.mates import Mate
from vedette.agent.messages import FrameTold
from vedette.agent.orders import OrderBook
from vedette.domains.mapping.belief import Drawing, MapBelief
from vedette.domains.mapping.left_alone import GivenUp
from vedette.domains.mapping.prior import block_sum
from vedette.domains.mapping.sightings import berths_in
from vedette.domains.mapping.stops import LEFT_ALONE
from vedette.fusion import ShownMap
from vedette.fusion.frame_edges import FrameEdge, packed
from vedette.fusion.framed import FramedMap
from vedette.fusion.rendering import Frames
from vedette.maps import UNKNOWN, GridFrame
from vedette.maps.area import Area
from vedette.maps.bounds import Extent
from vedette.maps.leave import Leave
from vedette.maps.transform import Transform
from vedette.missions.explore.exploring import Exploring
from vedette.missions.explore.frames.matching import Matcher
from vedette.missions.explore.frames.meetings import Meetings
from vedette.missions.explore.frames.rendezvous import chances, worth_more
from vedette.missions.explore.frames.seen_moving import SeenMoving
from vedette.missions.explore.frames.shared import SharedFrames
from vedette.missions.explore.frames.walls import closed, sealed
from vedette.missions.explore.passers_by import Disc, PassersBy
from vedette.missions.ordered import no_go_areas, priority_areas
from vedette.problem import Reach

ASKEW = 0.5  # of a cell: no frame of a robot's own has its cells along the walls
ERRAND = -1  # epoch of a job that belongs to no round
NUMBERED = 1 << 16  # robots; a note's number is its own times that, plus the robot in whose frame it lies
Note = tuple[int, int, int]
Areas = tuple[tuple[Area, ...], tuple[tuple[Area, float], ...]]  # where nobody may go, and what comes first


@dataclass(eq=False)
class FramedExploring(Exploring):
    """Explores, and finds out how the team's frames lie."""

    rendezvous: bool = False  # ground is worth more where another component may know it
    frames: SharedFrames = field(init=False)
    matcher: Matcher = field(init=False)
    meetings: Meetings = field(init=False)
    _orders: OrderBook = field(default_factory=OrderBook)
    _heeded: Areas | None = None  # no-go areas and priorities in the robot's own frame
    _local: MapBelief | None = None  # the round's belief in the robot's own frame
    _errands: int = 0
    _seen_moving: SeenMoving = field(init=False)
    _latest: tuple[Scan, Pose, float] | None = None  # scan, from where and when [s]
    _counted: dict[GivenUp, int] = field(default_factory=dict)  # unknown cells near what mates left alone

    def __post_init__(self) -> None:
        super().__post_init__()
        evidence = cast(FramedMap[Any], self.fusion)
        self.own.askew = ASKEW * self.frame.resolution
        self.own.passers_by = PassersBy(self.frame, self.spec.radius)  # mates of unknown frames among them
        reach = self.spec.range if self.most is None else self.most.range
        self.frames = SharedFrames(evidence, self.frame, gap=2.0 * reach + 1.0)
        self.matcher = Matcher(evidence.key[0], self.frames.charts)
        self.meetings = Meetings(evidence.key)
        self._seen_moving = SeenMoving(self.frame, self.spec)

    # -- evidence -----------------------------------------------------------------------------------

    def publish(self, now: float) -> None:
        """Hand the own evidence to fusion, and at once what has been found of how frames lie."""
        self.matcher.take()
        told = self.frames.evidence.told.get(self.frames.key, ())
        if not set(self._edges) <= set(told):
            self._counts_due = now
        super().publish(now)

    @property
    def _edges(self) -> list[FrameEdge]:
        """What this robot has found of how frames lie."""
        guesses = [
            edge
            for edge in self.matcher.guesses.values()
            if self.frames.graph[edge.a].anchor != self.frames.graph[edge.b].anchor
        ]
        return [*self.matcher.found.values(), *self.meetings.found.values(), *guesses]

    @property
    def refused(self) -> Counter[str]:
        """By why, how often this robot did not believe what may have joined two."""
        return self.matcher.refused + self.meetings.refused

    def _own_counts(self) -> NDArray[np.int64]:
        evidence = self.frames.evidence
        edges = packed(self._edges, len(evidence.counts) - evidence.edges_from)
        return np.concatenate((super()._own_counts(), edges))

    def observe(self, seen: Scan | Sensed, pose: Pose, mates: Sequence[Mate], now: float) -> None:
        """Take in what the robot sees; where its SLAM puts its place right, meetings are less certain."""
        super().observe(seen, pose, mates, now)
        self.meetings.stand(pose, self.spec.speed, now)
        if isinstance(seen, Scan):
            self._latest = seen, pose, now

    def meet(self, mates: Sequence[Mate], now: float) -> None:
        """Compare what has been seen of discs that move with what mates say, each in its own frame."""
        unplaced = {(mate.robot, mate.boot) for mate in mates if self.frames.own(mate.robot) is None}
        if not unplaced:
            return
        self.meetings.hear(mates)
        if self._latest is not None and self._latest[2] == now:
            self.meetings.see(self._moving(*self._latest), now)
        self.meetings.compare(unplaced, now)

    def _moving(self, scan: Scan, pose: Pose, now: float) -> Sequence[Disc]:
        """Return what may move in the latest scan, own frame."""
        if scan.mapped:
            return self._seen_moving.look(scan, pose, now)
        assert self.own.passers_by is not None
        return self.own.passers_by.discs(now)

    def errand(self, living: Collection[int], now: float) -> Job | None:
        """Return a job that finds out how two contributors' frames lie, if it is time for one."""
        run = self.matcher.errand(self.frames.graph, living, now)
        if run is None:
            return None
        self._errands += 1
        return Job((ERRAND, self._errands), run, beside=True)

    # -- frames -------------------------------------------------------------------------------------

    def lay_out(self) -> tuple[FrameTold, ...]:
        """As the root: return where contributors' frames lie on the plane of a round that begins."""
        return self.frames.lay_out()

    def take_frames(self, told: Sequence[FrameTold]) -> bool:
        """Be on the plane as the root says; tell whether this robot has come to the same."""
        agrees = self.frames.take(told)
        self._heed()
        for pair, edge in list(self.matcher.found.items()):
            joined = self.frames.graph[edge.a].anchor == self.frames.graph[edge.b].anchor
            if not joined and edge in self.frames.evidence.edges:
                self.matcher.drop(pair)
        return agrees

    def ground(self) -> Reach | None:
        """Return where on the round's plane what this robot is joined with can be; None: it is not on it."""
        box = self.frames.ground()
        return None if box is None else (box,)

    def heed(self, book: OrderBook) -> None:
        """Leave alone what is forbidden, and go first where there is priority, as far as it knows where."""
        self._orders, self._heeded = book, None
        self._heed()

    def _heed(self) -> None:
        """Heed orders as their places lie in the robot's own frame, if that has changed."""
        book = self._orders.seen_from(self.frames.own)
        areas = no_go_areas(book), tuple(priority_areas(book))
        if areas != self._heeded:
            self._heeded = areas
            super().heed(book)

    def in_own(self, robot: int) -> Transform | None:
        """Return where a robot's frame lies in this one's; None: it is not known."""
        return self.frames.own(robot)

    # -- planning -----------------------------------------------------------------------------------

    def notes(self) -> list[Note]:
        """Return the frontiers that this robot's visits did not change, each with whose frame it is in."""
        if self.signed is not None:
            return []
        own = self.frames.key[0]
        return [(x, y, NUMBERED * unknown + own) for x, y, unknown in self._own_notes()]

    def hear_notes(self, notes: Sequence[Note]) -> None:
        """Leave alone what visits did not change of whoever is joined with this robot."""
        if self.signed is None:
            notes = self._in_own_frame(notes)
        super().hear_notes(notes)
        alone = self.platform.left_alone
        told = {spot: self._unknown_when_told(spot) for spot in (*alone.told, *alone.hearsay)}
        self._counted = told
        alone.told = [replace(spot, unknown=told[spot]) for spot in alone.told]
        alone.hearsay = [replace(spot, unknown=told[spot]) for spot in alone.hearsay]

    def _in_own_frame(self, notes: Sequence[Note]) -> list[Note]:
        """Return notes of those of whom it is known where their frames lie, moved."""
        moved = list[Note]()
        for x, y, number in notes:
            unknown, robot = divmod(number, NUMBERED)
            there = self.frames.own(robot)
            if there is not None:
                at = there.place(x / 100.0, y / 100.0)
                moved.append((round(100.0 * at[0]), round(100.0 * at[1]), unknown))
        return moved

    def _unknown_when_told(self, spot: GivenUp) -> int:
        """Return the unknown cells near what a mate left, in this robot's map when it was told of it first.

        Drawn in another frame a map has another number of them, which says nothing of what has changed.
        """
        for earlier, unknown in self._counted.items():
            if earlier.unknown == spot.unknown and math.dist(earlier.at, spot.at) < LEFT_ALONE:
                return unknown
        return self._unknown_at(np.array(spot.at))

    def _to_plan_by(self, shown: ShownMap, part: Extent) -> NDArray[np.uint8]:
        classes = closed(super()._to_plan_by(shown, part))
        if shown is not self.fusion:
            return classes  # the plane, of which all who decide have to make the same
        return self._sealed(classes, self.frame.window(*part), self.frames.evidence.frames)

    def _sealed(self, classes: NDArray[np.uint8], window: GridFrame, frames: Frames) -> NDArray[np.uint8]:
        """Return a part of a map in which contributors lie so, without the gaps that walls get by that."""
        return sealed(classes, window, self.frame, self.frames.evidence.makers(frames))

    def freeze(self, t0: float) -> MapBelief:
        """Snapshot the plane, which all have alike, and beside it the map in the robot's own frame."""
        book = self._orders.seen_from(self.frames.on_plane)
        areas = Leave(self.lattice.area, no_go_areas(book)), priority_areas(book)
        plane = self._frozen(self.frames.evidence.plane, *areas)
        guesses = self.frames.guesses() if self.rendezvous else []
        if guesses:
            plane = worth_more(plane, chances(plane, guesses))
        local = super().freeze(t0)
        self._local = replace(local, layers=plane.layers, gathering=plane.gathering)
        return plane

    def prepare(
        self, belief: MapBelief, pose: Pose, mates: Sequence[Mate], blocked: bool, now: float
    ) -> None:
        """Find the stops in the robot's own frame, by what they show on the plane."""
        assert self._local is not None
        there = self.frames.plane.get(self.frames.key)
        valued = None if there is None else Drawing(self._to_value_by(belief), there)
        super().prepare(replace(self._local, valued=valued), pose, mates, blocked, now)
        if there is None:  # the root has not heard of what this robot has seen
            self.platform.stand_by()
            self.strategy = self.platform.carry_over(self.strategy)

    def _to_value_by(self, plane: MapBelief) -> MapBelief:
        """Return the plane on which this robot's stops are worth what they show.

        Of what a round is decided on all make the same; which stops it has a robot knows by itself.
        """
        classes = self._sealed(plane.classes, plane.frame, self.frames.plane)
        berths = berths_in(classes, plane.frame.resolution)
        return replace(
            plane, classes=classes, berths=berths, unknown=block_sum(classes == UNKNOWN, plane.factor)
        )

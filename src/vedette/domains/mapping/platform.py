"""One mapping robot: the tours it can make, what they would reveal, and its best reply to the team."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from vedette.domains.mapping.belief import MapBelief
from vedette.domains.mapping.budget import WayLeft
from vedette.domains.mapping.foreseen import LONG_TOUR, by_way_of_frontier, supposed, with_foreseen
from vedette.domains.mapping.impact import Impact
from vedette.domains.mapping.layers import STEP
from vedette.domains.mapping.left_alone import LeftAlone, Place
from vedette.domains.mapping.price import FREE
from vedette.domains.mapping.sightings import SightingModel, beam_model, measured_model
from vedette.domains.mapping.stops import (
    CLEARANCES,
    LEFT_ALONE,
    LEFT_ALONE_AT_LAST,
    Disc,
    Ground,
    Stops,
    enough_of_sight,
    find_stops,
    survey,
)
from vedette.domains.mapping.tour import STAY, Tour, on_the_way
from vedette.domains.mapping.views import by_way, look
from vedette.kernels import coverage
from vedette.team import PlatformSpec

LEAST_AREA = 0.08  # a stop must promise this much [m^2] ...
WORTH_A_DARE = 1.0  # ... and behind what is doubtful so much, twice as much after every doubt in vain [m^2]
HYSTERESIS = 0.03  # a new strategy must gain this share more than the present one
STICKINESS = 0.1  # to turn away from the stop under way must gain this share more
WORTH_A_CHANGE, TURNING_BACK = 2.0, 3.0  # where the end of a tour has a price, so much must be saved [s]
PATIENCE = 4  # times the usual work, if that finds nothing; twice as much each time that is not enough
SAME_PLACE = 1.2  # a frontier this near a stop of the last round is the same one [m]
_NONE, _NOWHERE = np.empty(0, np.int64), np.empty((0, 2))


@dataclass(eq=False)
class MappingPlatform:
    """A robot with a lidar: strategies are tours of frontiers under the team's time-layered objective.

    ``place`` says where it is before ``prepare``; a round then works on what ``prepare`` found.
    """

    spec: PlatformSpec
    max_stops: int = 6
    measured: str = "unknown"  # sighting model: "unknown" length or "distance" (the paper's), or "beam"
    stall: float = 0.0  # how often it gets stuck for good [1/m]
    foresees: bool = False  # tours may lead on into what is foreseen
    x: float = 0.0
    y: float = 0.0
    obstacles: list[Disc] = field(default_factory=list)
    team: list[Place] = field(default_factory=list)  # all, itself included
    now: float = 0.0
    left_alone: LeftAlone = field(init=False)  # frontiers
    doubtful: NDArray[np.bool_] | None = None  # (R, C) of the window: occupied, but not for sure
    ground: Ground | None = None
    daring: bool = False  # the round's stops are behind what is doubtful
    in_vain: int = 0  # doubts in a row that led nowhere
    stops: Stops | None = None
    budget: WayLeft = field(init=False)  # of way
    short: bool = field(init=False, default=False)  # there are stops that leave too little to come home
    considered: NDArray[np.float64] = field(init=False)  # (N, 2) frontiers of stops, those left alone too [m]
    cut_short: bool = field(init=False, default=False)  # the round's work ended before all was looked at
    patience: int = field(init=False, default=PATIENCE)
    ahead: int = field(init=False, default=1)  # stops of a tour in this round, at most

    def __post_init__(self) -> None:
        self.considered, self.budget = _NOWHERE, WayLeft(self.spec.way)
        self.left_alone = LeftAlone(self.spec)

    def place(
        self,
        x: float,
        y: float,
        obstacles: list[Disc],
        team: list[Place],
        now: float,
        doubtful: NDArray[np.bool_] | None = None,
    ) -> None:
        """Say where the robot and its mates are [m], team frame, which discs do not move, what time it is.

        ``doubtful``: ``(R, C)`` cells of the round's window that are occupied, but perhaps by mistake.
        """
        self.x, self.y, self.obstacles, self.team, self.now = x, y, obstacles, team, now
        self.doubtful = doubtful

    def model(self, belief: MapBelief) -> SightingModel:
        """Return the sighting model that the belief's counts give this robot's sensor."""
        cells = int(np.ceil(self.spec.range / belief.frame.resolution))
        measured = self.measured if belief.gathering else "distance"
        if measured == "beam":
            return beam_model(cells)
        return measured_model(
            belief.counts, belief.frame.resolution, cells, by_distance=measured == "distance"
        )

    def prepare(self, belief: MapBelief) -> None:
        """Survey the ground and find the stops; the slow part, before the round.

        A robot that finds none looks at the frontiers from close by, then for narrower ways, and in the end
        for ways that only doubtful cells close. Its work is bounded: if so much of it finds nothing and there
        are frontiers left, it works more the next time.
        """
        self.left_alone.judge(belief, self.team, self.now)
        self.ahead = self.max_stops if belief.gathering else 1
        self.cut_short = self.daring = self.short = False
        model = self.model(belief)
        if self._finds_anything(belief, model):
            self._foresee(belief)
            return
        if self.left_alone.hearsay:
            self.left_alone.hearsay = []
            if self._finds_anything(belief, model):
                return
        self.daring = self._dares(belief, model)
        self.patience *= 2 if self.cut_short and not self.daring else 1

    def _foresee(self, belief: MapBelief) -> None:
        """Let tours lead on to places that nobody has seen yet, where they are trusted to be."""
        if not self.foresees or not any(belief.worlds) or self.ahead == 1 or self.budget.limited:
            return
        assert self.stops is not None
        ground = survey(supposed(belief), self.spec, self.x, self.y, self.obstacles, CLEARANCES[0])
        self.stops = with_foreseen(belief, ground, self.spec, self.stops)
        self.ahead = LONG_TOUR

    def _finds_anything(self, belief: MapBelief, model: SightingModel) -> bool:
        """Look for stops on ground that is less and less wide; tell if one can be visited."""
        for clearance in CLEARANCES:
            self.ground = survey(belief, self.spec, self.x, self.y, self.obstacles, clearance)
            self.budget.look(belief.frame, self.ground.passable)
            if self._leads_on(belief, self.ground, model, last=clearance == CLEARANCES[-1]):
                return True
        return False

    def _leads_on(self, belief: MapBelief, ground: Ground, model: SightingModel, *, last: bool) -> bool:
        """Find stops on the ground; tell if one can be visited."""
        ways = ((False, False), (True, last))
        if any(self._find_stops(belief, ground, model, *close) for close in ways):
            self.patience = PATIENCE
            return True
        return False

    def _dares(self, belief: MapBelief, model: SightingModel) -> bool:
        """Find stops beyond what is doubtful, which the robot will see better on its way there."""
        assert self.ground is not None
        if self.doubtful is None or not self.doubtful.any():
            return False
        dared = survey(belief, self.spec, self.x, self.y, self.obstacles, CLEARANCES[-1], self.doubtful)
        if not (np.isfinite(dared.field) & ~np.isfinite(self.ground.field)).any():
            return False
        sure, self.ground = self.ground, dared
        if self._leads_on(belief, dared, model, last=True):
            return True
        self.ground = sure
        return False

    def _find_stops(
        self, belief: MapBelief, ground: Ground, model: SightingModel, close: bool, last: bool
    ) -> bool:
        """Find the nearest stops, or if they are no good those after them; tell if one can be visited."""
        least = max(LEAST_AREA, 0.5 * belief.frame.resolution**2)
        dare = min(WORTH_A_DARE, 2.0 * enough_of_sight(self.spec)) * 2.0**self.in_vain
        closer = [spot.at for spot in self.left_alone.closer]
        tried = _NONE
        self.considered = _NOWHERE
        for effort in (1, self.patience):
            found = look(belief, ground, self.spec, close=close, closer=closer, last=last, effort=effort)
            for lot in by_way(found.only(~np.isin(found.clusters, tried)), ground):
                stops = find_stops(
                    belief,
                    ground,
                    self.spec,
                    model,
                    least,
                    lot,
                    dare=dare,
                    tours=self.ahead > 1,
                    stall=self.stall,
                )
                self.considered = np.concatenate((self.considered, stops.targets))
                self.stops = self._open(stops, LEFT_ALONE_AT_LAST if last else LEFT_ALONE)
                if self.leads_anywhere:
                    self.cut_short = found.cut_short
                    return True
            if found.horizon == np.inf:
                return False
            tried = found.clusters
        self.cut_short = True
        return False

    def stand_by(self) -> None:
        """Leave all stops of the round to others."""
        assert self.stops is not None
        self.stops = replace(self.stops, first_leg=np.full_like(self.stops.first_leg, np.inf))
        self.cut_short = self.daring = False

    @property
    def leads_anywhere(self) -> bool:
        """Tell whether the robot can reach any stop of the round."""
        return self.stops is not None and bool(np.isfinite(self.stops.first_leg).any())

    def _open(self, stops: Stops, within: float) -> Stops:
        """Shut the stops that are left alone, and those from which the robot could not come home."""
        stops = stops.shut(self.left_alone.holds(stops.targets, within))
        if not self.budget.limited:
            return stops
        dear = ~self.budget.affords(stops.views, stops.first_leg.astype(np.float64) * self.spec.speed)
        self.short |= bool((np.isfinite(stops.first_leg) & dear).any())
        return stops.shut(dear)

    def carry_over(self, strategy: Tour) -> Tour:
        """Restate last round's tour over this round's stops: same places, new arrival times."""
        assert self.stops is not None
        order: list[int] = []
        for x, y in strategy.targets:
            if not len(self.stops):
                break
            away = np.hypot(self.stops.targets[:, 0] - x, self.stops.targets[:, 1] - y)
            nearest = int(np.argmin(away))
            reachable = np.isfinite(self.stops.first_leg[nearest])
            if away[nearest] <= SAME_PLACE and reachable and nearest not in order:
                order.append(nearest)
        return self.tour(np.array(order, np.int64))

    def tour(self, order: NDArray[np.int64]) -> Tour:
        """Return the tour over these stops, cut before the first that it cannot reach, or come home from."""
        assert self.stops is not None
        if not len(order):
            return STAY
        order = by_way_of_frontier(self.stops, order)
        legs = np.concatenate(([self.stops.first_leg[order[0]]], self.stops.legs[order[:-1], order[1:]]))
        arrivals = np.cumsum(legs, dtype=np.float32).astype(np.float64)  # to the bit as the kernel's
        order = order[: int(np.isfinite(arrivals).sum())]
        if self.budget.limited:
            ways = arrivals[: len(order)] * self.spec.speed  # turns count as ways: never too little
            order = order[: int(self.budget.affords(self.stops.views[order], ways).cumprod().sum())]
        return Tour(
            self.stops.targets[order],
            self.stops.views[order],
            arrivals[: len(order)],
            self.stops.unknown[order],
            order,
        )

    def is_ahead_of_map(self, strategy: Tour) -> bool:
        """Tell whether a tour's next stop is one that nobody has seen yet: a later round finds the way."""
        if not len(strategy) or self.stops is None or not self.stops.foreseen:
            return False
        return int(strategy.stops[0]) >= len(self.stops) - self.stops.foreseen

    def impact(self, belief: MapBelief, strategy: Tour) -> Impact:
        """What the tour would reveal, each stop's footprint in the layer of its arrival; paper, eq. (39)."""
        assert self.stops is not None
        shown = on_the_way(self.stops.footprints, strategy, belief.layers)
        return Impact(*shown, self.price(belief, strategy))

    def price(self, belief: MapBelief, strategy: Tour) -> int:
        """Return what a tour costs; to stay costs what the farthest single stop does, so it is never better.

        docs/theory.md (V194)
        """
        assert self.stops is not None
        legs = self.stops.first_leg
        end = strategy.arrivals[-1] if len(strategy) else legs.max(where=np.isfinite(legs), initial=0.0)
        return belief.end_price.of(float(end))

    def reply(self, belief: MapBelief, others: Impact, current: Tour) -> Tour:
        """Best tour found against the rest of the team, if clearly better than the present one.

        Source: paper, eq. (30).
        """
        problem = self._problem(belief, others)
        if belief.end_price != FREE:
            return self._priced_reply(problem, current)
        tour, gain, present = self._best(problem, current, STICKINESS)
        return tour if gain > present * (1.0 + HYSTERESIS) else current

    def _priced_reply(self, problem: coverage.TourProblem, current: Tour) -> Tour:
        """As `reply`, but better is what saves seconds: of long tours a share says little.

        What a second is worth is told by the present tour, set off later.
        """
        later = replace(problem, first_leg=problem.first_leg + np.float32(STEP))
        lost = self._worth(problem, current) - self._worth(later, current) if len(current) else 0.0
        second = max(lost, 0.0) / STEP
        tour, gain, present = self._best(problem, current, margin=TURNING_BACK * second)
        return tour if gain > present + WORTH_A_CHANGE * second else current

    def _best(
        self, problem: coverage.TourProblem, current: Tour, stickiness: float = 0.0, margin: float = 0.0
    ) -> tuple[Tour, float, float]:
        """Return the best tour found that leaves enough to come home, its gain, and the present one's."""
        order, gain, present = coverage.best_tour(problem, current.stops, self.ahead, stickiness, margin)
        tour = self.tour(order)
        if len(tour) < len(order):  # too dear: what is cut off has been counted in the gain
            order, gain, present = coverage.best_tour(problem, current.stops, 1, stickiness, margin)
            tour = self.tour(order)
        return tour, gain, present

    def _worth(self, problem: coverage.TourProblem, tour: Tour) -> float:
        return coverage.best_tour(problem, tour.stops, 0)[2]

    def slack(self, belief: MapBelief, team: Impact) -> float:
        """No strategy of this robot adds more to the team's impact [nats]; docs/mapping.md (V26).

        Infinite, which promises nothing, if the round's work ended before all frontiers were looked at.
        """
        if self.cut_short:
            return math.inf
        assert self.stops is not None
        most = self.ahead + (self.stops.foreseen > 0)  # the frontier that a tour leads by counts too
        return coverage.most_any_tour_adds(self._problem(belief, team), most)

    def _problem(self, belief: MapBelief, others: Impact) -> coverage.TourProblem:
        """Return the choice of a tour against the others' impact."""
        stops = self.stops
        assert stops is not None
        worth, layers, price = belief.weights, belief.layers, belief.end_price
        return coverage.TourProblem(
            worth, layers.weights, layers.edges, others.sparse, stops.footprints, stops.first_leg, stops.legs,
            (price.linear, price.quadratic),
        )  # fmt: skip

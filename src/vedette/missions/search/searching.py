"""Searching as a mission: the domain of search and step evidence, put together for the agent."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from vedette.agent.events import Pose, Sensed
from vedette.agent.flight import FlightPlan, start_step, step_of
from vedette.agent.mates import Mate
from vedette.agent.mission import RoundPlatform
from vedette.domains.search.belief import SearchBelief, TargetPdf, freeze
from vedette.domains.search.declaring import declared_place
from vedette.domains.search.detectors import Report
from vedette.domains.search.evidence import LEVELS_PER_NAT, LookEvidence, evidence_of_looks
from vedette.domains.search.flights import Flight
from vedette.domains.search.impact import Impact, SearchImpactCodec, check_claim
from vedette.domains.search.objective import SearchObjective
from vedette.domains.search.platform import SearchPlatform
from vedette.domains.search.worth import Worth
from vedette.fusion.steps import Refilter, Sparse, SparseIntegers, StepEvidence
from vedette.missions.flying import FlyingMission, SharedBelief, box_around
from vedette.missions.ordered import cells_in
from vedette.problem import Reach
from vedette.team import Most
from vedette.vehicle import drive

OBJECTIVE = SearchObjective()
LOOKS_KEPT = 8  # steps whose looks are kept, for people to see


@dataclass(frozen=True, eq=False)
class SearchPlan:
    """What a team agrees on beforehand."""

    prior: TargetPdf  # at step 0, with the target's motion and the length of a step
    worth: Worth
    lead: float  # from freezing a round to the start of its plans, at least [s]
    threshold: float = 0.95  # posterior probability that a declared place must have within ``radius``
    radius: float = 100.0  # [m]
    most: Most | None = None  # of any vehicle; None: not known, so that no claim is too large

    def step(self, time: float) -> int:
        """Return the step that a time [s] lies in; step k begins at ``k dt``."""
        return step_of(time, self.prior.dt)


@dataclass(frozen=True, eq=False)
class Looks:
    """What a vehicle's sensor tells at the end of a step; the target is taken to be where it is then."""

    poses: NDArray[np.float64]  # (L, 3) where it looked from [m, m, rad]
    reports: tuple[Report, ...]  # (L,)


@dataclass(frozen=True)
class Declared:
    """A place at which a vehicle says that the target is."""

    x: float  # [m], team frame
    y: float
    time: float  # [s]
    certain: bool  # by a detection that cannot be a false alarm


@dataclass(eq=False)
class Searching(FlyingMission[SearchBelief, Flight, Impact]):
    """One vehicle's share of a search; ``vedette.agent.mission.FlightMission``.

    Evidence waits to be published: a round's must not change while it lasts.
    """

    vehicle: SearchPlatform
    team: SearchPlan
    fusion: StepEvidence[Sparse]
    tells_plans: bool = True  # False: the team shares beliefs alone
    strategy: Flight = field(default_factory=lambda: Flight(0, np.empty(0)))
    declared: Declared | None = None
    looked: deque[tuple[int, NDArray[np.float64]]] = field(default_factory=lambda: deque(maxlen=LOOKS_KEPT))
    codec: SearchImpactCodec = field(init=False)
    working: RoundPlatform[SearchBelief, Flight, Impact] = field(init=False)
    _elements: SparseIntegers = field(init=False)
    _filter: Refilter[TargetPdf, Sparse] = field(init=False)
    _waiting: list[tuple[int, LookEvidence]] = field(default_factory=list)
    _flown: Flight | None = None  # what the vehicle was last told to fly
    _seen_at: tuple[float, float, float] | None = None  # x, y [m], time [s] of the last pose

    def __post_init__(self) -> None:
        prior = self.team.prior
        self.codec = SearchImpactCodec(prior.frame.size, len(self.team.worth.weights))
        self.working = self.vehicle if self.tells_plans else SharedBelief(self.vehicle, self.objective)
        self._elements = SparseIntegers(prior.frame.size)
        self._filter = Refilter(self.fusion, prior, prior.step, predict=_moved, update=_observed)

    @property
    def objective(self) -> SearchObjective:
        """What the team gains."""
        return OBJECTIVE

    # -- evidence -----------------------------------------------------------------------------------

    def observe(self, seen: Sensed, pose: Pose, mates: Sequence[Mate], now: float) -> None:
        """``ln p(reports | target in the cell)``, relative to that elsewhere; docs/search.md (V42)."""
        assert isinstance(seen.data, Looks)
        self._seen_at = pose.x, pose.y, now
        detector, reports = self.vehicle.detector, seen.data.reports
        told = evidence_of_looks(detector, self.team.prior.frame, seen.data.poses, reports)
        step = self.team.step(seen.time)
        self._waiting.append((step, told))
        self.looked.append((step, seen.data.poses))
        places = [report for report in reports if report is not None]
        if places and detector.false_alarm == 0.0 and self.declared is None:
            self.declared = Declared(*places[0], now, certain=True)

    def publish(self, now: float) -> None:
        """Hand the evidence that waits to fusion."""
        waiting, self._waiting = self._waiting, []
        for step, told in waiting:
            self.fusion.publish(step, self._elements.of(told.cells.astype(np.int64), told.levels))

    @property
    def first_step(self) -> int:
        """The first step whose pdf can still be had."""
        return self._filter.first

    def pdf(self, step: int) -> TargetPdf:
        """Return where the target may be at a step, by all that this vehicle has published and heard."""
        return self._filter.at(step)

    # -- planning -----------------------------------------------------------------------------------

    def freeze(self, t0: float) -> SearchBelief:
        """Snapshot the pdf of the present step; plans take over at the first step that all can make.

        By a clock that is behind, the present may be a step that is no longer kept: the first that is, then.
        """
        step = max(self.team.step(t0), self.first_step)
        pdf = self.pdf(step)
        if self.declared is None and self.vehicle.detector.false_alarm > 0.0:
            place = declared_place(pdf, self.team.threshold, self.team.radius)
            self.declared = None if place is None else Declared(*place, t0, certain=False)
        belief = freeze(pdf, self.team.worth, max(0, start_step(t0, self.team.lead, pdf.dt) - step))
        return replace(belief, mass=self._weighed(belief)) if self.priorities else belief

    def _weighed(self, belief: SearchBelief) -> NDArray[np.float64]:
        """``P(x) prod_a f_a``, (R, C), over the priority areas a that x lies in; docs/search.md (V164)."""
        mass = belief.mass.copy()
        for area, factor in self.priorities:
            mass[cells_in(area, belief.frame)] *= factor
        return mass

    def prepare(
        self, belief: SearchBelief, pose: Pose, mates: Sequence[Mate], blocked: bool, now: float
    ) -> None:
        """List the flights from where the vehicle will be, and restate the present one.

        ``pose`` is where the committed steps end; flown backwards they lead to where they begin.
        """
        self.held, self.vehicle.forbidden = not pose.at_work, self.forbidden
        if self.held:
            return
        flown = self._taken_to(belief)
        kept = flown.turn_rates[max(0, belief.step - flown.step) :][: belief.committed]
        end = np.array((pose.x, pose.y, pose.heading))
        begin = drive(end, -kept[::-1], -self.vehicle.speed, belief.dt)[-1] if len(kept) else end
        self.vehicle.place(begin, flown)
        self.vehicle.prepare(belief)
        self.strategy = self.vehicle.start

    def _taken_to(self, belief: SearchBelief) -> Flight:
        """Return the flight under way, with the circles that follow it until new plans take over."""
        until, circle = belief.step + belief.committed, self.vehicle.turn_rate
        flown = self._flown or Flight(belief.step, np.empty(0))
        circles = np.full(max(0, until - flown.step - len(flown.turn_rates)), circle)
        goal = flown.goal if not len(circles) else None
        return Flight(flown.step, np.concatenate((flown.turn_rates, circles)), goal)

    def reach(self, now: float) -> Reach | None:
        """Return the box that its gains depend on in a round frozen within ``lead`` of now; (V14), (V49).

        It holds what the sensor can see by the end of the horizon, and from where a target can get there
        meanwhile. With promises gains depend on places anywhere: no bounds.
        """
        team, prior = self.team, self.team.prior
        if self._seen_at is None or team.worth.promises:
            return None
        x, y, then = self._seen_at
        flown = self.vehicle.speed * (now - then + team.lead + team.worth.horizon * prior.dt)
        drift = (prior.stencil.reach * team.worth.horizon + 1.0) * prior.frame.resolution
        return box_around(x, y, flown + self.vehicle.detector.range + drift)

    def admit(self, belief: SearchBelief, impact: Impact, robots: int) -> None:
        """Refuse more than so many of the team's best vehicles can look at."""
        if self.team.most is not None:
            side, horizon = belief.frame.resolution, belief.horizon
            check_claim(impact, robots, self.team.most, side, belief.layers, horizon, belief.dt)

    # -- flying -------------------------------------------------------------------------------------

    def stand_by(self) -> None:
        """Leave the present flight: orders keep the vehicle from it."""
        self.strategy, self._flown = Flight(0, np.empty(0)), None

    def start(self, belief: SearchBelief) -> float:
        """Return when flights planned on this belief take over [s]."""
        return (belief.step + belief.committed) * belief.dt

    def plan(self) -> FlightPlan | None:
        """Return the flight decided on; None before the first round."""
        if not len(self.strategy.turn_rates):
            return None
        self._flown = self.strategy
        dt = self.team.prior.dt
        return FlightPlan(self.strategy.step * dt, dt, self.strategy.turn_rates)


def _moved(pdf: TargetPdf, step: int) -> TargetPdf:
    return pdf.predict()


def _observed(pdf: TargetPdf, step: int, total: Sparse) -> TargetPdf:
    return pdf.observe(total.index, total.value / LEVELS_PER_NAT) if len(total.index) else pdf

"""Monitoring as a mission: the domain of monitoring and step evidence, put together for the agent."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from math import hypot, inf

import numpy as np
from numpy.typing import NDArray

from vedette.agent.events import Pose, Sensed
from vedette.agent.flight import MovePlan, start_step, step_of
from vedette.agent.mates import Mate
from vedette.agent.mission import RoundPlatform
from vedette.domains.monitoring.belief import FieldBelief
from vedette.domains.monitoring.evidence import FieldPacking
from vedette.domains.monitoring.impact import FieldImpactCodec, Impact, check_claim
from vedette.domains.monitoring.objective import MonitoringBelief, MonitoringObjective, SpotsFirst
from vedette.domains.monitoring.patrols import around
from vedette.domains.monitoring.planning import Outlook
from vedette.domains.monitoring.platform import FieldSensor, MonitoringPlatform, within
from vedette.domains.monitoring.purse import Purse
from vedette.domains.monitoring.ways import Place, Way, cells_of
from vedette.domains.monitoring.worth import Patrol
from vedette.fusion.steps import Refilter, Sparse, SparseIntegers, StepEvidence
from vedette.maps import GridFrame
from vedette.maps.leave import Leave
from vedette.missions.flying import FlyingMission, SharedBelief, box_around
from vedette.missions.ordered import cells_in
from vedette.problem import Reach

OBJECTIVE = MonitoringObjective()


@dataclass(frozen=True, eq=False)
class MonitorPlan:
    """What a team agrees on beforehand."""

    packing: FieldPacking
    patrol: Patrol
    dt: float  # length of a step [s]
    lead: float  # from freezing a round to the start of its plans, at least [s]
    unit: float  # of information in impacts [1 / unit^2]
    most: int  # units that a measurement of the team's best sensor has

    @cached_property
    def outlook(self) -> Outlook:
        """The field as plans see it."""
        return Outlook(self.packing.model, self.packing.spots)

    @property
    def prior(self) -> FieldBelief:
        """What is known at step 0."""
        return FieldBelief.prior(self.packing.model, self.packing.spots, self.dt)


@dataclass(frozen=True, eq=False)
class FieldLook:
    """What a vehicle's sensor tells at the end of a step."""

    cell: int  # flat, about which it measured
    value: float  # [unit]


@dataclass(frozen=True, eq=False)
class Pilot:
    """Whoever follows a fixed patrol, and negotiates nothing; ``vedette.agent.mission.RoundPlatform``."""

    def impact(self, belief: MonitoringBelief, strategy: Way) -> Impact:
        """Tell nothing."""
        return MonitoringObjective().nothing(belief)

    def reply(self, belief: MonitoringBelief, others: Impact, current: Way) -> Way:
        """Go on."""
        return current

    def slack(self, belief: MonitoringBelief, base: Impact) -> float:
        """Promise nothing of what the team could gain."""
        return inf


@dataclass(eq=False)
class Monitoring(FlyingMission[MonitoringBelief, Way, Impact]):
    """One vehicle's share; ``vedette.agent.mission.FlightMission``.

    Evidence waits to be published: a round's must not change while it lasts.
    """

    vehicle: MonitoringPlatform  # its sensor as plans see it
    sensor: FieldSensor  # as it is
    team: MonitorPlan
    fusion: StepEvidence[Sparse]
    purse: Purse
    shares_plans: bool = True  # False: the team shares beliefs alone
    patrol: Callable[[Place], Way] | None = None  # a fixed one from a place; None: it plans
    strategy: Way = field(default_factory=lambda: Way(((0.0, 0.0),)))
    codec: FieldImpactCodec = field(init=False)
    working: RoundPlatform[MonitoringBelief, Way, Impact] = field(init=False)
    _elements: SparseIntegers = field(init=False)
    _filter: Refilter[FieldBelief, Sparse] = field(init=False)
    _waiting: list[tuple[int, FieldLook]] = field(default_factory=list)
    _walls: NDArray[np.bool_] | None = field(init=False)  # (R, C) where it cannot go on the ground
    _planned: bool = False  # the strategy is a way, since a round has been
    _seen: tuple[Place, float] | None = None  # where it was last, and when [s]

    def __post_init__(self) -> None:
        outlook, size = self.team.outlook, self.team.packing.size
        self.codec = FieldImpactCodec(outlook.large.count, self.team.patrol.layers)
        self.working = self.vehicle if self.shares_plans else SharedBelief(self.vehicle, self.objective)
        if self.patrol is not None:
            self.working = Pilot()
        self._walls = self.vehicle.blocked
        self._elements = SparseIntegers(size)
        self._filter = Refilter(self.fusion, self.team.prior, 0, predict=_moved, update=self._observed)

    @property
    def objective(self) -> MonitoringObjective:
        """What the team gains."""
        return OBJECTIVE

    def _observed(self, belief: FieldBelief, step: int, total: Sparse) -> FieldBelief:
        return self.team.packing.add(belief, total.index, total.value) if len(total.index) else belief

    # -- evidence -----------------------------------------------------------------------------------

    def observe(self, seen: Sensed, pose: Pose, mates: Sequence[Mate], now: float) -> None:
        """Keep a measurement until it is published, unless there is no energy left to make one with."""
        assert isinstance(seen.data, FieldLook)
        here = (pose.x, pose.y)
        if self._seen is not None:
            self.purse.gone += hypot(here[0] - self._seen[0][0], here[1] - self._seen[0][1])
        self._seen = here, now
        if self.purse.awake(now) > 0.0:
            self._waiting.append((step_of(seen.time, self.team.dt), seen.data))

    def publish(self, now: float) -> None:
        """Hand the evidence that waits to fusion."""
        waiting, self._waiting = self._waiting, []
        sensor, packing = self.sensor, self.team.packing
        for step, told in waiting:
            spots = packing.spots.of(sensor.side, np.array([told.cell]))
            places, numbers = packing.pack(spots, np.array([told.value]), np.array([sensor.variance]))
            self.fusion.publish(step, self._elements.of(places, numbers))

    @property
    def first_step(self) -> int:
        """The first step whose belief can still be had."""
        return self._filter.first

    def known(self, step: int) -> FieldBelief:
        """Return what is known of the field at a step, by all that this vehicle has published and heard."""
        return self._filter.at(max(step, self.first_step))

    # -- planning -----------------------------------------------------------------------------------

    def freeze(self, t0: float) -> MonitoringBelief:
        """Snapshot what is known, as of the first step for which all can make plans."""
        step = max(step_of(t0, self.team.dt), self.first_step)
        start = max(step, start_step(t0, self.team.lead, self.team.dt))
        known = self._filter.at(step).predict(start - step)
        outlook, patrol = self.team.outlook, self.team.patrol
        more = [
            SpotsFirst(outlook.spots_over(cells_in(area, self._frame)), f - 1.0)
            for area, f in self.priorities
        ]
        return MonitoringBelief(outlook.of(known), patrol, self.team.unit, more)

    def prepare(
        self, belief: MonitoringBelief, pose: Pose, mates: Sequence[Mate], blocked: bool, now: float
    ) -> None:
        """List the ways from where the vehicle will be, and restate the present one."""
        self.held, self.vehicle.blocked = not pose.at_work, self._blocked
        if self.held:
            self._planned = False
            return
        start, here = belief.field.step, self._inside(pose)
        present = None
        if self._planned:
            present = self.strategy.after(self.vehicle.speed * self.team.dt * (start - self.strategy.step))
        elif self.patrol is not None:
            present = self.patrol(here)
        begin, horizon = start * self.team.dt, self.team.patrol.horizon
        self.vehicle.awake = self.purse.awake(begin)
        self.vehicle.place(*here, self.purse.left(begin, horizon), present)
        if self.patrol is None:
            self.vehicle.prepare(belief)
            self.strategy = self.vehicle.ways[0]
        else:
            self.strategy = self.vehicle.restated(belief)
        self._planned = True

    def _inside(self, pose: Pose) -> Place:
        """Return the nearest place within the area: rounding may have it a hair beyond."""
        x0, x1, y0, y1 = self.team.packing.model.frame.extent
        margin = 1e-6 * self.team.packing.model.frame.resolution
        x, y = np.clip((pose.x, pose.y), (x0, y0), (x1 - margin, y1 - margin)).tolist()
        return x, y

    def reach(self, now: float) -> Reach | None:
        """Return the box that its gains depend on in a round frozen within ``lead`` of now."""
        if self._seen is None:
            return None
        (x, y), then = self._seen
        seconds = now - then + self.team.lead + self.team.dt + self.team.patrol.horizon
        return box_around(x, y, within(self.vehicle, self.team.outlook.model, seconds))

    def admit(self, belief: MonitoringBelief, impact: Impact, robots: int) -> None:
        """Refuse more than so many of the team's best sensors measure."""
        steps = round(self.team.patrol.horizon / self.team.dt)
        check_claim(impact, robots * steps * self.team.most, robots)

    # -- orders -------------------------------------------------------------------------------------

    @property
    def _blocked(self) -> NDArray[np.bool_] | None:
        """(R, C) Where it must not go: on the ground walls, and what is forbidden, with a cell around it."""
        if not self.forbidden:
            return self._walls
        closed = Leave(no_go=self.forbidden.areas).forbidden(self.vehicle.ground or self._frame)
        return closed if self._walls is None else closed | self._walls

    def stand_by(self) -> None:
        """Leave the present way: orders keep the vehicle from it."""
        self._planned = False

    def route(self, here: Place, there: Place, room: float) -> list[Place]:
        """Return the corners of a way round what it must not enter; none: there is no way."""
        frame, blocked = self._frame, self._blocked
        if not frame.contains(*there):
            return []
        if blocked is None:
            return [here, there]
        way = around(Way((here, there)), frame, blocked)
        return list(way.places) if way.places[-1] == there else []

    def passes(self, places: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Tell at which places (..., 2) there is ground, and no wall."""
        row, col = cells_of(self._frame, places.reshape(-1, 2))
        rows, cols = self._frame.shape
        inside = (row >= 0) & (row < rows) & (col >= 0) & (col < cols)
        if self._walls is not None:
            inside[inside] = ~self._walls[row[inside], col[inside]]
        return inside.reshape(places.shape[:-1])

    @property
    def _frame(self) -> GridFrame:
        return self.team.packing.model.frame

    # -- moving -------------------------------------------------------------------------------------

    def start(self, belief: MonitoringBelief) -> float:
        """Return when ways planned on this belief begin [s]."""
        return belief.field.step * belief.field.dt

    def plan(self) -> MovePlan | None:
        """Return the way decided on, as velocities; None before the first round."""
        if not self._planned:
            return None
        dt, steps = self.team.dt, round(self.team.patrol.horizon / self.team.dt)
        places = self.strategy.at(self.vehicle.speed * dt * np.arange(steps + 1.0, dtype=np.float64))
        velocities: NDArray[np.float64] = np.diff(places, axis=0) / dt
        return MovePlan(self.strategy.step * dt, dt, velocities)


def _moved(belief: FieldBelief, step: int) -> FieldBelief:
    return belief.predict()

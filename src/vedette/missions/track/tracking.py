"""Tracking as a mission: the domain of Gaussian tracks and a way to fuse them, put together for the agent."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from vedette.agent.events import Pose, Sensed
from vedette.agent.flight import FlightPlan, start_step, step_of
from vedette.agent.mates import Mate
from vedette.agent.mission import RoundPlatform
from vedette.domains.tracking.belief import Tracks
from vedette.domains.tracking.codec import TrackImpactCodec
from vedette.domains.tracking.courses import Course
from vedette.domains.tracking.filter import predict
from vedette.domains.tracking.impact import Impact, check_claim
from vedette.domains.tracking.models import TargetModel
from vedette.domains.tracking.objective import TrackingObjective
from vedette.domains.tracking.platform import TrackingPlatform
from vedette.domains.tracking.sensing import evidence
from vedette.fusion.gaussian import Information, TrackFusion
from vedette.missions.flying import FlyingMission, SharedBelief, box_around
from vedette.problem import Reach


@dataclass(frozen=True)
class TrackPlan:
    """What a team plans: the targets' models, the steps, and when plans can start."""

    models: tuple[TargetModel, ...]
    dt: float  # step [s]
    horizon: int  # [steps]
    lead: float  # from freezing a round to the start of its plans, at least [s]
    origin: tuple[float, float] = (0.0, 0.0)  # of the tracks' numbers, team frame [m]
    layers: tuple[float, ...] = ()  # ends of the tail's layers, after the horizon [s]

    def step(self, time: float) -> int:
        """Return the step that a time [s] lies in; step k begins at ``k dt``."""
        return step_of(time, self.dt)


class LookBounds(NamedTuple):
    """Largest numbers that anybody's likelihood may hold: fixed-point fusion takes no larger ones."""

    matrix: float  # [1/m^2]
    vector: float


@dataclass(eq=False)
class Tracking(FlyingMission[Tracks, Course, Impact]):
    """One vehicle's share of tracking; ``vedette.agent.mission.FlightMission``.

    Measurements are linearised as they come, about the vehicle's own estimate, and wait to be published: a
    round's evidence must not change while it lasts.
    """

    vehicle: TrackingPlatform
    team: TrackPlan
    fusion: TrackFusion
    bounds: LookBounds
    tells_plans: bool = True  # False: the team shares beliefs alone
    strategy: Course = field(default_factory=lambda: Course(0, ()))
    skipped: int = 0  # measurements whose likelihood exceeded the bounds
    seen: tuple[int, ...] = ()  # targets, by the latest look
    codec: TrackImpactCodec = field(init=False)
    working: RoundPlatform[Tracks, Course, Impact] = field(init=False)
    _waiting: list[tuple[int, Information]] = field(default_factory=list)  # step, likelihood
    _seen_at: tuple[float, float, float] | None = None  # x, y [m], time [s] of the last pose

    def __post_init__(self) -> None:
        self.codec = TrackImpactCodec(len(self.team.models), self.team.horizon + len(self.team.layers))
        self.working = self.vehicle if self.tells_plans else SharedBelief(self.vehicle, self.objective)

    @property
    def objective(self) -> TrackingObjective:
        """What the team gains."""
        return self.vehicle.objective

    # -- evidence -----------------------------------------------------------------------------------

    def observe(self, seen: Sensed, pose: Pose, mates: Sequence[Mate], now: float) -> None:
        """``I = H' R^-1 H``, ``i = H' R^-1 (z - h(x) + H x)`` of each target seen; paper, eqs. (20), (21)."""
        assert isinstance(seen.data, Mapping)
        self._seen_at = pose.x, pose.y, now
        self.seen = tuple(seen.data)
        if not seen.data:
            return
        step, known = self.team.step(seen.time), self.tracks()
        known = predict(known, max(0, step - known.k0))
        at = np.array((pose.x, pose.y, pose.heading))
        sensor, stride = self.vehicle.sensor, self.vehicle.speed * self.team.dt
        matrix, vector = evidence(sensor, at, seen.data, known.means, known.covariances, stride, known.origin)
        fits = (np.abs(matrix) <= self.bounds.matrix).all(axis=(1, 2))
        fits &= (np.abs(vector) <= self.bounds.vector).all(axis=1)
        self.skipped += int(np.count_nonzero(~fits))
        matrix[~fits], vector[~fits] = 0.0, 0.0
        self._waiting.append((step, Information(matrix, vector)))

    def publish(self, now: float) -> None:
        """Hand the likelihoods that wait to fusion."""
        waiting, self._waiting = self._waiting, []
        for step, likelihood in waiting:
            self.fusion.observe(step, likelihood)

    def tracks(self) -> Tracks:
        """Return the team's tracks as this vehicle knows them, at the step that fusion has come to."""
        step, estimate = self.fusion.estimate()
        team = self.team
        matrix, vector = estimate.matrix, estimate.vector
        return Tracks(step, team.dt, team.horizon, team.models, matrix, vector, team.origin, team.layers)

    # -- planning -----------------------------------------------------------------------------------

    def freeze(self, t0: float) -> Tracks:
        """Predict the team's tracks to the first step that everybody can still plan for.

        Fusion does not go on past evidence that waits: some ways could no longer take it in.
        """
        self.fusion.advance(min([self.team.step(t0), *(step for step, _ in self._waiting)]))
        known = self.tracks()
        known = predict(known, max(0, start_step(t0, self.team.lead, self.team.dt) - known.k0))
        return replace(known, weights=self._weights(known)) if self.priorities else known

    def _weights(self, known: Tracks) -> tuple[float, ...]:
        """(T,) ``w_t = prod_a f_a`` over the priority areas a in which a target is expected; (V166)."""
        weights = np.ones(len(known))
        for area, factor in self.priorities:
            weights[area.distance(known.means[:, :2]) <= 0.0] *= factor
        return tuple(weights.tolist())

    def prepare(self, belief: Tracks, pose: Pose, mates: Sequence[Mate], blocked: bool, now: float) -> None:
        """List the courses from where the vehicle will be, and restate the present one."""
        self.held, self.vehicle.forbidden = not pose.at_work, self.forbidden
        if self.held:
            return
        self.vehicle.place(pose.x, pose.y, pose.heading, self.strategy)
        self.vehicle.prepare(belief)
        self.strategy = self.vehicle.kept_out(belief, self.vehicle.carry_over(belief, self.strategy))

    def reach(self, now: float) -> Reach | None:
        """Return the box that it can see into by the end of plans frozen within ``lead`` of now.

        From the last pose observed: at full speed until the plans start, one step of rounding up included,
        through the horizon and the tail. docs/theory.md (V14)
        """
        if self._seen_at is None:
            return None
        x, y, then = self._seen_at
        team = self.team
        ahead = (team.horizon + 1) * team.dt + sum(team.layers[-1:])
        flown = self.vehicle.speed * (now - then + 2.0 * team.lead + ahead)
        return box_around(x, y, flown + self.vehicle.sensor.range)

    def admit(self, belief: Tracks, impact: Impact, robots: int) -> None:
        """Refuse more information than so many of the team's best sensors have."""
        check_claim(impact, robots, self.bounds.matrix)

    # -- flying -------------------------------------------------------------------------------------

    def stand_by(self) -> None:
        """Leave the present course: orders keep the vehicle from it."""
        self.strategy = Course(0, ())

    def start(self, belief: Tracks) -> float:
        """Return when courses planned on this belief start [s]."""
        return belief.k0 * self.team.dt

    def plan(self) -> FlightPlan | None:
        """Return the present course; None before the first round."""
        if not self.strategy.rates:
            return None
        return FlightPlan(self.strategy.k0 * self.team.dt, self.team.dt, np.array(self.strategy.rates))

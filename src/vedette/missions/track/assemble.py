"""A tracking vehicle's agent, put together: the tracking domain, a way of fusing, flight."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

from vedette.agent import Agent, FlightBehaviour, Pace
from vedette.agent.terms import Terms, flat
from vedette.domains.tracking.belief import Tracks
from vedette.domains.tracking.objective import OBJECTIVES, TrackingObjective, objective
from vedette.domains.tracking.platform import TrackingPlatform
from vedette.domains.tracking.sensing import Sensor
from vedette.errors import InputError
from vedette.fusion.gaussian import Information, TrackMotion, track_fusion
from vedette.fusion.seals import Notary
from vedette.missions.flying import RoundTimes
from vedette.missions.sense import Grounds
from vedette.missions.track.options import TrackOptions
from vedette.missions.track.scenario import TrackScenario
from vedette.missions.track.tracking import LookBounds, Tracking, TrackPlan
from vedette.number import many

_EXTENT = 10.0  # evidence holds up to so many times the area's longer side from its corner


@dataclass(frozen=True, eq=False)
class TrackTeam:
    """What all vehicles of a team know beforehand."""

    scenario: TrackScenario
    options: TrackOptions
    times: RoundTimes

    def __post_init__(self) -> None:
        """Raise InputError where plans would be over before they can be replaced."""
        span = self.scenario.horizon * self.scenario.step
        if self.lead >= span:
            raise InputError(
                f"a round of {many(self.size, 'vehicle')} takes {self.lead:.1f} s with a link delay of "
                f"{self.times.link_delay:g} s, but a plan lasts {span:g} s; set a longer horizon or step"
            )

    @property
    def size(self) -> int:
        """How many vehicles plan together: without coordination each is a team of one."""
        return 1 if self.options.coordination == "none" else len(self.scenario.vehicles)

    @property
    def terms(self) -> Terms:
        """What all of the team have to agree on."""
        options = self.options
        return {
            "mission": "track",
            "coordination": options.coordination,
            "scheme": options.negotiates_by,
            "fusion": options.fusion,
            "objective": options.objective or self.scenario.objective,
            **dict(flat("scenario", self.scenario)),
        }

    @property
    def lead(self) -> float:
        """From freezing a round to the start of its plans, at least [s]."""
        return self.times.lead(self.size, self.options.negotiates_by)

    @cached_property
    def objective(self) -> TrackingObjective:
        """What the team gains; InputError if it is unknown."""
        return objective(self.options.objective or self.scenario.objective)

    @cached_property
    def sensors(self) -> list[Sensor]:
        """By vehicle."""
        return self.scenario.sensors

    @cached_property
    def prior(self) -> Tracks:
        """The targets as they are known at step 0."""
        prior = self.scenario.prior()
        metres = self.objective.measure == "final-trace"  # which the tail's nats cannot be added to
        return prior if metres else replace(prior, layers=self.scenario.layers)

    @cached_property
    def bounds(self) -> LookBounds:
        """On everybody's likelihoods; the same for the whole team, which fusion sums exactly."""
        x0, y0, x1, y1 = self.scenario.area
        extent = _EXTENT * max(x1 - x0, y1 - y0)
        each = [sensor.most_evidence(extent) for sensor in self.sensors]
        return LookBounds(max(matrix for matrix, _ in each), max(vector for _, vector in each))

    @property
    def grounds(self) -> Grounds:
        """What orders can be about."""
        own = (self.options.objective or self.scenario.objective) not in OBJECTIVES
        return Grounds(
            len(self.scenario.vehicles),
            self.scenario.area,
            "trackers weigh targets, not places: give one robot, or a priority area",
            "an objective of somebody's own weighs nothing; leave it out" if own else "",
        )

    def assemble(self, robot: int, boot: int, notary: Notary | None = None) -> Agent:
        """Return a fresh agent for a vehicle, by its number from 0; InputError if the fusion is unknown.

        ``notary``: signs its evidence, if that is replicated, and checks everybody's; None: nobody does.
        """
        scenario, vehicle = self.scenario, self.scenario.vehicles[robot]
        behaviour = FlightBehaviour(self._mission(robot, boot, notary), vehicle.speed, vehicle.turn_rate)
        pace = Pace.each(scenario.step)
        return Agent(robot, boot, vehicle, behaviour, self.options.negotiates_by, pace, forks=True)

    def _mission(self, robot: int, boot: int, notary: Notary | None) -> Tracking:
        scenario, prior, vehicle = self.scenario, self.prior, self.scenario.vehicles[robot]
        platform = TrackingPlatform(
            vehicle.speed,
            vehicle.turn_rate,
            self.sensors[robot],
            self.objective,
            decisions=scenario.decisions,
            continuous=self.options.continuous,
        )
        fusion = track_fusion(
            self.options.fusion,
            robot,
            boot,
            Information(prior.Y, prior.y),
            TrackMotion(prior.motion.transitions, prior.motion.noises),
            0,
            most_matrix=self.bounds.matrix,
            most_vector=self.bounds.vector,
            notary=notary,
        )
        plan = TrackPlan(prior.models, prior.dt, prior.horizon, self.lead, prior.origin, prior.layers)
        return Tracking(platform, plan, fusion, self.bounds, self.options.coordination != "shared")

"""Tracking put together for the simulator: targets, vehicles with sensors, and an agent for each."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import cast

import numpy as np

from vedette.agent import Agent, FlightBehaviour, Pace
from vedette.domains.tracking.belief import Tracks
from vedette.domains.tracking.objective import objective
from vedette.domains.tracking.platform import TrackingPlatform
from vedette.domains.tracking.sensing import Sensor
from vedette.errors import InputError
from vedette.fusion.gaussian import Information, Motion, track_fusion
from vedette.missions.track.scenario import TrackScenario
from vedette.missions.track.tracking import Bounds, Plan, SharedBeliefTracking, Tracking
from vedette.outcome import Outcome
from vedette.sim.flights import FlightSetup, lead
from vedette.sim.simulation import Simulation, random_streams
from vedette.sim.track.oracle import MOST_JOINT, DictatedTracking, Oracle, joint_choices
from vedette.sim.track.targets import Targets
from vedette.sim.vehicles import Vehicles

COORDINATIONS = ("none", "shared", "negotiated", "optimum")
_EXTENT = 10.0  # evidence holds up to so many times the area's farthest corner from the origin


@dataclass(frozen=True)
class TrackSetup(FlightSetup):
    """What to simulate, beside the scenario."""

    fusion: str = "replicated"
    objective: str | None = None  # None: the scenario's
    continuous: bool = False


class TrackSimulation(Simulation):
    """A team of vehicles that follow targets; ``run`` lets it."""

    setup: TrackSetup

    def __init__(self, scenario: TrackScenario, setup: TrackSetup) -> None:
        """Put vehicles and targets at their starts.

        Raises:
            InputError: an unknown objective or fusion, or too many joint choices for the optimum.
        """
        self.scenario, self.names = scenario, scenario.vehicle_names
        self.objective = objective(setup.objective or scenario.objective)
        self.sensors, self.prior = scenario.sensors, scenario.prior()
        if setup.coordination == "optimum":
            check_optimum(scenario, setup)
        self._oracle = Oracle()
        rng = np.random.default_rng([setup.seed, 2])
        start = scenario.draw(rng)
        streams = random_streams(setup.seed, len(self.names))
        self.targets = Targets(self.prior.models, start, self.sensors, scenario.step, rng, streams[:-1])
        self.vehicles = Vehicles(
            [vehicle.pose for vehicle in scenario.vehicles],
            [vehicle.speed for vehicle in scenario.vehicles],
            [vehicle.turn_rate for vehicle in scenario.vehicles],
            scenario.step,
            self.targets.look,
            self._over_at_the_end,
        )
        super().__init__(partial(self._tracker, setup), self.vehicles, setup)
        self._oracle.missions = self.missions

    @property
    def missions(self) -> list[Tracking]:
        """Everybody's share of the mission, by index."""
        return [cast(Tracking, agent.mission) for agent in self.network.agents]

    def _tracker(self, setup: TrackSetup, robot: int, boot: int) -> Agent:
        vehicle = self.scenario.vehicles[robot]
        behaviour = FlightBehaviour(self._mission(robot, boot, setup), vehicle.speed, vehicle.turn_rate)
        return Agent(robot, boot, vehicle, behaviour, setup.scheme, Pace.each(self.scenario.step))

    def _over_at_the_end(self, now: float) -> Outcome | None:
        return Outcome.COMPLETE if now >= self.scenario.duration - 1e-9 else None

    def _mission(self, i: int, boot: int, setup: TrackSetup) -> Tracking:
        scenario, prior = self.scenario, self.prior
        body = scenario.vehicles[i]
        vehicle = TrackingPlatform(
            body.speed,
            body.turn_rate,
            self.sensors[i],
            self.objective,
            decisions=scenario.decisions,
            continuous=setup.continuous,
        )
        bounds = most_evidence(self.sensors, scenario)
        fusion = track_fusion(
            setup.fusion,
            i,
            boot,
            Information(prior.Y, prior.y),
            motion_of(prior),
            0,
            most_matrix=bounds.matrix,
            most_vector=bounds.vector,
        )
        team = setup.team(len(scenario.vehicles))
        plan = Plan(prior.models, prior.dt, prior.horizon, self._lead(team, setup.link_delay))
        match setup.coordination:
            case "shared":
                return SharedBeliefTracking(vehicle, plan, fusion, bounds)
            case "optimum":
                dictated = DictatedTracking(vehicle, plan, fusion, bounds)
                dictated.oracle = self._oracle
                return dictated
            case _:
                return Tracking(vehicle, plan, fusion, bounds)

    def _lead(self, team: int, delay: float) -> float:
        """Return the lead of plans; InputError where plans would be over before they can be replaced."""
        time, span = lead(team, delay), self.scenario.horizon * self.scenario.step
        if time >= span:
            raise InputError(
                f"a round of {team} vehicles takes {time:.1f} s with a link delay of {delay:g} s, but a plan "
                f"lasts {span:g} s; set a longer horizon or step"
            )
        return time


def check_optimum(scenario: TrackScenario, setup: TrackSetup) -> None:
    """Raise InputError where the best joint choice cannot be had by trying everything."""
    if setup.continuous:
        raise InputError("the optimum is found by trying everything: leave out --continuous")
    joint = joint_choices(scenario.decisions, scenario.horizon, len(scenario.vehicles))
    if joint > MOST_JOINT:
        raise InputError(
            f"the optimum would try {joint} joint choices a round, at most {MOST_JOINT} are feasible; "
            "set fewer decisions in the scenario, or fewer vehicles"
        )


def motion_of(prior: Tracks) -> Motion:
    """Return the targets' motion as fusion takes it."""
    return Motion(prior.motion.transitions, prior.motion.noises)


def most_evidence(sensors: list[Sensor], scenario: TrackScenario) -> Bounds:
    """Return bounds on everybody's likelihoods; the same for the whole team, which fusion sums exactly."""
    extent = _EXTENT * max(1.0, *map(abs, scenario.area))
    each = [sensor.most_evidence(extent) for sensor in sensors]
    return Bounds(max(matrix for matrix, _ in each), max(vector for _, vector in each))

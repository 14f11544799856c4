"""Tracking put together for the simulator: targets, vehicles with sensors, and an agent for each."""

from __future__ import annotations

from dataclasses import dataclass
from typing import cast

from vedette.agent import Agent
from vedette.domains.tracking.platform import MOST_OTHERS
from vedette.errors import InputError, check_word
from vedette.missions.track.assemble import TrackTeam
from vedette.missions.track.options import COORDINATIONS, TrackOptions
from vedette.missions.track.scenario import TrackScenario
from vedette.missions.track.tracking import Tracking
from vedette.outcome import Outcome
from vedette.sim.flights import FlightSetup
from vedette.sim.simulation import Simulation
from vedette.sim.track.oracle import MOST_JOINT, Dictated, Oracle, joint_choices
from vedette.sim.track.targets import Targets, trackers


@dataclass(frozen=True)
class TrackSetup(FlightSetup):
    """What to simulate, beside the scenario."""

    fusion: str = "replicated"
    objective: str | None = None  # None: the scenario's
    continuous: bool = False

    def __post_init__(self) -> None:
        super().__post_init__()
        check_word("coordination", self.coordination, COORDINATIONS)

    @property
    def options(self) -> TrackOptions:
        """How the team tracks."""
        return TrackOptions(self.coordination, self.scheme, self.fusion, self.objective, self.continuous)


class TrackSimulation(Simulation):
    """A team of vehicles that follow targets; ``run`` lets it."""

    setup: TrackSetup

    def __init__(self, scenario: TrackScenario, setup: TrackSetup) -> None:
        """Put vehicles and targets at their starts.

        Raises:
            InputError: an unknown objective or fusion, or too many joint choices for the optimum.
        """
        self.scenario, self.names = scenario, scenario.vehicle_names
        self.team = TrackTeam(scenario, setup.options, setup.times)
        self.objective, self.sensors, self.prior = self.team.objective, self.team.sensors, self.team.prior
        if setup.coordination == "optimum":
            check_optimum(scenario, setup)
        self._oracle = Oracle()
        self.targets = Targets.of(self.team, setup.seed)
        self.vehicles = trackers(scenario, self.targets, self._over_at_the_end)
        super().__init__(self._tracker, self.vehicles, setup)
        self._oracle.vehicles = [mission.vehicle for mission in self.missions]

    @property
    def missions(self) -> list[Tracking]:
        """Everybody's share of the mission, by index."""
        return [cast(Tracking, agent.mission) for agent in self.network.agents]

    def _tracker(self, robot: int, boot: int) -> Agent:
        agent = self.team.assemble(robot, boot)
        if self.team.options.coordination == "optimum":
            mission = cast(Tracking, agent.mission)
            mission.working = Dictated(mission.vehicle, self._oracle)
        return agent

    def _over_at_the_end(self, now: float) -> Outcome | None:
        return Outcome.COMPLETE if now >= self.scenario.duration - 1e-9 else None


def check_optimum(scenario: TrackScenario, setup: TrackSetup) -> None:
    """Raise InputError where the best joint choice cannot be had by trying everything."""
    if setup.continuous:
        raise InputError("the optimum is found by trying everything: leave out --continuous")
    others = min(MOST_OTHERS, len(scenario.targets) - 1) if scenario.layers else 0
    joint = joint_choices(scenario.decisions, scenario.horizon, len(scenario.vehicles), others)
    if joint > MOST_JOINT:
        raise InputError(
            f"the optimum would try {joint} joint choices a round, at most {MOST_JOINT} are feasible; "
            "set fewer decisions in the scenario, or fewer vehicles"
        )

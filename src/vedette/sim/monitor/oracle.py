"""The optimum of every round, found by trying everything: what nobody in the team could work out."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import inf

from vedette.agent import Agent
from vedette.domains.monitoring.case import MonitorCase
from vedette.domains.monitoring.impact import Impact
from vedette.domains.monitoring.objective import MonitoringBelief
from vedette.domains.monitoring.platform import MonitoringPlatform
from vedette.domains.monitoring.ways import Way
from vedette.errors import InputError
from vedette.missions.monitor.assemble import MonitorTeam
from vedette.missions.monitor.monitoring import Monitoring
from vedette.problem import exhaustive

MOST_JOINT = 5_000  # joint choices tried a round: a second or less


def check_optimum(case: MonitorCase) -> None:
    """Raise InputError where the best joint choice cannot be had by trying everything."""
    vehicles, bearings = len(case.scenario.vehicles), case.scenario.bearings
    joint = (bearings**2 + 2) ** vehicles
    if joint > MOST_JOINT:
        raise InputError(
            f"the optimum would try {joint} joint choices a round, at most {MOST_JOINT} are feasible; set "
            "fewer bearings in the scenario, or fewer vehicles"
        )


@dataclass(eq=False)
class FieldOracle:
    """Looks into all vehicles at once and tries every joint choice, once a round."""

    vehicles: dict[int, MonitoringPlatform] = field(default_factory=dict)  # by number
    _round: tuple[int, dict[MonitoringPlatform, Way]] = (-1, {})

    def assemble(self, team: MonitorTeam, robot: int, boot: int) -> Agent:
        """Return an agent whose robot does what the oracle says."""
        agent = team.assemble(robot, boot)
        assert isinstance(agent.mission, Monitoring)
        self.vehicles[robot] = agent.mission.vehicle
        agent.mission.working = FieldDictated(agent.mission.vehicle, self)
        return agent

    def way(self, vehicle: MonitoringPlatform, belief: MonitoringBelief, current: Way) -> Way:
        """Return a vehicle's part of the best joint choice on the belief."""
        if self._round[0] != belief.field.step or vehicle not in self._round[1]:
            self._round = belief.field.step, self._best(belief)
        return self._round[1].get(vehicle, current)

    def _best(self, belief: MonitoringBelief) -> dict[MonitoringPlatform, Way]:
        step = belief.field.step
        team = [each for each in self.vehicles.values() if each.ways and each.ways[0].step == step]
        best = exhaustive(team[0].objective, belief, [each.candidates for each in team])
        return {each: each.ways[k] for each, k in zip(team, best.choice, strict=True)}


@dataclass(frozen=True, eq=False)
class FieldDictated:
    """A vehicle that does what the oracle says; ``vedette.agent.mission.RoundPlatform``."""

    vehicle: MonitoringPlatform
    oracle: FieldOracle

    def impact(self, belief: MonitoringBelief, strategy: Way) -> Impact:
        """Return the information that a way would bring."""
        return self.vehicle.impact(belief, strategy)

    def reply(self, belief: MonitoringBelief, others: Impact, current: Way) -> Way:
        """Return this vehicle's part of the best joint choice."""
        return self.oracle.way(self.vehicle, belief, current)

    def slack(self, belief: MonitoringBelief, base: Impact) -> float:
        """Promise nothing: replies are not this vehicle's own."""
        return inf

"""Searching put together for the simulator: a hidden target, vehicles with sensors, and an agent for each."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from math import ceil, floor
from typing import cast

import numpy as np

from vedette.agent import Agent, FlightBehaviour, Pace
from vedette.errors import InputError
from vedette.fusion.steps import ReplicatedSteps, Sparse, SparseIntegers, StepEvidence, StepSums
from vedette.missions.search.case import SearchCase
from vedette.missions.search.searching import Declared, Searching, SearchPlan, SharedBeliefSearching
from vedette.outcome import Outcome
from vedette.sim.flights import FlightSetup, lead
from vedette.sim.search.hidden import Hidden, Searchers
from vedette.sim.simulation import Simulation, random_streams
from vedette.team import Most

COORDINATIONS = ("none", "shared", "negotiated")
FUSIONS = ("replicated", "sums")
_WINDOW = 30.0  # steps stay open for late evidence, with sums [s]


@dataclass(frozen=True)
class SearchSetup(FlightSetup):
    """What to simulate, beside the scenario."""

    fusion: str = "replicated"
    blind: bool = False  # nobody ever reports anything: the run that plans are made for


class SearchSimulation(Simulation):
    """A team of vehicles that look for a target; ``run`` lets it, until one declares it found."""

    setup: SearchSetup

    def __init__(self, case: SearchCase, setup: SearchSetup) -> None:
        """Put the vehicles at their starts and the target somewhere.

        Raises:
            InputError: rounds take longer over these links than plans reach ahead.
        """
        self.case, self.names = case, case.names
        self.plan = self._plan(case, setup)
        vehicles, step = case.scenario.vehicles, case.scenario.step
        streams = random_streams(setup.seed, len(self.names))
        rng = np.random.default_rng([setup.seed, 3])
        self.hidden = Hidden(case.pdf, case.scenario.target.start, case.detectors, rng, streams[:-1])
        self.vehicles = Searchers(
            [vehicle.pose for vehicle in vehicles],
            [vehicle.speed for vehicle in vehicles],
            [vehicle.turn_rate for vehicle in vehicles],
            step,
            [case.looks(i) for i in range(len(vehicles))],
            None if setup.blind else self.hidden,
            lambda now: None if self.declared is None else Outcome.COMPLETE,
        )
        super().__init__(partial(self._searcher, setup), self.vehicles, setup)

    @property
    def missions(self) -> list[Searching]:
        """Everybody's share of the mission, by index."""
        return [cast(Searching, agent.mission) for agent in self.network.agents]

    def _searcher(self, setup: SearchSetup, robot: int, boot: int) -> Agent:
        vehicle, scenario = self.case.scenario.vehicles[robot], self.case.scenario
        behaviour = FlightBehaviour(self._mission(robot, boot, setup), vehicle.speed, vehicle.turn_rate)
        pace = Pace.each(scenario.replan * scenario.step)
        return Agent(robot, boot, vehicle, behaviour, setup.scheme, pace)

    @property
    def steps(self) -> int:
        """Number of whole steps that the search may take."""
        return floor(self.setup.max_time / self.case.scenario.step + 1e-6)

    @property
    def declared(self) -> tuple[int, Declared] | None:
        """Who declared the target found, and where; a detection goes before a belief."""
        told = [
            (i, mission.declared) for i, mission in enumerate(self.missions) if mission.declared is not None
        ]
        return min(told, key=lambda each: (not each[1].certain, each[1].time, each[0]), default=None)

    def _plan(self, case: SearchCase, setup: SearchSetup) -> SearchPlan:
        scenario = case.scenario
        team = setup.team(len(scenario.vehicles))
        ahead = lead(team, setup.link_delay)
        taken = ceil(ahead / scenario.step) + 1
        if taken >= scenario.horizon:
            raise InputError(
                f"horizon: a round of {team} vehicles takes {ahead:.1f} s where links delay by "
                f"{setup.link_delay:g} s; plan more than {taken} steps of {scenario.step:g} s"
            )
        declare = scenario.declare
        most = Most(
            max(detector.range for detector in case.detectors), max(each.speed for each in scenario.vehicles)
        )
        return SearchPlan(case.pdf, scenario.weights, ahead, declare.probability, declare.radius, most)

    def _mission(self, i: int, boot: int, setup: SearchSetup) -> Searching:
        kind = SharedBeliefSearching if setup.coordination == "shared" else Searching
        return kind(self.case.platform(i), self.plan, self._fusion(i, boot, setup.fusion))

    def _fusion(self, i: int, boot: int, name: str) -> StepEvidence[Sparse]:
        elements = SparseIntegers(self.case.pdf.frame.size)
        if name == "sums":
            return StepSums(i, boot, elements, window=ceil(_WINDOW / self.case.scenario.step))
        return ReplicatedSteps(i, boot, elements)

"""A searching vehicle's agent, put together: the search domain, step evidence, flight."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import ceil

from vedette.agent import Agent, FlightBehaviour, Pace
from vedette.agent.terms import Terms, flat
from vedette.errors import InputError
from vedette.fusion.seals import Notary
from vedette.fusion.steps import Sparse, SparseIntegers, StepEvidence, StepSums, replicated_steps
from vedette.missions.flying import RoundTimes
from vedette.missions.search.case import SearchCase
from vedette.missions.search.options import SearchOptions
from vedette.missions.search.searching import Searching, SearchPlan
from vedette.number import many
from vedette.team import Most

_WINDOW = 30.0  # steps stay open for late evidence, with sums [s]


@dataclass(frozen=True, eq=False)
class SearchTeam:
    """What all vehicles of a team know beforehand."""

    case: SearchCase
    options: SearchOptions
    times: RoundTimes

    def __post_init__(self) -> None:
        """Raise InputError where rounds take longer than plans reach ahead."""
        scenario = self.case.scenario
        taken = ceil(self.lead / scenario.step) + 1
        if taken >= scenario.horizon:
            raise InputError(
                f"horizon: a round of {many(self.size, 'vehicle')} takes {self.lead:.1f} s where links delay "
                f"by {self.times.link_delay:g} s; plan more than {many(taken, 'step')} of {scenario.step:g} s"
            )

    @property
    def size(self) -> int:
        """How many vehicles plan together: without coordination each is a team of one."""
        return 1 if self.options.coordination == "none" else len(self.case.names)

    @property
    def terms(self) -> Terms:
        """What all of the team have to agree on."""
        options = self.options
        return {
            "mission": "search",
            "coordination": options.coordination,
            "scheme": options.negotiates_by,
            "fusion": options.fusion,
            **dict(flat("scenario", self.case.scenario)),
        }

    @property
    def lead(self) -> float:
        """From freezing a round to the start of its plans, at least [s]."""
        return self.times.lead(self.size)

    @cached_property
    def plan(self) -> SearchPlan:
        """What they have agreed on."""
        case, scenario, declare = self.case, self.case.scenario, self.case.scenario.declare
        most = Most(
            max(detector.range for detector in case.detectors), max(each.speed for each in scenario.vehicles)
        )
        return SearchPlan(case.pdf, scenario.weights, self.lead, declare.probability, declare.radius, most)

    def assemble(self, robot: int, boot: int, notary: Notary | None = None) -> Agent:
        """Return a fresh agent for a vehicle, by its number from 0.

        ``notary``: signs its evidence, if that is replicated, and checks everybody's; None: nobody does.
        """
        vehicle, scenario = self.case.scenario.vehicles[robot], self.case.scenario
        tells_plans = self.options.coordination != "shared"
        fusion = self._fusion(robot, boot, notary)
        mission = Searching(self.case.platform(robot), self.plan, fusion, tells_plans)
        behaviour = FlightBehaviour(mission, vehicle.speed, vehicle.turn_rate)
        pace = Pace.each(scenario.replan * scenario.step)
        return Agent(robot, boot, vehicle, behaviour, self.options.negotiates_by, pace, forks=True)

    def _fusion(self, robot: int, boot: int, notary: Notary | None) -> StepEvidence[Sparse]:
        elements = SparseIntegers(self.case.pdf.frame.size)
        if self.options.fusion == "sums":
            return StepSums(robot, boot, elements, window=ceil(_WINDOW / self.case.scenario.step))
        return replicated_steps(robot, boot, elements, notary)

"""A searching vehicle's mission, put together: the search domain and step evidence."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from vedette.fusion.seals import Notary
from vedette.missions.flights import FlightTeam
from vedette.missions.search.case import SearchCase
from vedette.missions.search.searching import Searching, SearchPlan
from vedette.missions.sense import Grounds
from vedette.team import Most


@dataclass(frozen=True, eq=False)
class SearchTeam(FlightTeam[SearchCase]):
    """What all vehicles of a team know beforehand."""

    domain = "search"

    @cached_property
    def plan(self) -> SearchPlan:
        """What they have agreed on."""
        case, scenario, declare = self.case, self.case.scenario, self.case.scenario.declare
        most = Most(
            max(detector.range for detector in case.detectors), max(each.speed for each in scenario.vehicles)
        )
        return SearchPlan(case.pdf, scenario.weights, self.lead, declare.probability, declare.radius, most)

    @property
    def grounds(self) -> Grounds:
        """What orders can be about."""
        x0, x1, y0, y1 = self.case.pdf.frame.extent
        return Grounds(len(self.case.names), (x0, y0, x1, y1))

    def mission(self, robot: int, boot: int, notary: Notary | None) -> Searching:
        """Return a vehicle's share, by its number from 0."""
        evidence = self.evidence(robot, boot, notary, self.case.pdf.frame.size)
        tells_plans = self.options.coordination != "shared"
        return Searching(self.case.platform(robot), self.plan, evidence, tells_plans)

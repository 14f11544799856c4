"""The vehicles of an own domain, put together."""

from __future__ import annotations

from dataclasses import dataclass

from vedette.agent.terms import Terms
from vedette.fusion.seals import Notary
from vedette.missions.flights import FlightTeam
from vedette.missions.own.case import OwnCase
from vedette.missions.own.mission import OwnMission
from vedette.missions.sense import Grounds


@dataclass(frozen=True, eq=False)
class OwnTeam(FlightTeam[OwnCase]):
    """What all vehicles of a team know beforehand."""

    name: str = ""  # of the domain

    @property
    def domain(self) -> str:
        """By name."""
        return self.name

    @property
    def grounds(self) -> Grounds:
        """What orders can be about."""
        why = "nobody knows what is worth more in a domain of somebody's own; leave it out"
        return Grounds(len(self.case.names), self.case.scenario.area, why, why)

    @property
    def terms(self) -> Terms:
        """What all of the team have to agree on: the evidence's length beside the scenario."""
        return {**super().terms, "evidence": str(self.case.theory.size)}

    def mission(self, robot: int, boot: int, notary: Notary | None) -> OwnMission:
        """Return a vehicle's share, by its number from 0."""
        evidence = self.evidence(robot, boot, notary, self.case.theory.size)
        return OwnMission(self.case, robot, self.lead, evidence, self.options.coordination != "shared")

"""The vehicles of an own domain, put together."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil

from vedette.agent.terms import Terms
from vedette.errors import InputError
from vedette.fusion.seals import Notary
from vedette.fusion.steps import Sparse, SparseIntegers, StepEvidence, StepSums, replicated_steps
from vedette.missions.flights import FlightTeam
from vedette.missions.own.case import OwnCase
from vedette.missions.own.mission import OwnMission
from vedette.number import many

_WINDOW = 30.0  # steps stay open for late evidence, with sums [s]


@dataclass(frozen=True, eq=False)
class OwnTeam(FlightTeam[OwnCase]):
    """What all vehicles of a team know beforehand."""

    name: str = ""  # of the domain

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
    def domain(self) -> str:
        """By name."""
        return self.name

    @property
    def terms(self) -> Terms:
        """What all of the team have to agree on: the evidence's length beside the scenario."""
        return {**super().terms, "evidence": str(self.case.theory.size)}

    def mission(self, robot: int, boot: int, notary: Notary | None) -> OwnMission:
        """Return a vehicle's share, by its number from 0."""
        tells_plans = self.options.coordination != "shared"
        return OwnMission(self.case, robot, self.lead, self._fusion(robot, boot, notary), tells_plans)

    def _fusion(self, robot: int, boot: int, notary: Notary | None) -> StepEvidence[Sparse]:
        elements = SparseIntegers(self.case.theory.size)
        if self.options.fusion == "sums":
            return StepSums(robot, boot, elements, window=ceil(_WINDOW / self.case.step))
        return replicated_steps(robot, boot, elements, notary)

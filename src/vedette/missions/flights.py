"""What domains of vehicles that plan by a common clock share: a case, options, a team."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, radians
from pathlib import Path
from typing import Any, Generic, Protocol, TypeVar

from msgspec import Struct

from vedette.agent import Agent, FlightBehaviour, Pace
from vedette.agent.body import TICK
from vedette.agent.mission import FlightMission
from vedette.agent.terms import Terms, flat
from vedette.errors import InputError
from vedette.fusion.seals import Notary
from vedette.fusion.steps import Sparse, SparseIntegers, StepEvidence, StepSums, replicated_steps
from vedette.missions.flying import RoundTimes
from vedette.missions.pairs import SCHEME
from vedette.missions.sense import Grounds
from vedette.number import many
from vedette.scenario import Metre

COORDINATIONS = ("none", "shared", "negotiated")
FUSIONS = ("replicated", "sums")


class TeamOptions(Struct, forbid_unknown_fields=True, frozen=True):
    """How a team works, as its files and commands say it; the same for the whole team."""

    coordination: str = "negotiated"
    scheme: str | None = None  # of negotiation; None: token
    fusion: str = "replicated"  # of FUSIONS

    @property
    def negotiates_by(self) -> str:
        """The scheme."""
        return self.scheme or SCHEME

    @property
    def told(self) -> dict[str, Any]:
        """What files and summaries say of it."""
        return {"coordination": self.coordination, "scheme": self.negotiates_by, "fusion": self.fusion}


class TurningVehicle(Struct, forbid_unknown_fields=True, frozen=True):
    """A vehicle at constant speed with a bounded turn rate, as its scenario describes it."""

    start: tuple[Metre, Metre, float]  # x, y, heading [m, m, deg]

    @property
    def radius(self) -> float:
        """Of the body [m]: vehicles keep altitudes of their own, so that nobody makes room."""
        return 0.5

    @property
    def pose(self) -> tuple[float, float, float]:
        """Start, heading in radians."""
        return self.start[0], self.start[1], radians(self.start[2])


class FlightVehicle(Protocol):
    """A vehicle as its scenario describes it; ``vedette.agent.body.Hull``."""

    @property
    def pose(self) -> tuple[float, float, float]:
        """Where it starts: x, y, heading [m, m, rad], team frame."""

    @property
    def speed(self) -> float:
        """At most [m/s]."""

    @property
    def turn_rate(self) -> float | None:
        """At most [rad/s], at constant speed; None: it turns at once, and may stand."""

    @property
    def radius(self) -> float:
        """Of its body [m]."""


class FlightScenario(Protocol):
    """What all of a team have to agree on, as files say it."""

    @property
    def vehicles(self) -> Sequence[FlightVehicle]:
        """In the order of their names."""

    @property
    def step(self) -> float:
        """Of looking and planning [s]."""

    @property
    def horizon(self) -> int:
        """How far plans reach [steps]."""

    @property
    def replan(self) -> int:
        """A round each so many steps."""

    @property
    def duration(self) -> float:
        """Of the mission [s]."""


class FlightCase(Protocol):
    """What a scenario comes to, once it is known to make sense."""

    @property
    def name(self) -> str:
        """Of the scenario."""

    @property
    def names(self) -> Sequence[str]:
        """Of the vehicles."""

    @property
    def scenario(self) -> FlightScenario:
        """As it was read."""


class DomainCase(FlightCase, Protocol):
    """The same of a domain that is declared as one object."""

    @property
    def files(self) -> Sequence[Path]:
        """That it has been read from, beside the scenario."""


CaseT = TypeVar("CaseT", bound=FlightCase)
DomainCaseT = TypeVar("DomainCaseT", bound=DomainCase)
_WINDOW = 30.0  # steps stay open for late evidence, with sums [s]


@dataclass(frozen=True, eq=False)
class FlightTeam(ABC, Generic[CaseT]):
    """What all vehicles of a team know beforehand."""

    case: CaseT
    options: TeamOptions
    times: RoundTimes

    def __post_init__(self) -> None:
        """Raise InputError for a step that no simulator can make, or rounds longer than plans reach ahead."""
        step, horizon = self.case.scenario.step, self.case.scenario.horizon
        ticks = step / TICK
        if abs(ticks - round(ticks)) > 1e-6:
            raise InputError(f"step: must be a multiple of the simulator's tick of {TICK:g} s; got {step:g}")
        taken = ceil(self.lead / step) + 1
        if taken >= horizon:
            raise InputError(
                f"horizon: a round of {many(self.size, 'vehicle')} takes {self.lead:.1f} s where links delay "
                f"by {self.times.link_delay:g} s; plan more than {many(taken, 'step')} of {step:g} s"
            )

    @property
    @abstractmethod
    def domain(self) -> str:
        """By name."""

    @property
    @abstractmethod
    def grounds(self) -> Grounds:
        """What orders can be about."""

    @abstractmethod
    def mission(self, robot: int, boot: int, notary: Notary | None) -> FlightMission[Any, Any, Any]:
        """Return a vehicle's share, by its number from 0; ``boot`` grows from start to start.

        ``notary``: signs its evidence, if that is replicated, and checks everybody's; None: nobody does.
        """

    @property
    def size(self) -> int:
        """How many vehicles plan together: without coordination each is a team of one."""
        return 1 if self.options.coordination == "none" else len(self.case.names)

    @property
    def lead(self) -> float:
        """From freezing a round to the start of its plans, at least [s]."""
        return self.times.lead(self.size, self.options.negotiates_by)

    @property
    def terms(self) -> Terms:
        """What all of the team have to agree on."""
        return {
            "mission": self.domain,
            **self.options.told,
            **dict(flat("scenario", self.case.scenario)),
        }

    def evidence(self, robot: int, boot: int, notary: Notary | None, size: int) -> StepEvidence[Sparse]:
        """Return how a vehicle's evidence, ``size`` integers that add up, is told and added up."""
        elements = SparseIntegers(size)
        if self.options.fusion == "sums":
            return StepSums(robot, boot, elements, window=ceil(_WINDOW / self.case.scenario.step))
        return replicated_steps(robot, boot, elements, notary)

    def assemble(self, robot: int, boot: int, notary: Notary | None = None) -> Agent:
        """Return a fresh agent for a vehicle, by its number from 0, and as ``mission`` says."""
        scenario = self.case.scenario
        vehicle = scenario.vehicles[robot]
        behaviour = FlightBehaviour(self.mission(robot, boot, notary), vehicle.speed, vehicle.turn_rate)
        pace = Pace.each(scenario.replan * scenario.step)
        return Agent(robot, boot, vehicle, behaviour, self.options.negotiates_by, pace, forks=True)

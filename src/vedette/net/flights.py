"""What vehicles of all domains have in common as processes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import degrees
from pathlib import Path
from typing import Any, Protocol

import msgspec

from vedette.agent import Agent
from vedette.agent.orders import Order
from vedette.agent.terms import Terms, fingerprint_of
from vedette.errors import InputError
from vedette.missions.flying import RoundTimes
from vedette.missions.sense import Grounds
from vedette.net.config import AgentConfig, LinkSettings
from vedette.net.notary import CertifiedNotary
from vedette.net.orders import Judge, flight_judge, gate_of

THINKING = 0.1  # that a vehicle's preparation of a round is reckoned to take [s of real time]


def round_times(links: LinkSettings, speed: float) -> RoundTimes:
    """Return what rounds take over such links, in mission time."""
    return RoundTimes(links.delay * speed, THINKING * speed)


class OrderedTeam(Protocol):
    """A team of vehicles that takes orders."""

    @property
    def terms(self) -> Terms:
        """What all of it have to agree on."""

    @property
    def grounds(self) -> Grounds:
        """What orders can be about."""


def judge_of(config: AgentConfig, team: OrderedTeam, agent: Agent, notary: CertifiedNotary | None) -> Judge:
    """Return who says whether a vehicle takes an order, of its operator or passed on by a mate."""
    return flight_judge(agent, gate_of(config, f"{fingerprint_of(team.terms):x}", notary), team.grounds)


def check_number(robot: int, vehicles: int) -> None:
    """Raise InputError where the scenario has no vehicle for a robot, by its number from 1."""
    if robot > vehicles:
        raise InputError(f"robot: must be 1 to {vehicles}, a vehicle of the scenario; got {robot}")


@dataclass(frozen=True, eq=False)
class FlightsPlan:
    """A team of vehicles that is to be started as processes; ``vedette.net.launch.TeamPlan``."""

    mission: str  # "track", "search" or "domain"
    options: msgspec.Struct  # of the mission
    scenario: Path | None  # None: the one that is built in
    size: int  # number of vehicles
    seed: int
    speed: float  # times real time
    lease: float = 3.0  # [s]
    shared_clock = True

    @property
    def times(self) -> RoundTimes:
        """What the team's rounds take."""
        return round_times(LinkSettings(), self.speed)

    def as_told(self, order: Order) -> Order:
        """Return an order as it is: vehicles share the scenario's frame."""
        return order

    def write(self, folder: Path) -> None:
        """Write nothing: all read the same scenario."""

    def config(self, i: int, pose: Sequence[float] | None) -> dict[str, Any]:
        """Return what a vehicle's file says of its mission; ``pose``: where it is put, None: at its start."""
        body: dict[str, Any] = {"seed": self.seed}
        if pose is not None:
            x, y, heading = pose
            body["start"] = [x, y, degrees(heading)]
        scenario = {} if self.scenario is None else {"scenario": str(self.scenario.resolve())}
        return {self.mission: msgspec.to_builtins(self.options), "body": body, **scenario}

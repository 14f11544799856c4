"""A vehicle of any domain that is declared as one object: from its file, and as the operator sees it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Generic, cast

import msgspec
import numpy as np
from numpy.typing import NDArray

from vedette import wire
from vedette.agent import Agent, FlightBehaviour
from vedette.agent.flight import step_of
from vedette.agent.mission import FlightMission
from vedette.errors import check_word
from vedette.missions.flights import FlightCase, FlightTeam, FlightVehicle
from vedette.net.config import AgentConfig
from vedette.net.flights import check_number, judge_of, round_times
from vedette.net.gather import figures_of, path_of
from vedette.net.notary import notary_of
from vedette.net.report import Condition
from vedette.net.robot import Robot
from vedette.net.simulated import Domain, domain_of, simulated_vehicle
from vedette.net.team import Fates, Links, ReportT_co, as_it_is, called_off
from vedette.outcome import Outcome
from vedette.record.figures import RobotFigures
from vedette.record.flights import FlightView
from vedette.record.log import Sink, VehicleSample
from vedette.record.summary import Setting, Timing

AnyDomain = Domain[Any, Any, Any, Any, Any]


def vehicle(config: AgentConfig, folder: Path, boot: int, speed: float) -> Robot:
    """Return a vehicle; ``folder``: what paths in its file are relative to.

    Raises:
        InputError: there is no such domain, or no such vehicle in the scenario, or that cannot be used.
    """
    assert config.domain is not None
    domain = domain_of(config.domain.name)
    check_word("domain.coordination", config.domain.coordination, domain.networked)
    case = domain.case(None if config.scenario is None else folder / config.scenario)
    check_number(config.robot, len(case.names))
    team = domain.team(case, config.domain, round_times(config.links, speed))
    notary, terms = notary_of(config, folder, team.terms, speed)
    agent = team.assemble(config.robot - 1, boot, notary)
    teller = DomainTeller(agent, domain, case)
    judge = judge_of(config, team, agent, notary)
    return Robot(agent, simulated_vehicle(config, domain, case), None, teller, terms, judge=judge)


@dataclass(frozen=True, eq=False)
class DomainTeller:
    """Tells what an agent knows of its mission; ``vedette.net.witness.Teller``."""

    agent: Agent
    domain: AnyDomain
    case: FlightCase
    known: None = None

    def path(self, now: float) -> NDArray[np.float64]:
        """Return where the vehicle will go, as far as it is planned."""
        agent, pose, dt = self.agent, self.agent.pose, self.case.scenario.step
        if pose is None:
            return np.empty((0, 2))
        flight = cast(FlightBehaviour, agent.behaviour).flight
        speed = self.case.scenario.vehicles[agent.robot].speed
        return flight.ahead((pose.x, pose.y, pose.heading), speed, step_of(now, dt) * dt, dt)

    def content(self, now: float) -> bytes:
        """Return what it tells at the present step."""
        mission = cast(FlightMission[Any, Any, Any], self.agent.mission)
        return msgspec.msgpack.encode(self.domain.tell(mission, step_of(now, self.case.scenario.step)))


class DomainWatcher(Generic[ReportT_co]):
    """A team as the operator sees it, by what its vehicles report; ``vedette.net.team.Watcher``."""

    def __init__(
        self,
        domain: Domain[Any, Any, Any, Any, ReportT_co],
        team: FlightTeam[Any],
        setting: Setting,
        sinks: Sequence[Sink[Any]] = (),
    ) -> None:
        """Prepare to watch a mission that has not begun."""
        self._domain, self._case = domain, team.case
        self._observer = domain.observer(team, setting, sinks)
        self._decoder = msgspec.msgpack.Decoder(domain.content)
        self.period = 0.5 * team.case.scenario.step
        self._views = [_at_the_start(each) for each in team.case.scenario.vehicles]

    def take(self, condition: Condition, content: bytes) -> None:
        """Take what a vehicle tells; ValueError if it makes no sense."""
        told = wire.decode(self._decoder, content, "report")
        self._domain.check(told, self._case)
        at = condition.x, condition.y, condition.heading
        sample = VehicleSample(*at, condition.state, True, path_of(condition))
        self._views[condition.robot] = FlightView(sample, told, figures_of(condition))

    def look(self, now: float, fates: Fates, links: Links) -> None:
        """Measure the mission, once a step; steps that nobody told of in time are measured late."""
        while self._observer.log.due(now):
            self._observer.look(self._seen(fates))

    def finish(self, now: float, fates: Fates, links: Links) -> None:
        """Measure how it ended."""
        self._observer.finish(now, self._seen(fates))

    def over(self, now: float, heard: Sequence[Condition], silent: bool) -> Outcome | None:
        """Tell whether the scenario's time is over, or the operator has called all off."""
        if called_off(heard, silent):
            return Outcome.ORDERED
        return Outcome.COMPLETE if now >= self._case.scenario.duration - 1e-9 else None

    def report(self, outcome: Outcome, timing: Timing, now: float) -> ReportT_co:
        """Return what the mission leaves."""
        return self._observer.report(outcome, timing, now)

    def _seen(self, fates: Fates) -> list[FlightView[Any]]:
        return [
            replace(view, sample=as_it_is(view.sample, fate))
            for view, fate in zip(self._views, fates, strict=True)
        ]


def _at_the_start(vehicle: FlightVehicle) -> FlightView[Any]:
    sample = VehicleSample(*vehicle.pose, "starting", True, np.empty((0, 2)))
    return FlightView(sample, None, RobotFigures())

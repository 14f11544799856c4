"""A mission of any domain that is declared as one object: put together for the simulator, run, measured."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Generic, cast

import numpy as np

from vedette.agent.mission import FlightMission
from vedette.errors import check_word
from vedette.missions.flights import FUSIONS, DomainCaseT, TeamOptions
from vedette.outcome import Outcome
from vedette.record.flights import FlightView
from vedette.record.log import Floats, Sink, VehicleSample
from vedette.sim.domain import Domain, ReportT
from vedette.sim.flights import FlightSetup
from vedette.sim.simulation import Simulation
from vedette.sim.views import NOWHERE, figures, flight, setting, state
from vedette.sim.watched import Watched


@dataclass(frozen=True)
class DomainSetup(FlightSetup):
    """What to simulate, beside the scenario."""

    fusion: str = "replicated"

    def __post_init__(self) -> None:
        super().__post_init__()
        check_word("fusion", self.fusion, FUSIONS)

    @property
    def options(self) -> TeamOptions:
        """How the team works."""
        return TeamOptions(self.coordination, self.scheme, self.fusion)


class DomainSimulation(Simulation, Generic[DomainCaseT]):
    """A team of vehicles in a world of their domain; ``run`` lets it, to the end of its scenario."""

    setup: DomainSetup

    def __init__(
        self, domain: Domain[DomainCaseT, Any, Any, Any, Any], case: DomainCaseT, setup: DomainSetup
    ) -> None:
        """Put the vehicles at their starts.

        Raises:
            InputError: the domain knows no such coordination, or cannot have these options.
        """
        check_word("coordination", setup.coordination, domain.coordinations)
        self.domain, self.case = domain, case
        self.team = domain.team(case, setup.options, setup.times)
        self.vehicles = domain.vehicles(case, setup.seed, self._over_at_the_end)
        super().__init__(domain.spawn(self.team), self.vehicles, setup)

    @property
    def missions(self) -> list[FlightMission[Any, Any, Any]]:
        """Everybody's share of the mission, by index."""
        return [cast(FlightMission[Any, Any, Any], agent.mission) for agent in self.network.agents]

    def _over_at_the_end(self, now: float) -> Outcome | None:
        return Outcome.COMPLETE if now >= self.case.scenario.duration - 1e-9 else None


class DomainRun(Watched[ReportT]):
    """One mission, measured once a step."""

    def __init__(
        self,
        domain: Domain[Any, Any, Any, Any, ReportT],
        simulation: DomainSimulation[Any],
        sinks: Sequence[Sink[Any]] = (),
    ) -> None:
        """Prepare a mission that has not begun; ``sinks`` follow it."""
        super().__init__(simulation)
        self.simulation = simulation
        self._observer = domain.observer(simulation.team, setting(simulation.setup), sinks)
        self._poses: list[
            Floats
        ] = []  # (n, 3) of everybody, at the beginning of the step that is logged next

    def _look(self) -> None:
        log, simulation = self._observer.log, self.simulation
        if not self._poses and simulation.now >= log.step * simulation.case.scenario.step - 1e-6:
            self._poses = [np.array(simulation.pose(i)) for i in range(len(simulation.case.names))]
        if log.due(simulation.now):
            self._observer.look(self._views())
            self._poses = []

    def _report(self, outcome: Outcome) -> ReportT:
        now = self.simulation.now
        self._observer.finish(now, self._views())
        return self._observer.report(outcome, self.simulation.clock.timing(now), now)

    def _views(self) -> list[FlightView[Any]]:
        """Return what can be told of every vehicle, and what the first living one tells of the mission."""
        first = next(iter(self.simulation.living), 0)
        return [self._view(i, i == first) for i in range(len(self.simulation.case.names))]

    def _view(self, i: int, tells: bool) -> FlightView[Any]:
        simulation, step = self.simulation, self._observer.log.step
        case, alive = simulation.case, bool(simulation.vehicles.alive[i])
        pose = self._poses[i] if self._poses else np.array(simulation.pose(i))
        x, y, heading = pose.tolist()
        path = NOWHERE
        if alive:
            path = flight(simulation, i).ahead(
                pose, case.scenario.vehicles[i].speed, step * case.scenario.step, case.scenario.step
            )
        return FlightView(
            VehicleSample(x, y, heading, state(simulation, i), alive, path),
            simulation.domain.tell(simulation.missions[i], step) if tells else None,
            figures(simulation, i, float(simulation.vehicles.travelled[i])),
        )

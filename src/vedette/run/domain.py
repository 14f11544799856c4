"""A domain that is declared as one object, from Python: its missions, stepped or run to their end."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, Generic, Unpack

from vedette.agent.orders import NoGo, Priority
from vedette.interrupt import ending_on_ctrl_c
from vedette.missions.pairs import tell_duration, tell_unsaid
from vedette.outcome import Outcome
from vedette.run.inputs import AnyPath, Conditions, files_of, links_of, order_file, setup_of
from vedette.run.mission import Followers, ProgressSink, ReportT, StepwiseMission
from vedette.sim.domain import Domain
from vedette.sim.domain_run import DomainRun, DomainSetup, DomainSimulation
from vedette.sim.orders import OrderAt, check_flight_orders


class DomainMission(StepwiseMission[Any, Any, Any, ReportT], Generic[ReportT]):
    """One mission of a domain in simulation: every vehicle runs its own agent."""

    def __init__(
        self,
        domain: Domain[Any, Any, Any, Any, ReportT],
        scenario: Mapping[str, Any] | AnyPath | None = None,
        seed: int = 0,
        *,
        coordination: str = "negotiated",
        scheme: str | None = None,
        fusion: str = "replicated",
        max_time: float | None = None,
        record: AnyPath | None = None,
        **conditions: Unpack[Conditions],
    ) -> None:
        """Put the vehicles at their starts.

        Args:
            domain: see ``vedette.sim.domains.domain_of``.
            scenario: its fields, or a file; None: the one that is built in.
            seed: of the truth and all chance.
            coordination, scheme, fusion: how the vehicles decide, negotiate and share what they see.
            max_time: simulated time limit [s]; None: the scenario's duration.
            record: a folder for the run record, ``run.mcap``.
            conditions: see `vedette.run.inputs.Conditions`.

        Raises:
            InputError: something of it cannot be.
        """
        self.domain = domain
        self.case = domain.case(Path(scenario) if isinstance(scenario, str) else scenario)
        size, duration = len(self.case.names), self.case.scenario.duration
        limit = duration + 1.0 if max_time is None else max_time
        self._setup = DomainSetup(
            **vars(setup_of(size, scheme=scheme, seed=seed, max_time=limit, **conditions)),
            coordination=coordination,
            fusion=fusion,
        )
        tell_unsaid(coordination, size, **links_of(self._setup))
        tell_duration(max_time, duration)
        self.simulation = DomainSimulation(domain, self.case, self._setup)
        orders = conditions.get("orders", ())
        check_flight_orders(self._setup.orders, self.simulation.team.grounds, order_file(orders))
        self.scene = domain.scene(self.case)
        followers = Followers[Any]()
        super().__init__(
            self.simulation,
            DomainRun(domain, self.simulation, (followers,)),
            followers,
            lambda place: domain.recorder(place, self.scene),
            record,
            (*files_of(None, scenario, conditions.get("faults"), orders), *self.case.files),
        )

    def _check_order(self, given: OrderAt, known: Sequence[NoGo | Priority]) -> None:
        """Raise InputError for an order that makes no sense to these vehicles."""
        check_flight_orders([given], self.simulation.team.grounds, "order", known)

    def run(self, progress: Callable[[Any], object] | None = None, compare: bool = True) -> ReportT:
        """Run to the end; ``progress`` is called with a snapshot a step.

        ``compare``: do the same with every other way of coordination afterwards.
        """
        report = self.play([] if progress is None else [ProgressSink(progress)])
        return self.compared(report) if compare else report

    def compared(self, report: ReportT, say: Callable[[str], object] = lambda text: None) -> ReportT:
        """Return the report of the mission with the other ways of coordination beside it, on the same seed.

        When one is interrupted, it and the rest are left out, and the whole counts as interrupted.
        """
        others: dict[str, ReportT] = {}
        with ending_on_ctrl_c(self.stop):
            for name in self.domain.others(self.case, self._setup.coordination):
                simulation = DomainSimulation(self.domain, self.case, replace(self._setup, coordination=name))
                self._beside(simulation)
                say(f"to compare: {name}")
                run = DomainRun(self.domain, simulation)
                ran = run.run()
                if run.over is Outcome.INTERRUPTED:
                    return self.domain.compared(report, others, Outcome.INTERRUPTED)
                others[name] = ran
        return self.domain.compared(report, others, self._watched.over or Outcome.INTERRUPTED)

    def result(self) -> ReportT:
        """Return how it went, compared with nothing; a mission that goes on is interrupted."""
        return self.finish()

"""Search from Python: ``search``, and ``Search`` to step through it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias, Unpack

import numpy as np
from numpy.typing import NDArray

from vedette.agent.flight import step_of
from vedette.agent.orders import NoGo, Priority
from vedette.domains.search.flights import Flight
from vedette.domains.search.impact import Impact
from vedette.interrupt import ending_on_ctrl_c
from vedette.maps import GridFrame
from vedette.missions.pairs import tell_duration, tell_unsaid
from vedette.missions.search.case import SearchCase, default_case, made, read_case
from vedette.missions.search.scenario import Heat, SearchScenario
from vedette.number import is_number
from vedette.record.search.log import SearchLog, SearchScene, SearchSnapshot
from vedette.record.search.mcap import SearchMcapWriter
from vedette.record.search.observer import SearchReport
from vedette.record.search.summary import SearchSummary
from vedette.run.inputs import AnyPath, Conditions, described, files_of, links_of, order_file, setup_of
from vedette.run.mission import Followers, ProgressSink, StepwiseMission
from vedette.run.result import MissionResult
from vedette.sim.orders import OrderAt, check_flight_orders
from vedette.sim.search.run import SearchRun
from vedette.sim.search.simulation import SearchSetup, SearchSimulation
from vedette.sim.search.trials import Running, assessed

AnyScenario: TypeAlias = SearchScenario | Mapping[str, Any] | AnyPath | None
_Mission: TypeAlias = StepwiseMission[SearchSnapshot, Flight, Impact, SearchReport]


@dataclass(frozen=True, kw_only=True, eq=False)
class SearchResult(MissionResult[SearchReport], SearchSummary):
    """The figures of ``summary.json``, the last pdf and the log."""

    @property
    def pdf(self) -> NDArray[np.float32]:
        """``(R, C)`` probability of each cell in the end; row 0 the lowest y."""
        return self.log.snapshots[-1].mass

    @property
    def frame(self) -> GridFrame:
        """Where the pdf lies."""
        return self.log.scene.frame

    @property
    def log(self) -> SearchLog:
        """A snapshot a step."""
        return self.report.log

    def save(self, folder: Path | str, animate: bool = False) -> None:
        """Write the files of ``vedette search`` into a folder, all but the run record."""
        from vedette.record.search.outputs import write_outputs  # draws: takes a second to import

        with self._folder(folder) as place:
            write_outputs(self.report, place, animate)


class Search(_Mission):
    """A team of vehicles that looks for a hidden target in simulation: every vehicle runs its own agent."""

    def __init__(
        self,
        scenario: AnyScenario = None,
        seed: int = 0,
        *,
        coordination: str = "negotiated",
        scheme: str | None = None,
        fusion: str = "replicated",
        max_time: float | None = None,
        record: AnyPath | None = None,
        **conditions: Unpack[Conditions],
    ) -> None:
        """Put the vehicles at their starts and the target somewhere.

        Args:
            scenario: a SearchScenario or its fields, or a file; None: the one that is built in.
            seed: of the hidden target and all chance.
            coordination, scheme, fusion: what the vehicles tell each other, how they negotiate and share.
            max_time: search no longer than that [s]; None: the scenario's duration.
            record: a folder for the run record, ``run.mcap``.
            conditions: see `vedette.run.inputs.Conditions`.

        Raises:
            InputError: something of it cannot be.
        """
        self.case = case_of(scenario)
        longest = self.case.scenario.duration
        limit = longest if max_time is None or (is_number(max_time) and max_time > longest) else max_time
        setup = SearchSetup(
            **vars(setup_of(len(self.case.names), scheme=scheme, seed=seed, max_time=limit, **conditions)),
            coordination=coordination,
            fusion=fusion,
        )
        tell_unsaid(setup.coordination, len(self.case.names), **links_of(setup))
        tell_duration(max_time, longest)
        self.simulation = SearchSimulation(self.case, setup)
        orders = conditions.get("orders", ())
        check_flight_orders(setup.orders, self.simulation.team.grounds, order_file(orders))
        self.scene = SearchScene.of(self.case, limit)
        self._trials = Running()
        followers = Followers[SearchSnapshot]()
        super().__init__(
            self.simulation,
            SearchRun(self.simulation, (followers,)),
            followers,
            lambda place: SearchMcapWriter(place, self.scene),
            record,
            (*files_of(None, scenario, conditions.get("faults"), orders), *heat_maps(self.case, scenario)),
        )

    @property
    def pdf(self) -> NDArray[np.float64]:
        """``(R, C)`` probability of each cell at the present step, as the first living vehicle knows it."""
        step = step_of(self.now, self.case.scenario.step)
        return self.simulation.missions[self._first].pdf(step).mass

    def _check_order(self, given: OrderAt, known: Sequence[NoGo | Priority]) -> None:
        """Raise InputError for an order that makes no sense to these vehicles."""
        check_flight_orders([given], self.simulation.team.grounds, "order", known)

    def run(
        self,
        progress: Callable[[SearchSnapshot], object] | None = None,
        compare: bool = True,
        trials: int | None = None,
    ) -> SearchResult:
        """Search to the end; ``progress`` is called with a snapshot a step.

        ``compare`` and ``trials``: what is worked out afterwards, see `assessed`.
        """
        report = self.play([] if progress is None else [ProgressSink(progress)])
        return SearchResult.of(self.assessed(report, compare, trials), self.inputs)

    def assessed(
        self,
        report: SearchReport,
        compare: bool = True,
        trials: int | None = None,
        say: Callable[[str], None] = lambda text: None,
    ) -> SearchReport:
        """Return the report of the search with what the probability of detection comes to.

        Args:
            report: of the search.
            compare: whether to look at the other ways of coordination too.
            trials: targets drawn for the counted curve; None: 1000, or 20 whole searches; 0: none.
            say: told what is going on.
        """
        self._trials.say = say
        with ending_on_ctrl_c(self.stop):
            return assessed(report, self.simulation, self._trials, trials, compare)

    def stop(self) -> None:
        """End what is going on, and begin nothing else; a signal handler may call it."""
        self._trials.stop()
        super().stop()

    def result(self) -> SearchResult:
        """Return how it went, nothing worked out beside it; a search that goes on is interrupted."""
        return SearchResult.of(self.finish(), self.inputs)


def case_of(scenario: AnyScenario) -> SearchCase:
    """Return the search of a scenario.

    Raises:
        InputError: it cannot be used.
    """
    match scenario:
        case None:
            return default_case()
        case str() | Path():
            return read_case(scenario)
        case _:
            return made(described(scenario, SearchScenario), Path("scenario"))


def heat_maps(case: SearchCase, scenario: AnyScenario) -> list[Path]:
    """Return the images that a search has been read from; they lie beside its scenario."""
    beside = Path(scenario).parent if isinstance(scenario, str | Path) else Path()
    return [beside / part.file for part in case.scenario.prior if isinstance(part, Heat)]


def search(
    scenario: AnyScenario = None,
    seed: int = 0,
    *,
    progress: Callable[[SearchSnapshot], object] | None = None,
    compare: bool = True,
    trials: int | None = None,
    **options: Any,
) -> SearchResult:
    """Let a team look for a hidden target to the end, as ``vedette search`` does.

    Args:
        scenario, seed, options: see `Search`.
        progress: called with a snapshot a step.
        compare: whether to look at the other ways of coordination afterwards.
        trials: targets drawn for the counted curve; None: 1000, or 20 whole searches; 0: none.

    Raises:
        InputError: something of it cannot be.
    """
    return Search(scenario, seed, **options).run(progress, compare, trials)

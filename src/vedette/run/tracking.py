"""Tracking from Python: ``track``, and ``Track`` to step through it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias, Unpack

import numpy as np
from numpy.typing import NDArray

from vedette.agent.flight import step_of
from vedette.agent.orders import NoGo, Priority
from vedette.domains.tracking.belief import Tracks
from vedette.domains.tracking.courses import Course
from vedette.domains.tracking.filter import predict
from vedette.domains.tracking.impact import Impact
from vedette.interrupt import ending_on_ctrl_c
from vedette.missions.pairs import tell_duration, tell_objective, tell_unsaid
from vedette.missions.track.scenario import TrackScenario, checked, default_scenario, read_scenario
from vedette.record.track.log import TrackLog, TrackScene, TrackSnapshot
from vedette.record.track.mcap import TrackMcapWriter
from vedette.record.track.observer import TrackReport
from vedette.record.track.summary import TrackSummary
from vedette.run.inputs import AnyPath, Conditions, described, files_of, links_of, order_file, setup_of
from vedette.run.mission import Followers, ProgressSink, StepwiseMission
from vedette.run.result import MissionResult
from vedette.sim.orders import OrderAt, check_flight_orders
from vedette.sim.track.run import TrackRun, compared
from vedette.sim.track.run import track as run_beside
from vedette.sim.track.simulation import TrackSetup, TrackSimulation

AnyScenario: TypeAlias = TrackScenario | Mapping[str, Any] | AnyPath | None
_Mission: TypeAlias = StepwiseMission[TrackSnapshot, Course, Impact, TrackReport]


@dataclass(frozen=True, kw_only=True, eq=False)
class TrackResult(MissionResult[TrackReport], TrackSummary):
    """The figures of ``summary.json``, the last tracks and the log."""

    @property
    def means(self) -> NDArray[np.float64]:
        """``(T, 4)`` last estimates: x, y, vx, vy [m, m, m/s, m/s]."""
        return self.log.snapshots[-1].means

    @property
    def covariances(self) -> NDArray[np.float64]:
        """``(T, 4, 4)`` of the means."""
        return self.log.snapshots[-1].covariances

    @property
    def truth(self) -> NDArray[np.float64]:
        """``(T, 4)`` what the targets' states truly were then."""
        return self.log.snapshots[-1].truth

    @property
    def log(self) -> TrackLog:
        """A snapshot a step."""
        return self.report.log

    def save(self, folder: Path | str, animate: bool = False) -> None:
        """Write the files of ``vedette track`` into a folder, all but the run record."""
        from vedette.record.track.outputs import write_outputs  # draws: takes a second to import

        with self._folder(folder) as made:
            write_outputs(self.report, made, animate)


class Track(_Mission):
    """A team of vehicles that follows targets in simulation: every vehicle runs its own agent."""

    def __init__(
        self,
        scenario: AnyScenario = None,
        seed: int = 0,
        *,
        coordination: str = "negotiated",
        scheme: str | None = None,
        fusion: str = "replicated",
        objective: str | None = None,
        continuous: bool = False,
        max_time: float | None = None,
        record: AnyPath | None = None,
        **conditions: Unpack[Conditions],
    ) -> None:
        """Put vehicles and targets at their starts.

        Args:
            scenario: a TrackScenario or its fields, or a file; None: the one that is built in.
            seed: of the targets' true ways and all chance.
            coordination, scheme, fusion: how the vehicles decide, negotiate and share what they see.
            objective: what they gain; None: the scenario's.
            continuous: whether to improve the best course's turn rates by the objective's gradient.
            max_time: simulated time limit [s]; None: the scenario's duration.
            record: a folder for the run record, ``run.mcap``.
            conditions: see `vedette.run.inputs.Conditions`.

        Raises:
            InputError: something of it cannot be.
        """
        self.scenario, name = scenario_of(scenario)
        limit = self.scenario.duration + 1.0 if max_time is None else max_time
        size = len(self.scenario.vehicles)
        setup = self._setup = TrackSetup(
            **vars(setup_of(size, scheme=scheme, seed=seed, max_time=limit, **conditions)),
            coordination=coordination,
            fusion=fusion,
            objective=objective,
            continuous=continuous,
        )
        tell_unsaid(setup.coordination, size, **links_of(setup))
        tell_duration(max_time, self.scenario.duration)
        tell_objective(objective, self.scenario.objective, default_scenario().objective)
        self.simulation = TrackSimulation(self.scenario, setup)
        orders = conditions.get("orders", ())
        check_flight_orders(setup.orders, self.simulation.team.grounds, order_file(orders))
        self.scene = TrackScene.of(self.scenario, name)
        followers = Followers[TrackSnapshot]()
        super().__init__(
            self.simulation,
            TrackRun(self.simulation, name, (followers,)),
            followers,
            lambda place: TrackMcapWriter(place, self.scene),
            record,
            files_of(None, scenario, conditions.get("faults"), orders),
        )

    @property
    def tracks(self) -> Tracks:
        """The team's tracks, at the present step, as the first living vehicle knows them."""
        known = self.simulation.missions[self._first].tracks()
        return predict(known, max(0, step_of(self.now, self.scenario.step) - known.k0))

    @property
    def means(self) -> NDArray[np.float64]:
        """``(T, 4)`` of the tracks: x, y, vx, vy [m, m, m/s, m/s]."""
        return self.tracks.means

    @property
    def covariances(self) -> NDArray[np.float64]:
        """``(T, 4, 4)`` of the tracks."""
        return self.tracks.covariances

    def _check_order(self, given: OrderAt, known: Sequence[NoGo | Priority]) -> None:
        """Raise InputError for an order that makes no sense to these vehicles."""
        check_flight_orders([given], self.simulation.team.grounds, "order", known)

    def run(
        self, progress: Callable[[TrackSnapshot], object] | None = None, compare: bool = True
    ) -> TrackResult:
        """Track to the end; ``progress`` is called with a snapshot a step.

        ``compare``: do the same with every other way of coordination afterwards.
        """
        report = self.play([] if progress is None else [ProgressSink(progress)])
        return TrackResult.of(self.compared(report) if compare else report, self.inputs)

    def compared(self, report: TrackReport, say: Callable[[str], object] = lambda text: None) -> TrackReport:
        """Return the report of the mission with the other ways of coordination beside it."""

        def beside(simulation: TrackSimulation, coordination: str) -> TrackReport:
            self._beside(simulation)
            say(f"to compare: {coordination}")
            return run_beside(simulation, self.scene.name)

        with ending_on_ctrl_c(self.stop):
            return compared(report, self.scenario, self._setup, beside)

    def result(self) -> TrackResult:
        """Return how it went, compared with nothing; a mission that goes on is interrupted."""
        return TrackResult.of(self.finish(), self.inputs)


def scenario_of(scenario: AnyScenario) -> tuple[TrackScenario, str]:
    """Return a scenario and its name.

    Raises:
        InputError: it cannot be used.
    """
    match scenario:
        case None:
            return default_scenario(), "track"
        case str() | Path():
            return read_scenario(scenario), Path(scenario).stem
        case _:
            return checked(described(scenario, TrackScenario), "scenario"), "scenario"


def track(
    scenario: AnyScenario = None,
    seed: int = 0,
    *,
    progress: Callable[[TrackSnapshot], object] | None = None,
    compare: bool = True,
    **options: Any,
) -> TrackResult:
    """Let a team follow targets to the end, as ``vedette track`` does.

    Args:
        scenario, seed, options: see `Track`.
        progress: called with a snapshot a step.
        compare: whether to do the same with every other way of coordination afterwards.

    Raises:
        InputError: something of it cannot be.
    """
    return Track(scenario, seed, **options).run(progress, compare)

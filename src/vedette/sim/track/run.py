"""Run one tracking mission in simulation, and others beside it, and say how they went."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from vedette.errors import InputError
from vedette.missions.track.options import COORDINATIONS
from vedette.missions.track.scenario import TrackScenario
from vedette.outcome import Outcome
from vedette.record.log import Sink
from vedette.record.track.log import TrackSample, TrackSnapshot
from vedette.record.track.observer import TrackObserver, TrackReport, TrackView, ahead
from vedette.record.track.summary import TrackQuality
from vedette.sim.track.simulation import TrackSetup, TrackSimulation, check_optimum
from vedette.sim.views import NOWHERE, figures, flight, setting, state
from vedette.sim.watched import Watched


class TrackRun(Watched[TrackReport]):
    """One tracking mission, measured once a step."""

    def __init__(
        self, simulation: TrackSimulation, name: str, sinks: Sequence[Sink[TrackSnapshot]] = ()
    ) -> None:
        """Prepare a mission that has not begun, by its scenario's name; ``sinks`` follow it."""
        super().__init__(simulation)
        self.simulation = simulation
        self._observer = observer_of(simulation, name, sinks)

    def _look(self) -> None:
        log = self._observer.log
        if log.due(self.simulation.now):
            self._observer.look(views(self.simulation, log.step))

    def _report(self, outcome: Outcome) -> TrackReport:
        now = self.simulation.now
        self._observer.finish(views(self.simulation, self._observer.log.step))
        return self._observer.report(outcome, self.simulation.clock.timing(now), now)


def track(simulation: TrackSimulation, name: str, sinks: Sequence[Sink[TrackSnapshot]] = ()) -> TrackReport:
    """Run a mission to its end; ``sinks`` follow it, and ``simulation.stop`` ends it in good order."""
    return TrackRun(simulation, name, sinks).run()


def observer_of(
    simulation: TrackSimulation, name: str, sinks: Sequence[Sink[TrackSnapshot]] = ()
) -> TrackObserver:
    """Return an observer of a simulated mission that has not begun."""
    return TrackObserver(simulation.team, name, setting(simulation.setup), simulation.targets.at, sinks)


def views(simulation: TrackSimulation, step: int) -> list[TrackView]:
    """Return what can be told of every simulated vehicle at a step."""
    return [_view(simulation, i, step) for i in range(len(simulation.names))]


def _view(simulation: TrackSimulation, i: int, step: int) -> TrackView:
    mission, targets = simulation.missions[i], simulation.targets
    alive = bool(simulation.vehicles.alive[i])
    pose = targets.poses.get((step, i), np.array(simulation.pose(i)))
    path = ahead(flight(simulation, i), pose, simulation.scenario, i, step) if alive else NOWHERE
    x, y, heading = pose.tolist()
    return TrackView(
        TrackSample(x, y, heading, state(simulation, i), alive, path, targets.seen.get((step, i), ())),
        mission.tracks(),
        mission.skipped,
        figures(simulation, i, float(simulation.vehicles.travelled[i])),
    )


def compared(
    report: TrackReport,
    scenario: TrackScenario,
    setup: TrackSetup,
    run: Callable[[TrackSimulation, str], TrackReport],
) -> TrackReport:
    """Return the report with the other ways of coordination beside it, on the same seed.

    The optimum is left out where it cannot be had. ``run(simulation, coordination)`` runs one of them; when
    one is interrupted, it and the rest are left out, and the mission as a whole counts as interrupted.
    """
    logs, left_out, outcome = {setup.coordination: report.log}, {}, report.summary.outcome
    for coordination in COORDINATIONS:
        other = replace(setup, coordination=coordination)
        if coordination == setup.coordination:
            continue
        if outcome is Outcome.INTERRUPTED:
            left_out[coordination] = "interrupted"
            continue
        try:
            if coordination == "optimum":
                check_optimum(scenario, other)
        except InputError as error:
            left_out[coordination] = str(error)
            continue
        ran = run(TrackSimulation(scenario, other), coordination)
        if ran.summary.outcome is Outcome.INTERRUPTED:
            outcome = Outcome.INTERRUPTED
            left_out[coordination] = "interrupted"
        else:
            logs[coordination] = ran.log
    comparison = {name: TrackQuality.of(logs[name]) for name in COORDINATIONS if name in logs}
    summary = replace(report.summary, comparison=comparison, outcome=outcome, completed=outcome.completed)
    del logs[setup.coordination]
    return replace(report, summary=summary, others=logs, left_out=left_out)

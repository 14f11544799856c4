"""Run one search in simulation and say how it went."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from vedette.outcome import Outcome
from vedette.record.log import Sink
from vedette.record.search.curves import ideal
from vedette.record.search.log import SearchSample, SearchSnapshot
from vedette.record.search.observer import (
    Hiding,
    SearchObserver,
    SearchReport,
    SearchView,
    ahead,
)
from vedette.sim.search.simulation import SearchSimulation
from vedette.sim.views import NOWHERE, figures, flight, setting, state
from vedette.sim.watched import Watched


class SearchRun(Watched[SearchReport]):
    """One search, measured once a step."""

    def __init__(self, simulation: SearchSimulation, sinks: Sequence[Sink[SearchSnapshot]] = ()) -> None:
        """Prepare a search that has not begun; ``sinks`` follow it."""
        super().__init__(simulation)
        self.simulation = simulation
        self._observer = observer_of(simulation, sinks)

    def _look(self) -> None:
        log = self._observer.log
        if log.due(self.simulation.now):
            self._observer.look(views(self.simulation, log.step))

    def _report(self, outcome: Outcome) -> SearchReport:
        simulation, now = self.simulation, self.simulation.now
        self._observer.finish(now, views(simulation, self._observer.log.step))
        curves = ideal(simulation.case, simulation.steps)
        return self._observer.report(outcome, simulation.clock.timing(now), now, curves)


def search(simulation: SearchSimulation, sinks: Sequence[Sink[SearchSnapshot]] = ()) -> SearchReport:
    """Run a search to its end; ``sinks`` follow it, and ``simulation.stop`` ends it in good order."""
    return SearchRun(simulation, sinks).run()


def observer_of(simulation: SearchSimulation, sinks: Sequence[Sink[SearchSnapshot]] = ()) -> SearchObserver:
    """Return an observer of a simulated search that has not begun."""
    truth = Hiding(simulation.hidden.at, simulation.vehicles.looks)
    return SearchObserver(simulation.team, simulation.setup.max_time, setting(simulation.setup), truth, sinks)


def views(simulation: SearchSimulation, step: int) -> list[SearchView]:
    """Return what can be told of every simulated vehicle at a step, and the first living one's pdf."""
    first = simulation.living[0] if simulation.living else 0
    return [_view(simulation, i, step, with_pdf=i == first) for i in range(len(simulation.names))]


def _view(simulation: SearchSimulation, i: int, step: int, with_pdf: bool) -> SearchView:
    mission, looks = simulation.missions[i], simulation.vehicles.looks[i].get(step)
    alive = bool(simulation.vehicles.alive[i])
    pose = looks[-1] if looks is not None else np.array(simulation.pose(i))
    path = ahead(flight(simulation, i), pose, simulation.case, i, step) if alive else NOWHERE
    goal = mission.strategy.goal if alive and mission.strategy is not None else None
    x, y, heading = pose.tolist()
    return SearchView(
        SearchSample(x, y, heading, state(simulation, i), alive, path, goal),
        mission.pdf(step) if with_pdf else None,
        mission.declared,
        figures(simulation, i, float(simulation.vehicles.travelled[i])),
    )

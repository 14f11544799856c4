"""A searching team as the operator sees it, by what its vehicles report."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from vedette.missions.search.assemble import SearchTeam
from vedette.net.report import Condition
from vedette.net.search.content import view_of
from vedette.net.team import Fates, Links, as_it_is, called_off
from vedette.outcome import Outcome
from vedette.record.figures import RobotFigures
from vedette.record.log import Floats, Sink
from vedette.record.search.curves import Curves
from vedette.record.search.log import SearchSample, SearchSnapshot
from vedette.record.search.observer import Hiding, SearchObserver, SearchReport, SearchView
from vedette.record.summary import Setting, Timing


class SearchWatcher:
    """``vedette.net.team.Watcher``."""

    def __init__(
        self,
        team: SearchTeam,
        duration: float,
        setting: Setting,
        place: Callable[[int], Floats],
        curves: Curves,
        sinks: Sequence[Sink[SearchSnapshot]] = (),
    ) -> None:
        """Prepare to watch a search of so long [s].

        ``place(step)``: the target's true place (2,); ``curves``: what is known of the search beforehand.
        """
        vehicles = team.case.scenario.vehicles
        self._looks: list[dict[int, Floats]] = [{} for _ in vehicles]
        self._observer = SearchObserver(team, duration, setting, Hiding(place, self._looks), sinks)
        self._prior, self._curves = team.case.pdf, curves
        self.period = 0.5 * team.case.scenario.step
        self._views = [
            SearchView(
                SearchSample(*vehicle.pose, "starting", True, np.empty((0, 2)), None),
                team.case.pdf,
                None,
                RobotFigures(),
            )
            for vehicle in vehicles
        ]

    def take(self, condition: Condition, content: bytes) -> None:
        """Take a vehicle's belief and looks."""
        view, looks = view_of(condition, content, self._prior)
        self._views[condition.robot] = view
        self._looks[condition.robot].update(looks)

    def look(self, now: float, fates: Fates, links: Links) -> None:
        """Measure the search, once a step; steps that nobody told of in time are measured late."""
        while self._observer.log.due(now):
            self._observer.look(self._seen(fates))

    def finish(self, now: float, fates: Fates, links: Links) -> None:
        """Measure how it ended."""
        self._observer.finish(now, self._seen(fates))

    def over(self, now: float, heard: Sequence[Condition], silent: bool) -> Outcome | None:
        """Tell whether somebody has declared the target found, or the operator has called all off."""
        if called_off(heard, silent):
            return Outcome.ORDERED
        found = any(view.declared is not None for view in self._views)
        return Outcome.COMPLETE if found else None

    def report(self, outcome: Outcome, timing: Timing, now: float) -> SearchReport:
        """Return what ``vedette search`` would."""
        return self._observer.report(outcome, timing, now, self._curves)

    def _seen(self, fates: Fates) -> list[SearchView]:
        return [
            replace(view, sample=as_it_is(view.sample, fate))
            for view, fate in zip(self._views, fates, strict=True)
        ]

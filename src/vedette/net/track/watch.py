"""A tracking team as the operator sees it, by what its vehicles report."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from vedette.missions.track.assemble import TrackTeam
from vedette.net.report import Condition
from vedette.net.team import Fates, Links, as_it_is, called_off
from vedette.net.track.content import view_of
from vedette.outcome import Outcome
from vedette.record.figures import RobotFigures
from vedette.record.log import Floats, Sink
from vedette.record.summary import Setting, Timing
from vedette.record.track.log import TrackSample, TrackSnapshot
from vedette.record.track.observer import TrackObserver, TrackReport, TrackView


class TrackWatcher:
    """``vedette.net.team.Watcher``."""

    def __init__(
        self,
        team: TrackTeam,
        name: str,
        setting: Setting,
        truth: Callable[[int], Floats],
        sinks: Sequence[Sink[TrackSnapshot]] = (),
    ) -> None:
        """Prepare to watch; ``truth(step)``: the targets' true states (T, 4)."""
        self._observer = TrackObserver(team, name, setting, truth, sinks)
        self._prior, self._duration = team.prior, team.scenario.duration
        self.period = 0.5 * team.scenario.step
        self._views = [
            TrackView(
                TrackSample(*vehicle.pose, "starting", True, np.empty((0, 2)), ()),
                team.prior,
                0,
                RobotFigures(),
            )
            for vehicle in team.scenario.vehicles
        ]

    def take(self, condition: Condition, content: bytes) -> None:
        """Take a vehicle's tracks."""
        self._views[condition.robot] = view_of(condition, content, self._prior)

    def look(self, now: float, fates: Fates, links: Links) -> None:
        """Measure the tracks, once a step; steps that nobody told of in time are measured late."""
        while self._observer.log.due(now):
            self._observer.look(self._seen(fates))

    def finish(self, now: float, fates: Fates, links: Links) -> None:
        """Measure how they are in the end."""
        self._observer.finish(self._seen(fates))

    def over(self, now: float, heard: Sequence[Condition], silent: bool) -> Outcome | None:
        """Tell whether the operator has called all off, or time is up; and who is there then."""
        if called_off(heard, silent):
            return Outcome.ORDERED
        if now < self._duration - 1e-9:
            return None
        return Outcome.UNHEARD if silent else Outcome.COMPLETE

    def report(self, outcome: Outcome, timing: Timing, now: float) -> TrackReport:
        """Return what ``vedette track`` would."""
        return self._observer.report(outcome, timing, now)

    def _seen(self, fates: Fates) -> list[TrackView]:
        return [
            replace(view, sample=as_it_is(view.sample, fate))
            for view, fate in zip(self._views, fates, strict=True)
        ]

"""What is seen of monitoring from outside, step by step, measured against the true field."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import inf

import numpy as np
from numpy.typing import NDArray

from vedette.domains.monitoring.belief import FieldBelief
from vedette.domains.monitoring.case import MonitorCase
from vedette.domains.monitoring.content import FieldContent, belief_of
from vedette.missions.flights import FlightTeam
from vedette.outcome import Outcome
from vedette.record.figures import TeamFigures
from vedette.record.flights import FlightObserver
from vedette.record.log import Sink
from vedette.record.monitor.log import MonitorLog, MonitorScene, MonitorSnapshot
from vedette.record.monitor.summary import MonitorQuality, MonitorSummary
from vedette.record.summary import Setting, Timing


@dataclass(frozen=True, eq=False)
class MonitorReport:
    """What a mission leaves: its figures, its log, how the field was in the end, and the others beside it."""

    summary: MonitorSummary
    timing: Timing
    log: MonitorLog
    truth: NDArray[np.float64]  # (R, C) in the end [unit]; where the field is ages, these [s]
    known: FieldBelief  # what was known in the end
    others: Mapping[str, MonitorLog] = field(default_factory=dict)  # by coordination


class MonitorObserver(FlightObserver[FieldContent, MonitorSnapshot, MonitorReport]):
    """Measures monitoring against the truth."""

    def __init__(
        self, team: FlightTeam[MonitorCase], setting: Setting, sinks: Sequence[Sink[MonitorSnapshot]] = ()
    ) -> None:
        """Prepare to observe a mission that has not begun."""
        case = team.case
        self.log: MonitorLog = MonitorLog(MonitorScene.of(case), sinks)
        super().__init__(self.log)
        self._team, self._case, self._setting = team, case, setting
        self._truth = case.truth(setting.seed)
        self._prior = FieldBelief.prior(case.model, case.spots, case.scenario.step)
        self._looked = np.zeros(case.scenario.frame.shape)  # when each cell was last [s]

    def snapshot(self) -> MonitorSnapshot:
        """Return the step that is logged next."""
        step, views = self.log.step, self.views
        time = step * self._case.scenario.step
        self._look_at(time)
        ages = time - self._looked
        snapshot = MonitorSnapshot(
            t=time,
            vehicles=tuple(view.sample for view in views),
            way=float(np.mean([view.figures.travelled_m for view in views])),
            worst_age=float(ages.max()),
            mean_age=float(ages.mean()),
        )
        if step % self.log.scene.every and time < self._case.scenario.duration - 1e-6:
            return snapshot
        known = self._known()
        error = (known.mean - self._truth.at(known.step)).ravel()
        return replace(
            snapshot,
            mean=known.mean.astype(np.float32),
            rmse=float(np.sqrt(np.mean(error**2))),
            entropy=known.entropy,
            nees=float(error @ (known.precision @ error) / len(error)),
        )

    def report(self, outcome: Outcome, timing: Timing, now: float) -> MonitorReport:
        """Return what the mission leaves."""
        scene, known, model = self.log.scene, self._known(), self._case.model
        figures, samples = zip(*((view.figures, view.sample) for view in self.views), strict=True)
        summary = MonitorSummary(
            completed=outcome.completed,
            outcome=outcome,
            scenario=scene.name,
            vehicles=len(scene.vehicles),
            time_s=now,
            cells=scene.frame.size,
            mean=model.mean,
            deviation=model.deviation,
            length_m=model.length,
            lasting_s=None if model.lasting == inf else model.lasting,
            **vars(self._setting),
            **self._team.options.told,
            **vars(MonitorQuality.of(self.log)),
            **vars(TeamFigures.of(scene.vehicles, figures, samples)),
        )
        truth = now - self._looked if scene.ages else self._truth.at(known.step)
        return MonitorReport(summary, timing, self.log, truth, known)

    def _known(self) -> FieldBelief:
        """Return the belief of the first vehicle that tells one; else what is known beforehand."""
        told = next((view.content for view in self.views if view.sample.alive and view.content), None)
        told = told or next((view.content for view in self.views if view.content), None)
        return self._prior if told is None else belief_of(told, self._prior)

    def _look_at(self, time: float) -> None:
        """Note which cells are looked at now."""
        frame = self.log.scene.frame
        for view, side in zip(self.views, self.log.scene.sides, strict=True):
            if view.sample.alive:
                row, col = frame.cell(view.sample.x, view.sample.y)
                half = side // 2
                self._looked[max(0, row - half) : row + half + 1, max(0, col - half) : col + half + 1] = time


def compared(report: MonitorReport, others: Mapping[str, MonitorReport], outcome: Outcome) -> MonitorReport:
    """Return the report of a mission with the other ways of coordination beside it."""
    logs = {name: other.log for name, other in others.items()}
    own = {report.summary.coordination: report.log}
    comparison = {name: MonitorQuality.of(each) for name, each in (own | logs).items()}
    summary = replace(report.summary, comparison=comparison, outcome=outcome, completed=outcome.completed)
    return replace(report, summary=summary, others=logs)

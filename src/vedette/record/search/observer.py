"""What is seen of a search from outside, step by step, measured against the true target.

Where the views come from makes no difference: from vehicles simulated in this process, or from what vehicles
on a network report.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from msgspec import structs

from vedette.agent.flight import Itinerary
from vedette.domains.search.belief import TargetPdf
from vedette.domains.search.prediction import Looks, Undetected
from vedette.missions.search.assemble import SearchTeam
from vedette.missions.search.case import SearchCase
from vedette.missions.search.searching import Declared, SearchPlan
from vedette.outcome import Outcome
from vedette.record.figures import RobotFigures, TeamFigures
from vedette.record.log import Floats, Sink
from vedette.record.search.curves import Curves
from vedette.record.search.log import SearchLog, SearchSample, SearchScene, SearchSnapshot
from vedette.record.search.summary import IdealSearch, Rule, SearchSummary
from vedette.record.summary import Setting, Timing


@dataclass(frozen=True, eq=False)
class SearchView:
    """All that can be told of one vehicle from outside; nothing in it changes after it is made."""

    sample: SearchSample
    pdf: TargetPdf | None  # as it knows it; None: only the first living vehicle's is looked at
    declared: Declared | None
    figures: RobotFigures


@dataclass(frozen=True, eq=False)
class Hiding:
    """The truth of a search: where the target is, and what has been looked at."""

    place: Callable[[int], Floats]  # of a step: the target's (2,) [m]
    looks: Looks  # that the vehicles have made so far


@dataclass(frozen=True, eq=False)
class SearchReport:
    """What a search leaves: its figures, its log and its curves."""

    summary: SearchSummary
    timing: Timing
    log: SearchLog
    curves: Curves


class SearchObserver:
    """Measures a search from views of its vehicles: it knows the truth, the agents do not."""

    def __init__(
        self,
        team: SearchTeam,
        duration: float,
        setting: Setting,
        truth: Hiding,
        sinks: Sequence[Sink[SearchSnapshot]] = (),
    ) -> None:
        """Prepare to observe a search that has not begun and may take so long [s]."""
        self._team, self._setting, self._truth = team, setting, truth
        self._undetected = Undetected(team.case.pdf, team.case.detectors)
        self._views: tuple[SearchView, ...] = ()  # of the last look
        self.log = SearchLog(SearchScene.of(team.case, duration), sinks)

    def look(self, views: Sequence[SearchView]) -> None:
        """Log the next step from views of all vehicles at it, in the order of the team."""
        self._views = tuple(views)
        step, case, truth = self.log.step, self._team.case, self._truth
        if step > 0:
            self._undetected.look(truth.looks)
        known = next(view.pdf for view in views if view.pdf is not None)
        x, y = truth.place(step).tolist()
        self.log.add(
            SearchSnapshot(
                t=step * case.pdf.dt,
                vehicles=tuple(view.sample for view in views),
                mass=known.mass.astype(np.float32),
                entropy=known.entropy,
                detection=self._undetected.detected,
                outside=known.outside if case.pdf.motion.leaves else None,
                target=(x, y),
            )
        )

    def finish(self, now: float, views: Sequence[SearchView]) -> None:
        """Take what the team has counted in the end; log the step in which the search ended."""
        self._views = tuple(views)
        if now >= self.log.step * self.log.scene.dt - 1e-6:
            self.look(views)

    def report(self, outcome: Outcome, timing: Timing, now: float, curves: Curves) -> SearchReport:
        """Return what the search leaves that ended at ``now`` [s]; ``curves``: what is known beforehand."""
        return SearchReport(self._summary(outcome, now, curves), timing, self.log, curves)

    def _summary(self, outcome: Outcome, now: float, curves: Curves) -> SearchSummary:
        scene, last, plan = self.log.scene, self.log.snapshots[-1], self._team.plan
        declared = first_declared([view.declared for view in self._views])
        by, place = (None, None) if declared is None else declared
        ended = ended_as(outcome, place, plan, self._truth.place)
        found = place is not None and ended is Outcome.FOUND
        at = None if place is None else (place.x, place.y)
        figures, samples = zip(*((view.figures, view.sample) for view in self._views), strict=True)
        return SearchSummary(
            completed=ended.completed,
            outcome=ended,
            scenario=scene.name,
            worth=self._team.case.scenario.worth,
            vehicles=len(scene.vehicles),
            time_s=now,
            found_s=place.time if found and place is not None else None,
            found_by=scene.vehicles[by] if found and by is not None else None,
            declared_m=at,
            target_m=last.target,
            error_m=None if at is None else float(np.hypot(*np.subtract(at, last.target))),
            declare=Rule(plan.threshold, plan.radius) if scene.false_alarms else None,
            detection_then=last.detection,
            outside_then=self._undetected.outside if self._team.case.pdf.motion.leaves else None,
            duration_s=float(curves.times[-1]),
            bound=IdealSearch.of(curves.times, curves.bound),
            koopman=IdealSearch.of(curves.times, curves.koopman),
            **vars(self._setting),
            **structs.asdict(structs.replace(self._team.options, scheme=self._team.options.negotiates_by)),
            **vars(TeamFigures.of(scene.vehicles, figures, samples)),
        )


def first_declared(declared: Sequence[Declared | None]) -> tuple[int, Declared] | None:
    """Return whose word counts, of what each vehicle declares, and that; a detection goes before a belief."""
    told = [(i, each) for i, each in enumerate(declared) if each is not None]
    return min(told, key=lambda each: (not each[1].certain, each[1].time, each[0]), default=None)


def ended_as(
    outcome: Outcome, found: Declared | None, plan: SearchPlan, place: Callable[[int], Floats]
) -> Outcome:
    """Return how a search ended: a declared place is right if the target is within the scenario's radius.

    A detection that cannot be a false alarm is always right.
    """
    if found is None or outcome is not Outcome.COMPLETE:
        return outcome
    x, y = place(plan.step(found.time)).tolist()
    near = np.hypot(found.x - x, found.y - y) <= plan.radius
    return Outcome.FOUND if found.certain or near else Outcome.MISTAKEN


def ahead(flight: Itinerary, pose: Floats, case: SearchCase, vehicle: int, step: int) -> Floats:
    """Return where a flight takes a vehicle as far as it is planned, in half steps, (k, 2) [m]."""
    dt = case.scenario.step
    return flight.ahead(pose, case.scenario.vehicles[vehicle].speed, step * dt, 0.5 * dt)

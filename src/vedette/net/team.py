"""A mission of agent processes, as the operator sees it: watched, recorded and brought to its end."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from vedette.domains.mapping.impact import ImpactCodec
from vedette.errors import InputError
from vedette.net.gather import DEAD, status_of, view_of
from vedette.net.inbox import Inbox
from vedette.net.launch import TeamPlan, TeamProcesses
from vedette.net.names import Topic, robot_name
from vedette.net.report import Condition, Spread
from vedette.net.transport import Operator, Published
from vedette.outcome import NO_PROGRESS, Outcome
from vedette.record.explore.log import ExploreSnapshot, RobotSample
from vedette.record.explore.observer import ExploreObserver, ExploreReport
from vedette.record.explore.views import GroundFigures, RobotView
from vedette.record.links import Link, links_of
from vedette.record.log import Sink
from vedette.record.summary import Setting, Timing
from vedette.record.summary import Spread as Statistics

STARTING = 60.0  # a robot that has not reported after so long is lost [s]
SILENT = 10.0  # one that reported before and has been silent for so long is not waited for [s]
DONE = "done"


@dataclass
class TeamWatch:
    """Watches the robots of a team until their mission is over."""

    plan: TeamPlan
    team: TeamProcesses
    operator: Operator
    max_time: float  # of the mission [s]
    sinks: Sequence[Sink[ExploreSnapshot]] = ()
    stopped: bool = False
    malformed: int = 0  # reports that did not make sense
    conditions: dict[int, Condition] = field(default_factory=dict)  # the latest, by robot
    _views: dict[int, RobotView] = field(default_factory=dict)
    _heard: dict[int, float] = field(default_factory=dict)  # when each robot last reported [s]
    _first: tuple[float, float] | None = None  # mission time when it was first known, and when [s]
    _moved: tuple[float, float] = (0.0, 0.0)  # way of all robots [m], and when it last grew [s]

    def stop(self) -> None:
        """End ``run`` soon; may be called from a signal handler."""
        self.stopped = True

    def run(self) -> ExploreReport:
        """Watch until the mission is over; return what ``vedette explore`` would.

        Raises:
            InputError: a robot's process ends by itself before the mission begins.
        """
        plan = self.plan
        observer = ExploreObserver(
            plan.world, plan.specs, plan.starts, plan.options, Setting(seed=plan.seed), self.sinks
        )
        self._codec = ImpactCodec(observer.log.scene.planning.size)
        inbox = self.operator.inbox
        self.operator.subscribe(Topic.REPORT, inbox.put)
        self._began, outcome, next_look = time.monotonic(), None, 0.0
        while outcome is None:
            self._hear(inbox, observer.period / plan.speed / 4)
            outcome = self._over()
            if self.now >= next_look or outcome is not None:
                observer.look(self.now, self._all_views(), self._links())
                next_look = self.now + observer.period
        observer.finish(self.now, self._all_views(), self._links())
        return observer.report(outcome, self._timing(time.monotonic() - self._began))

    @property
    def now(self) -> float:
        """Mission time since the first robot began [s]."""
        told = self.conditions.values()
        times = [each.time - each.began for each in told if each.began is not None]
        return max(times, default=0.0)

    def _hear(self, inbox: Inbox, timeout: float) -> None:
        event = inbox.get(timeout)
        while event is not None:
            if isinstance(event, Published):
                self._take(event.robot, event.payload)
            event = inbox.get(0.0)

    def _take(self, robot: int, payload: bytes) -> None:
        try:
            condition, view = view_of(payload, self.plan.world.frame, self._codec)
        except ValueError:
            self.malformed += 1
            return
        if condition.robot != robot or robot >= len(self.plan.specs):
            self.malformed += 1
            return
        self.conditions[robot] = condition
        self._views[robot] = view
        self._heard[robot] = time.monotonic()
        if self._first is None and self.now > 0.0:
            self._first = self.now, self._heard[robot]

    @property
    def failures(self) -> dict[int, str]:
        """What the robots said last whose processes have failed."""
        told = {i: self.team.failure(i) for i in range(len(self.plan.specs))}
        return {i: said for i, said in told.items() if said is not None}

    def _over(self) -> Outcome | None:
        """Tell how the mission has ended, if it has."""
        if self._first is None:
            for i, said in self.failures.items():
                raise InputError(f"{robot_name(i)} cannot take part: {said}")
        living = [i for i in range(len(self.plan.specs)) if self.team.runs(i)]
        if not living:
            return Outcome.TEAM_LOST
        if self.stopped:
            return Outcome.INTERRUPTED
        if self._starting:
            return None
        late = time.monotonic() - SILENT
        heard = [self.conditions[i] for i in living if self._heard.get(i, late) > late]
        if heard and all(each.state == DONE for each in heard):
            return Outcome.COMPLETE
        if self.now >= self.max_time:
            return Outcome.TIME_LIMIT
        way = sum(each.travelled for each in self.conditions.values())
        if way > self._moved[0] + 0.1:
            self._moved = way, self.now
        return Outcome.NO_PROGRESS if self.now > self._moved[1] + NO_PROGRESS else None

    @property
    def _starting(self) -> bool:
        """Tell whether living robots have not reported yet, and may still do so."""
        unheard = any(self.team.runs(i) and i not in self.conditions for i in range(len(self.plan.specs)))
        return unheard and time.monotonic() < self._began + STARTING

    def _all_views(self) -> list[RobotView]:
        return [self._view(i) for i in range(len(self.plan.specs))]

    def _view(self, i: int) -> RobotView:
        view = self._views.get(i) or self._unheard(i)
        if self.team.runs(i):
            return view
        return replace(view, sample=replace(view.sample, alive=False, state=DEAD))

    def _unheard(self, i: int) -> RobotView:
        x, y, heading = self.plan.starts[i].tolist()
        shape = self.plan.world.frame.shape
        sample = RobotSample(x, y, heading, "starting", True, np.empty((0, 2)), self.plan.specs[i].name, None)
        return RobotView(sample, np.zeros(shape, np.uint8), np.zeros(shape, np.bool_), None, GroundFigures())

    def _links(self) -> tuple[Link, ...] | None:
        """Return the links that both ends tell of; None: it is too early to say that one is missing."""
        if self._starting:
            return None
        told = [self.conditions.get(i) if self.team.runs(i) else None for i in range(len(self.plan.specs))]
        return links_of([None if each is None else status_of(each) for each in told])

    @property
    def _pace(self) -> float:
        """Mission time over wall time since the first robot began; 0 if none did."""
        if self._first is None:
            return 0.0
        return (self.now - self._first[0]) / max(time.monotonic() - self._first[1], 1e-3)

    def _timing(self, wall: float) -> Timing:
        """Return the figures of the robot that took longest, of each kind."""
        told = list(self.conditions.values())
        return Timing(
            planning_ms=_slowest([each.planning_ms for each in told]),
            answer_ms=_slowest([each.answer_ms for each in told]),
            round_ms=_slowest([each.round_ms for each in told]),
            real_time_factor=self._pace,
            wall_s=wall,
        )


def _slowest(spreads: Sequence[Spread | None]) -> Statistics | None:
    told = [each for each in spreads if each is not None]
    if not told:
        return None
    slowest = max(told, key=lambda each: each.p95)
    return Statistics(slowest.p50, slowest.p95, slowest.most)

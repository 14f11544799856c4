"""An exploring team as the operator sees it, by what its robots report."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace
from math import inf

import numpy as np

from vedette.agent.state import State
from vedette.domains.mapping.belief import planning_factor
from vedette.domains.mapping.impact import MapImpactCodec
from vedette.maps import GridFrame
from vedette.net.explore.content import view_of
from vedette.net.explore.frames import FramesSeen
from vedette.net.explore.plan import ExplorePlan
from vedette.net.report import Condition
from vedette.net.team import Fates, Links, as_it_is
from vedette.outcome import NO_PROGRESS, Agreement, Outcome
from vedette.record.explore.log import ExploreSnapshot, RobotSample
from vedette.record.explore.observer import ExploreObserver, ExploreReport
from vedette.record.explore.views import GroundFigures, RobotView
from vedette.record.log import Sink
from vedette.record.summary import Setting, Timing

MOVED = 0.1  # a team whose way grows by less makes no progress [m]


class ExploreWatcher:
    """``vedette.net.team.Watcher``."""

    def __init__(
        self, plan: ExplorePlan, setting: Setting, sinks: Sequence[Sink[ExploreSnapshot]] = ()
    ) -> None:
        """Prepare to watch; the ``sinks`` follow the mission."""
        shared = plan.lattice if plan.options.frames == "known" else None  # else all is laid on the world
        self._observer = ExploreObserver(
            plan.world, plan.specs, plan.starts, plan.options, setting, sinks, shared
        )
        self._frame = plan.lattice.frame
        self._codec = MapImpactCodec(self._frame.coarse(planning_factor(self._frame.resolution)).size)
        self._views = [
            unheard(spec.name, start, self._frame)
            for spec, start in zip(plan.specs, plan.starts.tolist(), strict=True)
        ]
        self._frames: FramesSeen | None = None if shared else FramesSeen(plan)
        self._ways: dict[int, float] = {}  # of each robot by now [m]
        self._agreement = Agreement()
        self._most_done = inf  # since when most are done [s]
        self._moved = (0.0, 0.0)  # way of all robots [m], and when it last grew [s]

    @property
    def period(self) -> float:
        """As the map's size allows [s]."""
        return self._observer.period

    def take(self, condition: Condition, content: bytes) -> None:
        """Take a robot's map."""
        name = self._views[condition.robot].sample.name  # as the team's file has it
        view = view_of(condition, content, self._frame, self._codec, name)
        if self._frames is not None:
            self._frames.take(condition, content)
        self._views[condition.robot] = view
        self._ways[condition.robot] = condition.travelled

    def look(self, now: float, fates: Fates, links: Links) -> None:
        """Measure the team's map."""
        self._observer.look(now, self._seen(now, fates), links)

    def finish(self, now: float, fates: Fates, links: Links) -> None:
        """Measure it as it is in the end."""
        self._observer.finish(now, self._seen(now, fates), links)

    def over(self, now: float, heard: Sequence[Condition], silent: bool) -> Outcome | None:
        """Tell whether all are done and agree, or nobody gets on."""
        if heard and all(each.state == State.DONE.value for each in heard):
            ended = self._agreement.reached(
                [each.digest for each in heard], [each.ending for each in heard], time.monotonic()
            )
            return Outcome.UNHEARD if silent else ended
        self._agreement.off()
        if self._are_left_alone(now, heard):
            return Outcome.UNJOINED
        way = sum(self._ways.values())
        if any(each.state == State.PAUSED.value for each in heard):  # somebody holds it there
            self._moved = self._moved[0], now
        if way > self._moved[0] + MOVED:
            self._moved = way, now
        return Outcome.NO_PROGRESS if now > self._moved[1] + NO_PROGRESS else None

    def _are_left_alone(self, now: float, heard: Sequence[Condition]) -> bool:
        """Tell whether most are done, and who is on maps that nothing joins with theirs has had its time."""
        done = [each for each in heard if each.state == State.DONE.value]
        if 2 * len(done) <= len(heard):
            self._most_done = inf
            return False
        self._most_done = min(self._most_done, now)
        late = now > max(2.0 * self._most_done, self._most_done + NO_PROGRESS)
        return late and any(each.ending == Outcome.UNJOINED.value for each in done)

    def report(self, outcome: Outcome, timing: Timing, now: float) -> ExploreReport:
        """Return what ``vedette explore`` would."""
        return self._observer.report(outcome, timing)

    def _seen(self, now: float, fates: Fates) -> list[RobotView]:
        views = [
            replace(view, sample=as_it_is(view.sample, fate))
            for view, fate in zip(self._views, fates, strict=True)
        ]
        if self._frames is None:
            return views
        views = self._frames.in_world(views)
        living = [robot for robot, fate in enumerate(fates) if fate is None]
        self._observer.frames = self._frames.look(now, views, living) or self._observer.frames
        return views


def unheard(name: str, start: Sequence[float], frame: GridFrame) -> RobotView:
    """Return what can be told of a robot that has told nothing, over a lattice with this frame."""
    x, y, heading = start
    sample = RobotSample(x, y, heading, "starting", True, np.empty((0, 2)), name, None)
    nothing, nowhere = np.zeros((0, 0), np.uint8), slice(0, 0)
    part = frame.window(nowhere, nowhere)
    return RobotView(sample, part, nothing, nothing.astype(np.bool_), None, GroundFigures(), 0)

"""A mission of agent processes, as the operator sees it: watched, recorded and brought to its end."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Generic, Protocol, TypeVar

from vedette.agent.state import State
from vedette.errors import InputError
from vedette.net.gather import status_of
from vedette.net.inbox import Inbox
from vedette.net.launch import TeamPlan, TeamProcesses
from vedette.net.names import Topic, robot_name
from vedette.net.report import Condition, SpreadReport, read_report
from vedette.net.transport import Operator, Published
from vedette.outcome import Outcome
from vedette.record.links import Link, links_of
from vedette.record.log import DEAD, LEFT, VehicleSample
from vedette.record.summary import Spread as Statistics
from vedette.record.summary import Timing

STARTING = 60.0  # a robot that has not reported after so long is lost [s]
SILENT = 10.0  # one that reported before and has been silent for so long is not waited for [s]
ReportT_co = TypeVar("ReportT_co", covariant=True)
SampleT = TypeVar("SampleT", bound=VehicleSample)
Links = Sequence[Link] | None
Fates = Sequence[str | None]
"""By robot: DEAD or LEFT, None while it takes part."""


def as_it_is(sample: SampleT, fate: str | None) -> SampleT:
    """Return what a robot last told of itself, with what has become of it since."""
    return sample if fate is None else replace(sample, alive=False, state=fate)


def called_off(heard: Sequence[Condition], silent: bool) -> bool:
    """Tell whether all who live are done by order; ``silent``: of some nothing is known."""
    ordered = (each.state == State.DONE.value and each.ending == Outcome.ORDERED.value for each in heard)
    return bool(heard) and not silent and all(ordered)


class Watcher(Protocol[ReportT_co]):
    """What the operator makes of the reports of one domain's robots; times are the mission's [s]."""

    @property
    def period(self) -> float:
        """How often to look [s]."""

    def take(self, condition: Condition, content: bytes) -> None:
        """Take a robot's report; ValueError if its content makes no sense."""

    def look(self, now: float, fates: Fates, links: Links) -> None:
        """Measure the mission; ``links`` None: it is too early to say that one is missing."""

    def finish(self, now: float, fates: Fates, links: Links) -> None:
        """Measure how it ended."""

    def over(self, now: float, heard: Sequence[Condition], silent: bool) -> Outcome | None:
        """Tell how the mission has ended, if it has, by the word of the living that were heard lately.

        ``silent``: others live, but are not heard.
        """

    def report(self, outcome: Outcome, timing: Timing, now: float) -> ReportT_co:
        """Return what the mission leaves."""


@dataclass
class TeamWatch(Generic[ReportT_co]):
    """Watches the robots of a team until their mission is over."""

    plan: TeamPlan
    team: TeamProcesses
    operator: Operator
    watcher: Watcher[ReportT_co]
    max_time: float  # of the mission [s]
    befall: Callable[[float], None] = lambda now: None  # does to the processes what is staged by a time [s]
    tell: Callable[[float], None] = lambda now: None  # tells the team what is ordered by a mission's time [s]
    stopped: bool = False
    malformed: int = 0  # reports that did not make sense
    conditions: dict[int, Condition] = field(default_factory=dict)  # the latest, by robot
    complaints: dict[tuple[int, int], str] = field(default_factory=dict)  # by who and of whom; the latest
    _heard: dict[int, float] = field(default_factory=dict)  # when each robot last reported [s]
    _first: tuple[float, float] | None = None  # mission time when it was first known, and when [s]

    def stop(self) -> None:
        """End ``run`` soon; may be called from a signal handler."""
        self.stopped = True

    def run(self) -> ReportT_co:
        """Watch until the mission is over; return what the same mission simulated would.

        Raises:
            InputError: a robot's process ends by itself before the mission begins.
        """
        inbox, watcher = self.operator.inbox, self.watcher
        self.operator.subscribe(Topic.REPORT, inbox.put)
        self._began, next_look = time.monotonic(), 0.0
        outcome: Outcome | None = None
        while outcome is None:
            self._hear(inbox, watcher.period / self.plan.speed / 4)
            self.befall(self.team.time)
            outcome = self._over()
            if self._first is not None:
                self.tell(self.now)
            if self._first is not None and self.now >= next_look:
                watcher.look(self.now, self._fates, self._links())
                next_look = self.now + watcher.period
        heard = self._heard_lately
        fates = [fate or (None if i in heard else DEAD) for i, fate in enumerate(self._fates)]
        watcher.finish(self.now, fates, self._links())
        return watcher.report(outcome, self._timing(time.monotonic() - self._began), self.now)

    @property
    def now(self) -> float:
        """Mission time [s]; without a shared clock since the first robot began."""
        told = self.conditions.values()
        if self.plan.shared_clock:
            return max((each.time for each in told), default=0.0)
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
            report = read_report(payload)
            if report.condition.robot != robot or robot >= self.plan.size:
                raise ValueError(f"report in the name of robot {report.condition.robot} from {robot}")
            self.watcher.take(report.condition, report.content)
        except ValueError:
            self.malformed += 1
            return
        self.conditions[robot] = report.condition
        self.complaints |= {(robot, each.robot): each.what for each in report.condition.complaints}
        self._heard[robot] = time.monotonic()
        if self._first is None and self.now > 0.0:
            self._first = self.now, self._heard[robot]

    @property
    def failures(self) -> dict[int, str]:
        """What the robots said last whose processes have failed."""
        told = {i: self.team.failure(i) for i in range(self.plan.size)}
        return {i: said for i, said in told.items() if said is not None}

    def _over(self) -> Outcome | None:
        """Tell how the mission has ended, if it has."""
        if self._first is None:
            for i, said in self.failures.items():
                raise InputError(f"{robot_name(i)} cannot take part: {said}")
        living = [i for i in range(self.plan.size) if self.team.runs(i)]
        if not living:
            return Outcome.TEAM_LOST
        if self.stopped:
            return Outcome.INTERRUPTED
        if self._starting:
            return None
        heard = [self.conditions[i] for i in self._heard_lately]
        outcome = self.watcher.over(self.now, heard, len(heard) < len(living))
        return Outcome.TIME_LIMIT if outcome is None and self.now >= self.max_time else outcome

    @property
    def _heard_lately(self) -> list[int]:
        """The robots that run and have reported lately."""
        late = time.monotonic() - SILENT
        return [i for i in range(self.plan.size) if self.team.runs(i) and self._heard.get(i, late) > late]

    @property
    def _fates(self) -> list[str | None]:
        """What has become of each robot: who ends in good order has said goodbye."""
        n = range(self.plan.size)
        return [None if self.team.runs(i) else LEFT if self.team.left(i) else DEAD for i in n]

    @property
    def _starting(self) -> bool:
        """Tell whether living robots have not reported yet, and may still do so."""
        unheard = any(self.team.runs(i) and i not in self.conditions for i in range(self.plan.size))
        return unheard and time.monotonic() < self._began + STARTING

    def _links(self) -> tuple[Link, ...] | None:
        """Return the links that both ends tell of; None: it is too early to say that one is missing."""
        if self._starting:
            return None
        told = [self.conditions.get(i) if self.team.runs(i) else None for i in range(self.plan.size)]
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


def _slowest(spreads: Sequence[SpreadReport | None]) -> Statistics | None:
    told = [each for each in spreads if each is not None]
    if not told:
        return None
    slowest = max(told, key=lambda each: each.p95)
    return Statistics(slowest.p50, slowest.p95, slowest.most)

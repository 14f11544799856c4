"""Teams of real agent processes over real sockets: faults at given moments, and what becomes of the team."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from math import inf
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import Timer
from types import TracebackType
from typing import Any, Self

import msgspec
import numpy as np

from tests.support.small_missions import robots
from vedette.maps.world import World
from vedette.missions.explore.options import ExploreOptions
from vedette.net.endpoints import free_port
from vedette.net.explore.plan import ExplorePlan
from vedette.net.explore.watch import ExploreWatcher
from vedette.net.launch import TeamProcesses
from vedette.net.names import Topic
from vedette.net.report import Condition, read_report
from vedette.net.team import TeamWatch
from vedette.net.transport import Operator, Published
from vedette.record.explore.log import ExploreSnapshot
from vedette.record.explore.observer import ExploreReport
from vedette.record.explore.views import RobotView
from vedette.record.summary import Setting
from vedette.sim.starts import choose_starts

SPEED = 5.0  # times real time
LEASE = 3.0  # [s]
UNTIL_AGREED = 10.0  # for the last evidence to come round [s]
SETTLED = 2.0  # for which robots that have settled are done [s]


def plan_of(world: World, count: int, speed: float = SPEED, lease: float = LEASE) -> ExplorePlan:
    """A team that starts together, as ``vedette team explore`` starts one with seed 0."""
    specs = robots(count)
    places = choose_starts(world, specs, np.random.default_rng([0, 1]))
    return ExplorePlan(world, specs, places, ExploreOptions(), 0, speed, lease)


@dataclass(frozen=True)
class Told:
    """What a robot said of itself, and when."""

    time: float  # of arrival [s]
    said: Condition


@dataclass
class Diary:
    """All that the robots of a team reported, and what befell them."""

    plan: ExplorePlan
    team: TeamProcesses
    by_robot: dict[int, list[Told]] = field(default_factory=dict)
    kept: list[tuple[float, str]] = field(default_factory=list)  # when what was done [s]

    def take(self, published: Published) -> None:
        """Keep a report, with the time at which it came."""
        told = Told(published.time, read_report(published.payload).condition)
        self.by_robot.setdefault(published.robot, []).append(told)

    def last(self, robot: int) -> Condition:
        """The latest that a robot said."""
        return self.by_robot[robot][-1].said

    def pid(self, robot: int) -> int:
        """The process of a robot."""
        return self.team.processes[robot].pid

    def heard(self, robot: int) -> bool:
        """Tell whether a robot has reported."""
        return bool(self.by_robot.get(robot))

    def agree(self, robots: Sequence[int]) -> bool:
        """Tell whether these said last that they hold the same evidence."""
        return len({self.last(i).digest for i in robots}) == 1

    def settled(self, robots: Sequence[int]) -> bool:
        """Tell whether these are done, have been so for a while, and hold the same evidence."""
        if not all(map(self.heard, robots)) or not self.agree(robots):
            return False
        late = time.monotonic() - SETTLED
        return all(told.said.state == "done" for i in robots for told in self.by_robot[i] if told.time > late)

    def done_at(self, robot: int) -> float:
        """Mission time at which a robot was done, for good [s]; infinite if it is not."""
        at = inf
        for told in reversed(self.by_robot.get(robot, [])):
            if told.said.state != "done":
                break
            at = told.said.time - (told.said.began or 0.0)
        return at

    def named_at(self, robots: Sequence[int], culprit: int) -> float:
        """When one of these first complained of another, since all had reported [s]; infinite if never."""
        began = max(self.by_robot[i][0].time for i in robots)
        named = (
            told.time
            for i in robots
            for told in self.by_robot[i]
            if any(each.robot == culprit for each in told.said.complaints)
        )
        return max(min(named, default=inf) - began, 0.0)


@dataclass(frozen=True)
class Fault:
    """Something that befalls the team once, when the coverage of its map reaches a share."""

    coverage: float
    what: str
    strike: Callable[[Diary], None]


def kill(find: Callable[[Diary], int]) -> Callable[[Diary], None]:
    """``kill -9`` of the robot that ``find`` names."""

    def strike(diary: Diary) -> None:
        os.kill(diary.pid(find(diary)), signal.SIGKILL)

    return strike


def terminate(robot: int) -> Callable[[Diary], None]:
    """SIGTERM."""
    return lambda diary: os.kill(diary.pid(robot), signal.SIGTERM)


def restart(robot: int) -> Callable[[Diary], None]:
    """``kill -9``, and a start with empty memory."""

    def strike(diary: Diary) -> None:
        os.kill(diary.pid(robot), signal.SIGKILL)
        diary.team.processes[robot].wait()
        diary.team.restart(robot)

    return strike


def freeze(find: Callable[[Diary], int], seconds: float = inf) -> Callable[[Diary], None]:
    """SIGSTOP of the robot that ``find`` names, and SIGCONT after a while [s]."""

    def strike(diary: Diary) -> None:
        pid = diary.pid(find(diary))
        os.kill(pid, signal.SIGSTOP)
        if seconds < inf:
            Timer(seconds, os.kill, (pid, signal.SIGCONT)).start()

    return strike


@dataclass
class Doubled(TeamProcesses):
    """The last robot's number is started twice, the second time with links to all others."""

    def __enter__(self) -> Self:
        """Start the double last."""
        super().__enter__()
        last = self.plan.size - 1
        config = msgspec.yaml.decode(self._file_of(last).read_text())
        config["links"] |= {"listen": [f"tls/127.0.0.1:{free_port()}"], "connect": self.endpoints[:last]}
        double = self.folder / "double.yaml"
        double.write_text(msgspec.yaml.encode(config).decode())
        command = [str(double) if part == str(self._file_of(last)) else part for part in self._command(last)]
        self._double = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Stop the double too."""
        self._double.kill()
        self._double.wait()
        super().__exit__(kind, error, trace)


@dataclass
class Chain(TeamProcesses):
    """Each robot reaches the one before it and the one after it alone."""

    def _links(self, i: int) -> dict[str, Any]:
        return super()._links(i) | {"connect": self.endpoints[i - 1 : i] if i else []}


@dataclass
class Ring(TeamProcesses):
    """As a chain, and the last one and the first one reach each other too."""

    def _links(self, i: int) -> dict[str, Any]:
        return super()._links(i) | {"connect": [self.endpoints[(i + 1) % len(self.endpoints)]]}


def misbehaving(mode: str, who: int, kind: type[TeamProcesses] = TeamProcesses) -> type[TeamProcesses]:
    """A team of a kind, one of whose robots misbehaves: ``tests.support.bad_agent``."""

    class Team(kind):  # type: ignore[misc,valid-type]
        def _command(self, i: int) -> list[str]:
            command: list[str] = super()._command(i)
            if i != who:
                return command
            return [sys.executable, "-m", "tests.support.bad_agent", mode, *command[3:]]

    return Team


@dataclass
class _Fate:
    """Strikes while the mission goes on; ``vedette.record.explore.log.Sink``."""

    diary: Diary
    faults: list[Fault]
    enough: Sequence[int] | None  # the mission is over when these have settled
    stop: Callable[[], None] = lambda: None  # ends the mission

    def update(self, snapshot: ExploreSnapshot) -> None:
        """Let the next fault come when it is due; the first, once all robots have reported."""
        if self.enough is not None and self.diary.settled(self.enough):
            self.stop()
        if len(self.diary.by_robot) < len(snapshot.robots):
            return
        while self.faults:
            assert snapshot.coverage is not None, "the ground is known"
            if snapshot.coverage < self.faults[0].coverage:
                return
            fault = self.faults.pop(0)
            self.diary.kept.append((time.monotonic(), fault.what))
            fault.strike(self.diary)


@dataclass(frozen=True)
class Mission:
    """How a mission went."""

    report: ExploreReport
    diary: Diary
    ended: float  # [s]
    survivors: list[int]  # whose processes ran at the end
    views: Sequence[RobotView]  # as it ended

    @property
    def struck(self) -> float:
        """When the first fault came [s]."""
        return self.diary.kept[0][0]

    @property
    def recovery(self) -> Recovery:
        """What the first fault cost the survivors."""
        return self.recovery_of(self.survivors)

    def recovery_of(self, robots: Sequence[int]) -> Recovery:
        """What the first fault cost these."""
        return recovery(self.diary, self.struck, robots)


def run(
    plan: ExplorePlan,
    logs: Path,
    faults: Sequence[Fault] = (),
    team: Callable[[ExplorePlan, Path, Path], TeamProcesses] = TeamProcesses,
    max_time: float = 900.0,
    rest: float = 0.0,
    enough: Sequence[int] | None = None,
) -> Mission:
    """Run a team to the end of its mission, or for ``max_time`` of it [s], or until ``enough`` have settled.

    It goes on until the maps of those that live agree, and for ``rest`` [s] in any case.
    """
    with ExitStack() as stack:
        folder = stack.enter_context(TemporaryDirectory(prefix="vedette-test-"))
        processes = stack.enter_context(team(plan, Path(folder), logs))
        operator = stack.enter_context(Operator(processes.operator))
        diary = Diary(plan, processes)
        operator.subscribe(Topic.REPORT, diary.take)
        fate = _Fate(diary, sorted(faults, key=lambda fault: fault.coverage), enough)
        watcher = ExploreWatcher(plan, Setting(seed=plan.seed), (fate,))
        watch = TeamWatch(plan, processes, operator, watcher, max_time)
        fate.stop = watch.stop
        report = watch.run()
        ended = time.monotonic()
        living = [i for i in range(len(plan.specs)) if processes.runs(i)]
        while (
            report.summary.completed and not diary.agree(living) and time.monotonic() < ended + UNTIL_AGREED
        ):
            time.sleep(0.05)
        time.sleep(rest)
    return Mission(report, diary, ended, living, watcher._views)


# -- how fast a team gets over a loss --------------------------------------------------------------------


@dataclass(frozen=True)
class Recovery:
    """What a loss cost; times since it, by the clocks of the processes, which are one on one host [s]."""

    noticed: float  # until the first robot was on a new tree
    replanned: float  # until a round on a new tree had ended for all survivors
    overlay_bytes: float  # sent by all survivors in the 5 s since


def overlay_rate(diary: Diary, since: float, links: int) -> float:
    """Return what the overlay of a team at rest sends on a link, both ways together [B/s]."""
    total = 0.0
    for told in diary.by_robot.values():
        at_rest = [each for each in told if each.time >= since]
        first, last = at_rest[0], at_rest[-1]
        total += (last.said.bytes["overlay"] - first.said.bytes["overlay"]) / (last.time - first.time)
    return total / links


def recovery(diary: Diary, struck: float, survivors: Sequence[int]) -> Recovery:
    """Return what a loss at a time cost those that survived; infinite where it never came."""
    before = {i: _at(diary, i, struck) for i in survivors}
    noticed = [_first_tree(diary, i, struck, before[i]) for i in survivors]
    replanned = [_first_round(diary, i, struck, before[i]) for i in survivors]
    spent = (_at(diary, i, struck + 5.0).bytes["overlay"] - before[i].bytes["overlay"] for i in survivors)
    return Recovery(min(noticed) - struck, max(replanned) - struck, float(sum(spent)))


def _at(diary: Diary, robot: int, moment: float) -> Condition:
    return [told.said for told in diary.by_robot[robot] if told.time <= moment][-1]


def _since(diary: Diary, robot: int, struck: float, before: Condition) -> list[Told]:
    """Return what a robot said on new trees after a loss."""
    return [
        told for told in diary.by_robot[robot] if told.time > struck and told.said.number != before.number
    ]


def _first_tree(diary: Diary, robot: int, struck: float, before: Condition) -> float:
    return min((told.time - told.said.age for told in _since(diary, robot, struck, before)), default=inf)


def _first_round(diary: Diary, robot: int, struck: float, before: Condition) -> float:
    """Return when a robot had decided on a new tree [s]."""
    for told in _since(diary, robot, struck, before):
        if told.said.decided is not None and told.said.decided < told.said.age:
            return told.time - told.said.decided
    return inf


def root(diary: Diary) -> int:
    """The robot that a living one takes for the root."""
    return _roles(diary)[0]


def leaf(diary: Diary) -> int:
    """A robot with one neighbour on the tree that is not the root."""
    return _roles(diary)[2]


def inner(diary: Diary) -> int:
    """A robot that is neither the root nor a leaf; the root, if there is none."""
    return _roles(diary)[1]


def _roles(diary: Diary) -> tuple[int, int, int]:
    said = [diary.last(i) for i in sorted(diary.by_robot)]
    roots = [each.robot for each in said if each.parent is None]
    leaves = [each.robot for each in said if len(each.neighbours) == 1 and each.parent is not None]
    inners = [each.robot for each in said if len(each.neighbours) > 1 and each.parent is not None]
    return roots[0], (inners or roots)[0], leaves[0]

"""Teams of real agent processes in strangers' robots, over real rclpy."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import msgspec
import numpy as np

from tests.support.small_missions import covered, robots
from vedette.maps import UNKNOWN
from vedette.maps.world import World
from vedette.missions.explore.options import ExploreOptions
from vedette.net.explore.ros2_plan import ROBOTS, Ros2Plan, environment, strangers
from vedette.net.explore.watch import ExploreWatcher
from vedette.net.launch import TeamProcesses
from vedette.net.team import TeamWatch
from vedette.net.transport import Operator
from vedette.outcome import Outcome
from vedette.record.explore.observer import ExploreReport
from vedette.record.summary import Setting
from vedette.sim.starts import choose_starts


@dataclass(frozen=True, eq=False)
class TriedPlan(Ros2Plan):
    """A team of which robots have oddities, and files say so."""

    oddities: Mapping[int, Mapping[str, Any]] = field(default_factory=dict)  # by robot, from 0
    settings: Mapping[int, Mapping[str, Any]] = field(default_factory=dict)  # of body.ros2, likewise

    def write(self, folder: Path) -> None:
        """Write what the plan does, and the oddities."""
        super().write(folder)
        told = msgspec.yaml.decode((folder / ROBOTS).read_bytes())
        for robot, odd in self.oddities.items():
            told["robots"][robot] |= dict(odd)
        (folder / ROBOTS).write_bytes(msgspec.yaml.encode(told))

    def config(self, i: int, pose: Any) -> dict[str, Any]:
        """Return what the plan does, and the settings."""
        told = super().config(i, pose)
        told["body"]["ros2"] |= dict(self.settings.get(i, {}))
        return told


@dataclass(frozen=True)
class Tried:
    """How a team did."""

    report: ExploreReport
    plan: TriedPlan
    robots_said: str  # by the strangers, in the end

    @property
    def wrong(self) -> float:
        """Share of the known cells that are other ones in truth."""
        told, true = self.report.classes, self.plan.world.classes()
        known = told != UNKNOWN
        return float(np.mean(told[known] != true[known]))

    @property
    def covered(self) -> float:
        """Share of the cells known that the team could see."""
        return covered(self.plan.world, self.plan.specs, self.plan.starts, self.report)


def plan(world: World, count: int, speed: float = 3.0, frames: str = "known", **told: Any) -> TriedPlan:
    """A team that starts together."""
    specs = robots(count)
    starts = choose_starts(world, specs, np.random.default_rng([0, 1]))
    return TriedPlan(world, specs, starts, ExploreOptions(frames=frames), 0, speed, 3.0, **told)


WRONG = 0.005  # of the known cells may be other ones in truth
TRIED = 240  # a test may take so long [s]
DOMAIN = os.getpid() % 100  # of ROS, for this process's tests


@contextmanager
def living(
    plan: TriedPlan, folder: Path, team: type[TeamProcesses] = TeamProcesses
) -> Iterator[TeamProcesses]:
    """Let robots and their agents live, apart from all others on this host."""
    private, logs = folder / "private", folder / "logs"
    private.mkdir()
    around = environment(DOMAIN)
    plan.write(private)
    with ExitStack() as stack:
        stack.enter_context(strangers(private, logs / "robots.log", plan.speed, around))
        yield stack.enter_context(team(plan, private, logs, None, around))


def tried(
    plan: TriedPlan,
    folder: Path,
    max_time: float = 400.0,
    team: type[TeamProcesses] = TeamProcesses,
    befall: Callable[[float], None] = lambda now: None,
) -> Tried:
    """Let a team explore to the end; ``befall`` does what is to happen by a mission's time [s]."""
    with ExitStack() as stack:
        processes = stack.enter_context(living(plan, folder, team))
        operator = stack.enter_context(Operator(processes.operator))
        watcher = ExploreWatcher(plan, Setting(seed=0))
        watch = TeamWatch(plan, processes, operator, watcher, max_time)
        watch.befall = lambda now: befall(watch.now)
        report = watch.run()
    return Tried(report, plan, (folder / "logs" / "robots.log").read_text())


def sound(ended: Tried, robots: int, outcome: Outcome = Outcome.COMPLETE) -> None:
    """Hold a team to a whole and true map, and to no collision."""
    summary = ended.report.summary
    assert summary.outcome is outcome, (summary, ended.robots_said)
    assert summary.coverage is None  # the robots do not know how large the building is
    assert ended.covered >= 0.99
    assert ended.wrong <= WRONG, ended.wrong
    assert ended.robots_said.count("collided: False") == robots, ended.robots_said

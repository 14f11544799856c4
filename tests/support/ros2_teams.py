"""Teams of real agent processes in strangers' robots, over real rclpy."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
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
from vedette.record.explore.observer import ExploreReport
from vedette.record.summary import Setting
from vedette.sim.starts import choose_starts


@dataclass(frozen=True, eq=False)
class TriedPlan(Ros2Plan):
    """A team of which robots have oddities, and files say so."""

    oddities: Mapping[int, Mapping[str, Any]] = field(default_factory=dict)  # by robot, from 0
    settings: Mapping[str, Any] = field(default_factory=dict)  # of every agent's body.ros2

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
        told["body"]["ros2"] |= dict(self.settings)
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


def plan(world: World, count: int, speed: float = 3.0, **told: Any) -> TriedPlan:
    """A team that starts together."""
    specs = robots(count)
    starts = choose_starts(world, specs, np.random.default_rng([0, 1]))
    return TriedPlan(world, specs, starts, ExploreOptions(), 0, speed, 3.0, **told)


DOMAIN = os.getpid() % 100  # of ROS, for this process's tests


@contextmanager
def living(plan: TriedPlan, folder: Path) -> Iterator[TeamProcesses]:
    """Let robots and their agents live, apart from all others on this host."""
    private, logs = folder / "private", folder / "logs"
    private.mkdir()
    around = environment(DOMAIN)
    plan.write(private)
    with ExitStack() as stack:
        stack.enter_context(strangers(private, logs / "robots.log", plan.speed, around))
        yield stack.enter_context(TeamProcesses(plan, private, logs, None, around))


def tried(plan: TriedPlan, folder: Path, max_time: float = 300.0) -> Tried:
    """Let a team explore to the end."""
    with ExitStack() as stack:
        team = stack.enter_context(living(plan, folder))
        operator = stack.enter_context(Operator(team.operator))
        watcher = ExploreWatcher(plan, Setting(seed=0))
        report = TeamWatch(plan, team, operator, watcher, max_time).run()
    return Tried(report, plan, (folder / "logs" / "robots.log").read_text())

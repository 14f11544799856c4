"""A team of agent processes that a command starts: watched, shown, staged, and brought to its end."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import dataclass
from functools import wraps
from pathlib import Path
from shutil import rmtree
from tempfile import TemporaryDirectory
from typing import Any

import click

from vedette.cli.options import Positive, orders_option, with_options
from vedette.cli.running import ReportT
from vedette.cli.staging import Stage
from vedette.cli.windows import opened
from vedette.errors import InputError
from vedette.interrupt import ending_on_ctrl_c
from vedette.missions.sense import Grounds
from vedette.net.explore.ros2_plan import Ros2Plan, environment, strangers
from vedette.net.feed import Onlooker, TeamFeed
from vedette.net.giving import Giving
from vedette.net.launch import TeamPlan, TeamProcesses
from vedette.net.names import robot_name
from vedette.net.team import TeamWatch, Watcher
from vedette.net.transport import Operator
from vedette.record.folder import OutputFolder
from vedette.run.inputs import orders_in, schedule_of
from vedette.sim.faults import Schedule, faults_text
from vedette.sim.orders import OrderAt, check_flight_orders
from vedette.window.hub import Hub
from vedette.window.picture import said

SPEED = 3.0  # more costs mission time, as thoughts and messages take as long as ever: 5 % at 5, 16 % at 10
KEPT_UP = 0.8  # of the speed asked for; less is worth a remark


@dataclass(frozen=True)
class Processes:
    """How the processes of a team run, and what befalls them."""

    speed: float  # of the mission, in seconds a second
    lease: float  # [s] of real time
    faults: str | None
    orders: Path | None
    watch: bool

    def run(
        self, plan: TeamPlan, max_time: float, onlooker: Onlooker[Any, Any], orders: tuple[OrderAt, ...]
    ) -> TeamRun:
        """Return the team that is to be started, for so long at most [s]."""
        schedule = schedule_of(self.faults, plan.size, clocks=False)
        return TeamRun(plan, max_time, schedule, onlooker, self.watch, orders)

    def fly(self, plan: TeamPlan, max_time: float, onlooker: Onlooker[Any, Any], grounds: Grounds) -> TeamRun:
        """Return a team of vehicles likewise, whose orders can be about these grounds."""
        orders = orders_in(self.orders)
        check_flight_orders(orders, grounds, str(self.orders))
        return self.run(plan, max_time, onlooker, orders)


def process_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """``--orders``, ``--speed``, ``--lease``, ``--faults`` and ``--watch``, all as one `Processes`."""

    @wraps(command)
    def taken(
        speed: float, lease: float, faults: str | None, orders: Path | None, watch: bool, **others: Any
    ) -> Any:
        return command(processes=Processes(speed, lease, faults, orders, watch), **others)

    return with_options(
        taken,
        orders_option,
        click.option(
            "--speed", type=Positive("times real time", most=50.0), default=SPEED, show_default=True,
            help="Of the mission, in seconds a second; too much for this host makes robots think slowly.",
        ),
        click.option(
            "--lease", type=Positive("s", least=0.2, most=60.0), default=3.0, show_default=True,
            help="A neighbour silent for so long is given up [s of real time].",
        ),
        click.option(
            "--faults", metavar="FILE|SEED",
            help="What befalls processes and links: a schedule or its seed.",
        ),
        click.option("--watch", is_flag=True, help="Show it in a browser, where orders can be given too."),
    )  # fmt: skip


@dataclass(frozen=True)
class TeamRun:
    """A team that is to be started."""

    plan: TeamPlan
    max_time: float  # [s]
    schedule: Schedule | None  # of faults
    onlooker: Onlooker[Any, Any]  # makes a page's pictures
    watch: bool  # whether there is one
    orders: tuple[OrderAt, ...]  # of the operator, in order of time

    def watched_by(self, watcher: Watcher[ReportT], folder: OutputFolder) -> ReportT:
        """Run the team to the end of its mission; what it says goes into the folder, if it starts."""
        logs = folder / "agents"
        were_there = logs.exists()
        try:
            return self._run(watcher, logs)
        except InputError:
            if not were_there:
                rmtree(logs, ignore_errors=True)
            raise

    def _run(self, watcher: Watcher[ReportT], logs: Path) -> ReportT:
        text = None if self.schedule is None else faults_text(self.schedule)
        with ExitStack() as stack:
            secrets = stack.enter_context(TemporaryDirectory(prefix="vedette-team-"))
            private, around = Path(secrets), {}
            if isinstance(self.plan, Ros2Plan):
                around = environment()
                self.plan.write(private)
                stack.enter_context(strangers(private, logs / "robots.log", self.plan.speed, around))
            team = TeamProcesses(self.plan, private, logs, text, around)
            processes = stack.enter_context(team)
            operator = stack.enter_context(Operator(processes.operator))
            if self.watch:
                feed = TeamFeed(operator, processes.operator, self.onlooker, logs)
                hub = Hub(processes.operator.team, feed.give)
                stack.enter_context(opened(hub))
                stack.enter_context(feed.followed(hub))
            watch = TeamWatch(self.plan, processes, operator, watcher, self.max_time)
            if self.schedule is not None:
                watch.befall = Stage(self.schedule, processes, watch).befall
            watch.tell = _Telling(
                Giving(operator, processes.operator, self.onlooker.name), watch, list(self.orders)
            ).tell
            stack.enter_context(ending_on_ctrl_c(watch.stop))
            report = watch.run()
        for line in _remarks(watch, report.timing.real_time_factor, self.plan.speed):
            click.echo(f"vedette: {line}", err=True)
        return report


@dataclass(frozen=True)
class _Telling:
    """Gives a team what an operator has written down, each order at its time, and says what comes of it."""

    giving: Giving
    watch: TeamWatch[Any]
    orders: list[OrderAt]  # that have not been given

    def tell(self, now: float) -> None:
        """Give what is due at a time of the mission [s]."""
        while self.orders and self.orders[0].at <= now:
            order = self.orders.pop(0).what
            try:
                told = self.watch.plan.as_told(order)
                answer = self.giving.give(told, list(self.watch.conditions.values()))
            except InputError as error:
                answer = f"refused: {error}"
            click.echo(f"{now:7.1f} s  order {said(order)}: {answer}", err=True)


def _remarks(watch: TeamWatch[Any], pace: float, speed: float) -> Iterator[str]:
    """Say what else whoever started the team should know."""
    for robot, last in watch.failures.items():
        yield f"{robot_name(robot)} failed: {last}; see {watch.team.log_of(robot)}"
    for (robot, other), what in sorted(watch.complaints.items()):
        yield f"{robot_name(robot)} of {robot_name(other)}: {what}"
    if 0 < pace < KEPT_UP * speed:
        yield f"this host kept up {pace:.1f} times real time; robots think better at a --speed below"

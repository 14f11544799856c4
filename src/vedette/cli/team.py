"""``vedette team``: a team of agent processes on this host."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from math import floor
from pathlib import Path
from tempfile import TemporaryDirectory
from types import FrameType
from typing import Any, Protocol, TypeVar

import click
import numpy as np

from vedette.cli import exploring, searching, tracking
from vedette.cli.exploring import exploring_options, inputs_of, team_of, world_of
from vedette.cli.options import (
    Positive,
    end,
    ending_on_ctrl_c,
    output_options,
    parse_faults,
    with_options,
)
from vedette.cli.searching import case_of, searching_options
from vedette.cli.staging import Stage
from vedette.cli.tracking import scenario_of, tracking_options
from vedette.errors import InputError
from vedette.missions.explore.options import ExploreOptions
from vedette.missions.search.assemble import SearchTeam
from vedette.missions.search.options import SearchOptions
from vedette.missions.track.assemble import TrackTeam
from vedette.missions.track.options import TrackOptions
from vedette.net.explore.plan import ExplorePlan
from vedette.net.explore.watch import ExploreWatcher
from vedette.net.flights import FlightsPlan
from vedette.net.launch import TeamPlan, TeamProcesses
from vedette.net.names import robot_name
from vedette.net.search.watch import SearchWatcher
from vedette.net.team import TeamWatch, Watcher
from vedette.net.track.watch import TrackWatcher
from vedette.net.transport import Operator
from vedette.record.explore.live import ExploreDisplay
from vedette.record.explore.log import ExploreScene
from vedette.record.explore.mcap import ExploreMcapWriter
from vedette.record.folder import OutputFolder
from vedette.record.search.curves import ideal
from vedette.record.search.live import search_display
from vedette.record.search.log import SearchScene
from vedette.record.search.mcap import SearchMcapWriter
from vedette.record.summary import Setting, Timing
from vedette.record.track.live import track_display
from vedette.record.track.log import TrackScene
from vedette.record.track.mcap import TrackMcapWriter
from vedette.sim.faults import Schedule, faults_text
from vedette.sim.search.hidden import Hidden
from vedette.sim.starts import choose_starts
from vedette.sim.track.targets import Targets

SPEED = 3.0  # more costs mission time, as thoughts and messages take as long as ever: 5 % at 5, 16 % at 10
KEPT_UP = 0.8  # of the speed asked for; less is worth a remark
_ENDINGS = (signal.SIGTERM, signal.SIGHUP)
CommandT = TypeVar("CommandT", bound=Callable[..., Any])


def process_options(command: CommandT) -> CommandT:
    """``--speed``, ``--lease`` and ``--faults``."""
    return with_options(
        command,
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
    )  # fmt: skip


@click.group()
def team() -> None:
    """Start a team of agent processes on this host and watch it."""


@team.command()
@exploring_options
@process_options
@output_options
def explore(
    map_path: Path | None,
    resolution: float | None,
    robots: int | None,
    team: Path | None,
    starts: str | None,
    seed: int,
    planner: str,
    scheme: str,
    fusion: str,
    max_time: float,
    return_home: bool,
    speed: float,
    lease: float,
    faults: str | None,
    out: Path | None,
    force: bool,
    as_json: bool,
    animate: bool,
) -> None:
    """Let a team of agent processes explore MAP: one process a robot, linked by mutual TLS here.

    Keys are made for the occasion. MAP and the outputs are as for `vedette explore`. Every robot simulates
    its own body. Exit status: 0 complete, 1 incomplete, 2 bad input, 130 interrupted.
    """
    world = world_of(map_path, resolution, seed)
    specs = team_of(team, robots, starts)
    places = choose_starts(world, specs, np.random.default_rng([seed, 1]))
    options = ExploreOptions(planner, scheme, fusion, return_home)
    plan = ExplorePlan(world, specs, places, options, seed, speed, lease)
    schedule = parse_faults(faults, plan.size, clocks=False)
    scene = ExploreScene.of(world, [spec.name for spec in specs])
    with OutputFolder.make(out, force, world.name, inputs_of(map_path, team, faults)) as folder:
        with ExitStack() as sinks:
            live = sinks.enter_context(ExploreDisplay(scene, as_json))
            mcap = sinks.enter_context(ExploreMcapWriter(lambda: folder / "run.mcap", scene))
            watcher = ExploreWatcher(plan, Setting(seed=seed, faults=faults), (live, mcap, folder))
            report = _run(plan, watcher, max_time, schedule, folder / "agents")
        exploring.write_outputs(report, world, folder, animate)
        closed = exploring.closing(report.summary, folder.path)
    end(report.summary, closed, as_json)


@team.command()
@tracking_options
@process_options
@output_options
def track(
    scenario_path: Path | None,
    seed: int,
    coordination: str,
    scheme: str,
    fusion: str,
    objective: str | None,
    continuous: bool,
    max_time: float | None,
    speed: float,
    lease: float,
    faults: str | None,
    out: Path | None,
    force: bool,
    as_json: bool,
    animate: bool,
) -> None:
    """Let a team of agent processes follow the targets of SCENARIO: one process a vehicle.

    SCENARIO and the outputs are as for `vedette track`, the comparison left out. Exit status: 0 complete,
    1 incomplete, 2 bad input, 130 interrupted.
    """
    if coordination == "optimum":
        raise InputError("--coordination optimum: nobody on a network can work it out; see `vedette track`")
    scenario, name = scenario_of(scenario_path)
    options = TrackOptions(coordination, scheme, fusion, objective, continuous)
    plan = FlightsPlan("track", options, scenario_path, len(scenario.vehicles), seed, speed, lease)
    vehicles = TrackTeam(scenario, options, plan.times)
    schedule = parse_faults(faults, plan.size, clocks=False)
    scene, truth = TrackScene.of(scenario, name), Targets.of(vehicles, seed)
    limit = scenario.duration + 1.0 if max_time is None else max_time
    with OutputFolder.make(out, force, name, tracking.inputs_of(scenario_path, faults)) as folder:
        with ExitStack() as sinks:
            live = sinks.enter_context(track_display(scene, as_json))
            mcap = sinks.enter_context(TrackMcapWriter(lambda: folder / "run.mcap", scene))
            setting = Setting(seed=seed, faults=faults)
            watcher = TrackWatcher(vehicles, name, setting, truth.at, (live, mcap, folder))
            report = _run(plan, watcher, limit, schedule, folder / "agents")
        tracking.write_outputs(report, folder, animate)
        closed = tracking.closing(report.summary, folder.path)
    end(report.summary, closed, as_json)


@team.command()
@searching_options
@process_options
@output_options
def search(
    scenario_path: Path | None,
    seed: int,
    coordination: str,
    scheme: str,
    fusion: str,
    max_time: float | None,
    speed: float,
    lease: float,
    faults: str | None,
    out: Path | None,
    force: bool,
    as_json: bool,
    animate: bool,
) -> None:
    """Let a team of agent processes look for the hidden target of SCENARIO: one process a vehicle.

    SCENARIO and the outputs are as for `vedette search`, counted curves and comparison left out. Exit
    status: 0 found, 1 not found in time or declared where it is not, 2 bad input, 130 interrupted.
    """
    case = case_of(scenario_path)
    options = SearchOptions(coordination, scheme, fusion)
    plan = FlightsPlan("search", options, scenario_path, len(case.names), seed, speed, lease)
    vehicles = SearchTeam(case, options, plan.times)
    schedule = parse_faults(faults, plan.size, clocks=False)
    duration = case.scenario.duration if max_time is None else min(max_time, case.scenario.duration)
    scene, hidden = SearchScene.of(case, duration), Hidden.of(case, seed)
    curves = ideal(case, floor(duration / case.scenario.step + 1e-6))
    with OutputFolder.make(out, force, case.name, searching.inputs_of(case, scenario_path, faults)) as folder:
        with ExitStack() as sinks:
            live = sinks.enter_context(search_display(scene, as_json))
            mcap = sinks.enter_context(SearchMcapWriter(lambda: folder / "run.mcap", scene))
            setting = Setting(seed=seed, faults=faults)
            watcher = SearchWatcher(vehicles, duration, setting, hidden.at, curves, (live, mcap, folder))
            report = _run(plan, watcher, duration, schedule, folder / "agents")
        searching.write_outputs(report, folder, animate)
        closed = searching.closing(report.summary, folder.path)
    end(report.summary, closed, as_json)


class _Report(Protocol):
    @property
    def timing(self) -> Timing: ...


ReportT = TypeVar("ReportT", bound=_Report)


def _run(
    plan: TeamPlan, watcher: Watcher[ReportT], max_time: float, schedule: Schedule | None, logs: Path
) -> ReportT:
    """Run a team of processes to the end of its mission; ``logs``: the folder of what they say."""
    text = None if schedule is None else faults_text(schedule)
    with ExitStack() as stack:
        stack.enter_context(_ending_on_any_signal())
        secrets = stack.enter_context(TemporaryDirectory(prefix="vedette-team-"))
        processes = stack.enter_context(TeamProcesses(plan, Path(secrets), logs, text))
        operator = stack.enter_context(Operator(processes.operator))
        watch = TeamWatch(plan, processes, operator, watcher, max_time)
        if schedule is not None:
            watch.befall = Stage(schedule, processes, watch).befall
        stack.enter_context(ending_on_ctrl_c(watch.stop))
        report = watch.run()
    for line in _remarks(watch, report.timing.real_time_factor, plan.speed):
        click.echo(f"vedette: {line}", err=True)
    return report


def _remarks(watch: TeamWatch[Any], pace: float, speed: float) -> Iterator[str]:
    """Say what else whoever started the team should know."""
    for robot, said in watch.failures.items():
        yield f"{robot_name(robot)} failed: {said}; see {watch.team.log_of(robot)}"
    if 0 < pace < KEPT_UP * speed:
        yield f"this host kept up {pace:.1f} times real time; robots think better at a --speed below"


@contextmanager
def _ending_on_any_signal() -> Iterator[None]:
    """Let what ends a process do what Ctrl-C does, so that no agent is left behind."""

    def end(number: int, frame: FrameType | None) -> None:
        on_ctrl_c = signal.getsignal(signal.SIGINT)
        if not callable(on_ctrl_c):  # ignored: the shell has put us in the background
            raise KeyboardInterrupt
        on_ctrl_c(number, frame)

    if threading.current_thread() is not threading.main_thread():  # only the main one may handle signals
        yield
        return
    before = {number: signal.getsignal(number) for number in _ENDINGS}
    for number, handler in before.items():
        if handler is not signal.SIG_IGN:  # as nohup has it
            signal.signal(number, end)
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)

"""``vedette team``: a team of agent processes on this host."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from types import FrameType

import click
import numpy as np

from vedette.cli.exploring import closing, exploring_options, inputs_of, team_of, world_of, write_outputs
from vedette.cli.options import Positive, end, ending_on_ctrl_c, output_options
from vedette.missions.explore.options import ExploreOptions
from vedette.net.launch import TeamPlan, TeamProcesses
from vedette.net.names import robot_name
from vedette.net.team import TeamWatch
from vedette.net.transport import Operator
from vedette.record.explore.live import ExploreDisplay
from vedette.record.explore.log import ExploreScene
from vedette.record.explore.mcap import ExploreMcapWriter
from vedette.record.folder import OutputFolder
from vedette.sim.starts import choose_starts

SPEED = 3.0  # more costs mission time, as thoughts and messages take as long as ever: 5 % at 5, 16 % at 10
KEPT_UP = 0.8  # of the speed asked for; less is worth a remark
_ENDINGS = (signal.SIGTERM, signal.SIGHUP)


@click.group()
def team() -> None:
    """Start a team of agent processes on this host and watch it."""


@team.command()
@exploring_options
@click.option(
    "--speed",
    type=Positive("times real time", most=50.0),
    default=SPEED,
    show_default=True,
    help="Of the mission, in seconds a second; too much for this host makes robots think slowly.",
)
@click.option(
    "--lease",
    type=Positive("s", least=0.2, most=60.0),
    default=3.0,
    show_default=True,
    help="A neighbour silent for so long is given up [s of real time].",
)
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
    plan = TeamPlan(world, specs, places, options, seed, speed, lease)
    scene = ExploreScene.of(world, [spec.name for spec in specs])
    with OutputFolder.make(out, force, world.name, inputs_of(map_path, team)) as folder:
        with ExitStack() as stack:
            stack.enter_context(_ending_on_any_signal())
            secrets = stack.enter_context(TemporaryDirectory(prefix="vedette-team-"))
            processes = stack.enter_context(TeamProcesses(plan, Path(secrets), folder / "agents"))
            operator = stack.enter_context(Operator(processes.operator))
            live = stack.enter_context(ExploreDisplay(scene, as_json))
            mcap = stack.enter_context(ExploreMcapWriter(lambda: folder / "run.mcap", scene))
            watch = TeamWatch(plan, processes, operator, max_time, (live, mcap, folder))
            stack.enter_context(ending_on_ctrl_c(watch.stop))
            report = watch.run()
        write_outputs(report, world, folder, animate)
        closed = closing(report.summary, folder.path)
    for line in _remarks(watch, report.timing.real_time_factor, speed):
        click.echo(f"vedette: {line}", err=True)
    end(report.summary, closed, as_json)


def _remarks(watch: TeamWatch, pace: float, speed: float) -> Iterator[str]:
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

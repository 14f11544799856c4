"""``vedette explore``: a team of robots explores a building in simulation."""

from __future__ import annotations

import math
import re
import signal
import threading
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from pathlib import Path

import click
import numpy as np

from vedette.domains.mapping.planners import PLANNERS
from vedette.errors import InputError, nearest_name
from vedette.maps import write_map
from vedette.negotiation import SCHEMES
from vedette.record.animate import animate_gif
from vedette.record.curves import curves_png
from vedette.record.files import new_directory, output_directory
from vedette.record.live import LiveView
from vedette.record.mcap import McapWriter
from vedette.record.progress import progress_png
from vedette.record.summary import Outcome, Summary
from vedette.sim.exploration import FUSIONS, ExploreSetup, ExploreSimulation
from vedette.sim.explore import Report, planning_frame, prepare
from vedette.sim.explore import explore as run_mission
from vedette.sim.simulation import Simulation
from vedette.sim.starts import parse_starts
from vedette.sim.world import World
from vedette.sim.worlds import office
from vedette.team import PlatformSpec, load_team

ROBOTS = 3
STATUS = {Outcome.COMPLETE: 0, Outcome.INTERRUPTED: 130}  # any other end: 1
_KILL = re.compile(r"(\d+)@(\d+(?:\.\d*)?)")


class OneOf(click.ParamType[str]):
    """A word of a list; for another, the nearest one is offered."""

    name = "name"

    def __init__(self, words: Sequence[str]) -> None:
        self.words = tuple(words)

    def get_metavar(self, param: click.Parameter, ctx: click.Context) -> str:
        """Show the choice in ``--help``."""
        return "|".join(self.words)

    def convert(self, value: str, param: click.Parameter | None, ctx: click.Context | None) -> str:
        """Return the word, or refuse it."""
        if value not in self.words:
            what = param.name if param is not None and param.name else "name"
            raise InputError(f"unknown {what} {value!r}: {nearest_name(value, self.words)}")
        return value


class Positive(click.ParamType[float]):
    """A finite number above zero, with its unit for the message."""

    name = "number"

    def __init__(self, unit: str, least: float = 0.0, most: float = math.inf) -> None:
        self.unit, self.least, self.most = unit, least, most

    def convert(self, value: str | float, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """Return the number, or refuse it."""
        option = param.opts[0] if param is not None else "value"
        try:
            number = float(value)
        except ValueError:
            number = math.nan
        if not (number > 0 and self.least <= number <= self.most and math.isfinite(number)):
            most = "" if math.isinf(self.most) else f" and at most {self.most:g}"
            raise InputError(f"{option} must be above {self.least:g}{most} {self.unit}; got {value!r}")
        return number


class Share(click.ParamType[float]):
    """A number from 0 up to a most."""

    name = "share"

    def __init__(self, most: float) -> None:
        self.most = most

    def convert(self, value: str | float, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """Return the number, or refuse it."""
        option = param.opts[0] if param is not None else "value"
        try:
            number = float(value)
        except ValueError:
            number = math.nan
        if not 0.0 <= number <= self.most:
            raise InputError(f"{option} must be 0 to {self.most:g}; got {value!r}")
        return number


@click.command()
@click.argument("map_path", metavar="[MAP]", required=False, type=Path)
@click.option(
    "--resolution", type=Positive("m per pixel"), help="Side of a cell, for a MAP that is a plain image [m]."
)
@click.option(
    "--robots", type=int, metavar="N", help=f"Size of the team.  [default: {ROBOTS}, or the team file's]"
)
@click.option("--team", type=Path, metavar="FILE", help="Team file: bodies, lidars and starts of the robots.")
@click.option(
    "--starts",
    metavar='"x,y;x,y"',
    help="Where the robots start [m].  [default: together, chosen by the seed]",
)
@click.option(
    "--seed",
    type=click.IntRange(min=0),
    default=0,
    show_default=True,
    help="Of the office, the starts and all chance.",
)
@click.option(
    "--planner", type=OneOf(list(PLANNERS)), default="tours", show_default=True, help="How the team decides."
)
@click.option("--scheme", type=OneOf(SCHEMES), default="token", show_default=True, help="How it negotiates.")
@click.option(
    "--fusion",
    type=OneOf(list(FUSIONS)),
    default="replicated",
    show_default=True,
    help="How it shares what it sees.",
)
@click.option(
    "--max-time", type=Positive("s"), default=3600.0, show_default=True, help="Simulated time limit [s]."
)
@click.option(
    "--link-delay",
    type=Positive("s", most=0.3),
    default=0.02,
    show_default=True,
    help="Of a message on a link [s].",
)
@click.option(
    "--link-loss",
    type=Share(0.9),
    default=0.0,
    show_default=True,
    help="Share of messages lost.",
)
@click.option(
    "--kill",
    "kills",
    multiple=True,
    metavar="R@T",
    help="Robot R (from 1) dies at T seconds; may be repeated.",
)
@click.option("--return-home", is_flag=True, help="The robots drive back to their starts in the end.")
@click.option(
    "--out", type=Path, metavar="DIR", help="Folder for the results.  [default: a new one under runs/]"
)
@click.option("--force", is_flag=True, help="Write into DIR although it exists.")
@click.option("--json", "as_json", is_flag=True, help="Print the summary alone, as JSON.")
@click.option("--animate", is_flag=True, help="Make a GIF of the mission as well.")
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
    link_delay: float,
    link_loss: float,
    kills: tuple[str, ...],
    return_home: bool,
    out: Path | None,
    force: bool,
    as_json: bool,
    animate: bool,
) -> None:
    """Let a team of robots explore MAP in simulation: every robot runs its own agent, none is in charge.

    MAP is a ROS map_server .yaml, or an image together with --resolution; without it, a generated office of
    30 x 20 m. Exit status: 0 complete, 1 incomplete, 2 bad input, 130 interrupted.
    """
    world = _world(map_path, resolution, seed)
    specs = _team(team, robots, starts)
    setup = ExploreSetup(
        planner=planner,
        scheme=scheme,
        fusion=fusion,
        seed=seed,
        max_time=max_time,
        link_delay=link_delay,
        link_loss=link_loss,
        kills=tuple(_kill(text, len(specs)) for text in kills),
        return_home=return_home,
    )
    # Everything that can be wrong with the input is found before the folder is made.
    prepared = prepare(world, specs, setup)
    folder = new_directory("runs", world.name) if out is None else output_directory(out, force)
    with _ending_on_ctrl_c(prepared):
        report = _run(prepared, folder, quiet=as_json)
        _write(report, world, folder, animate)
    click.echo(report.summary.to_json() if as_json else _closing(report.summary, folder), nl=not as_json)
    raise SystemExit(STATUS.get(report.summary.outcome, 1))


def _run(prepared: ExploreSimulation, folder: Path, quiet: bool) -> Report:
    """Run the mission, shown live unless ``quiet`` and recorded in the folder."""
    world, planning = prepared.world, planning_frame(prepared.world)
    with ExitStack() as sinks:
        live = sinks.enter_context(LiveView(world.name, world.frame, planning, quiet=quiet))
        names = [spec.name for spec in prepared.specs]
        mcap = sinks.enter_context(McapWriter(folder / "run.mcap", world.name, world.frame, planning, names))
        return run_mission(prepared, (live, mcap))


@contextmanager
def _ending_on_ctrl_c(simulation: Simulation) -> Iterator[None]:
    """Let the first Ctrl-C end the mission between two steps, so that files are whole; a second aborts."""

    def stop(*_: object) -> None:
        signal.signal(signal.SIGINT, signal.default_int_handler)
        simulation.stop()

    if threading.current_thread() is not threading.main_thread():  # only the main one may handle signals
        yield
        return
    before = signal.signal(signal.SIGINT, stop)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def _world(path: Path | None, resolution: float | None, seed: int) -> World:
    if path is not None:
        return World.from_map(path, resolution)
    if resolution is not None:
        raise InputError("--resolution goes with a MAP that is an image; the default office has 0.1 m")
    return office(np.random.default_rng(seed))


def _team(team: Path | None, robots: int | None, starts: str | None) -> list[PlatformSpec]:
    if robots is not None and robots < 1:
        raise InputError(f"--robots must be at least 1; got {robots}")
    places = parse_starts(starts) if starts is not None else []
    if team is not None:
        specs = load_team(team)
        if robots is not None and robots > len(specs):
            raise InputError(f"--robots is {robots}, but {team} lists {len(specs)}; add platforms to it")
        specs = specs[:robots]
    else:
        count = robots or len(places) or ROBOTS
        specs = [PlatformSpec(name=f"robot-{number}") for number in range(1, count + 1)]
    if len(places) > len(specs):
        raise InputError(f"--starts has {len(places)} places for {len(specs)} robots; leave some out")
    return [replace(spec, start=places[i]) if i < len(places) else spec for i, spec in enumerate(specs)]


def _kill(text: str, robots: int) -> tuple[int, float]:
    match = _KILL.fullmatch(text.strip())
    if match is None:
        raise InputError(f"--kill must be robot@seconds, such as 2@60; got {text!r}")
    robot = int(match[1])
    if not 1 <= robot <= robots:
        raise InputError(f"--kill {text}: there is no robot {robot}; they are 1 to {robots}")
    return robot - 1, float(match[2])


def _write(report: Report, world: World, folder: Path, animate: bool) -> None:
    report.summary.write(folder / "summary.json")
    report.timing.write(folder / "timing.json")
    write_map(folder / "map", world.frame, report.classes)
    progress_png(report.log, folder / "progress.png")
    curves_png(report.log, report.summary, folder / "curves.png")
    if animate:
        animate_gif(report.log, folder / "mission.gif")


def _closing(summary: Summary, folder: Path) -> str:
    """Say in a few lines how it went and where the pictures are."""
    t90 = "-" if summary.t90_s is None else f"{summary.t90_s:.0f} s"
    longest = max(summary.path_m.values())
    return (
        f"{summary.outcome.value}: {100 * summary.coverage:.1f} % of {summary.world} known after "
        f"{summary.time_s:.0f} s (90 % after {t90}), longest way {longest:.0f} m, "
        f"{summary.collisions} collisions\n"
        f"pictures: {folder / 'progress.png'}, {folder / 'curves.png'}; all else beside them"
    )

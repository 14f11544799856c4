"""``vedette explore``: a team of robots explores a building in simulation."""

from __future__ import annotations

from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path

import click
import numpy as np

from vedette.cli.options import (
    STATUS,
    OneOf,
    Positive,
    ending_on_ctrl_c,
    fault_options,
    output_options,
    parse_kills,
    seed_option,
)
from vedette.domains.mapping.planners import PLANNERS
from vedette.errors import InputError
from vedette.maps import write_map
from vedette.negotiation import SCHEMES
from vedette.record.animate import animate_gif
from vedette.record.curves import curves_png
from vedette.record.files import new_directory, output_directory
from vedette.record.live import LiveView
from vedette.record.mcap import McapWriter
from vedette.record.progress import progress_png
from vedette.record.summary import Summary
from vedette.sim.exploration import FUSIONS, ExploreSetup, ExploreSimulation
from vedette.sim.explore import Report, planning_frame, prepare
from vedette.sim.explore import explore as run_mission
from vedette.sim.starts import parse_starts
from vedette.sim.world import World
from vedette.sim.worlds import office
from vedette.team import PlatformSpec, load_team

ROBOTS = 3


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
@seed_option("the office, the starts and all chance")
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
@fault_options
@click.option("--return-home", is_flag=True, help="The robots drive back to their starts in the end.")
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
        kills=parse_kills(kills, len(specs)),
        return_home=return_home,
    )
    # Everything that can be wrong with the input is found before the folder is made.
    prepared = prepare(world, specs, setup)
    folder = new_directory("runs", world.name) if out is None else output_directory(out, force)
    with ending_on_ctrl_c(prepared.stop):
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

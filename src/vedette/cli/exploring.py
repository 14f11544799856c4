"""What the commands that let a team explore share: options, the world and the team, files, the last words."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeVar

import click
import numpy as np

from vedette.cli.options import OneOf, Positive, seed_option, with_options, write_figures
from vedette.domains.mapping.planners import DEFAULT, PLANNERS
from vedette.errors import InputError
from vedette.maps import map_files, write_map
from vedette.maps.world import World
from vedette.missions.explore.assemble import FUSIONS
from vedette.negotiation import SCHEMES
from vedette.record.explore.curves import curves_png
from vedette.record.explore.film import explore_gif
from vedette.record.explore.observer import ExploreReport
from vedette.record.explore.progress import progress_png
from vedette.record.explore.summary import ExploreSummary
from vedette.record.folder import OutputFolder
from vedette.sim.starts import parse_starts
from vedette.sim.worlds import office
from vedette.team import PlatformSpec, load_team

ROBOTS = 3
CommandT = TypeVar("CommandT", bound=Callable[..., Any])


def exploring_options(command: CommandT) -> CommandT:
    """``MAP`` and what says who explores it, and how."""
    return with_options(
        command,
        click.argument("map_path", metavar="[MAP]", required=False, type=Path),
        click.option(
            "--resolution",
            type=Positive("m per pixel"),
            help="Side of a cell, for a MAP that is a plain image [m].",
        ),
        click.option(
            "--robots",
            type=int,
            metavar="N",
            help=f"Size of the team.  [default: {ROBOTS}, or the team file's]",
        ),
        click.option(
            "--team", type=Path, metavar="FILE", help="Team file: bodies, lidars and starts of the robots."
        ),
        click.option(
            "--starts",
            metavar='"x,y;x,y"',
            help="Where the robots start [m].  [default: together, chosen by the seed]",
        ),
        seed_option("the office, the starts and all chance"),
        click.option(
            "--planner",
            type=OneOf(list(PLANNERS)),
            default=DEFAULT,
            show_default=True,
            help="How the team decides.",
        ),
        click.option(
            "--scheme", type=OneOf(SCHEMES), default="token", show_default=True, help="How it negotiates."
        ),
        click.option(
            "--fusion",
            type=OneOf(list(FUSIONS)),
            default="replicated",
            show_default=True,
            help="How it shares what it sees.",
        ),
        click.option(
            "--max-time",
            type=Positive("s"),
            default=3600.0,
            show_default=True,
            help="Simulated time limit [s].",
        ),
        click.option("--return-home", is_flag=True, help="The robots drive back to their starts in the end."),
    )


def world_of(path: Path | None, resolution: float | None, seed: int) -> World:
    """Return the world of a map file, or an office.

    Raises:
        InputError: the map cannot be read, or a resolution is given without one.
    """
    if path is not None:
        return World.from_map(path, resolution)
    if resolution is not None:
        raise InputError("--resolution goes with a MAP that is an image; the default office has 0.1 m")
    return office(np.random.default_rng(seed))


def team_of(team: Path | None, robots: int | None, starts: str | None) -> list[PlatformSpec]:
    """Return the platforms of ``--team``, ``--robots`` and ``--starts``.

    Raises:
        InputError: they cannot be, or contradict each other.
    """
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


def inputs_of(map_path: Path | None, team: Path | None, faults: str | None = None) -> list[Path]:
    """Return the files that a command reads; ``faults`` may be a seed, which is no file."""
    maps = [] if map_path is None else map_files(map_path)
    return [*maps, *(Path(name) for name in (team, faults) if name is not None)]


def write_outputs(report: ExploreReport, world: World, folder: OutputFolder, animate: bool) -> None:
    """Write all files of a mission but the run record, which grows while it lasts."""
    write_figures(report.summary, report.timing, folder)
    write_map(folder / "map", world.frame, report.classes)
    progress_png(report.log, folder / "progress.png")
    curves_png(report.log, report.summary, folder / "curves.png")
    if animate:
        explore_gif(report.log, folder / "mission.gif")


def closing(summary: ExploreSummary, folder: Path) -> list[str]:
    """Say in a few lines how it went, what was left out, and where the pictures are."""
    t90 = "-" if summary.t90_s is None else f"{summary.t90_s:.0f} s"
    longest = max(summary.path_m.values())
    lines = [
        f"{summary.outcome.said}: {100 * summary.coverage:.1f} % of {summary.world} known after "
        f"{summary.time_s:.0f} s (90 % after {t90}), longest way {longest:.0f} m, "
        f"{summary.collisions} collisions",
        f"pictures: {folder / 'progress.png'}, {folder / 'curves.png'}; all else beside them",
    ]
    if summary.left_out:
        count = Counter(spot.why for spot in summary.left_out)
        said = ", ".join(f"{number} {why}" for why, number in count.items())
        lines.insert(1, f"frontiers left out: {said}; summary.json lists them")
    return lines

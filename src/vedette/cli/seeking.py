"""``vedette search --unknown-map``: its options beside those of searching vehicles, and its last words."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, NoReturn, TypeVar

import click
from click.core import ParameterSource

from vedette.cli.exploring import EXPLORING, team_named, world_named
from vedette.cli.options import FILE, OneOf, Output, Positive, with_options
from vedette.cli.running import Kind, simulate
from vedette.errors import InputError
from vedette.missions.seek.options import ORDERS, SeekOptions
from vedette.record.seek.summary import SeekSummary
from vedette.run.inputs import ROBOTS, files_of
from vedette.run.seeking import Seek

CommandT = TypeVar("CommandT", bound=Callable[..., Any])

OF_UNKNOWN_MAPS = ("robots", "team", "resolution", "order", "reach")
MAX_TIME = 3600.0  # [s]
OF_VEHICLES = ("coordination", "fusion", "trials", "watch", "pace", "no_compare")


def seeking_options(command: CommandT) -> CommandT:
    """``--unknown-map`` and what says who looks for somebody then."""
    return with_options(
        command,
        click.option(
            "--unknown-map", is_flag=True,
            help="Robots look for somebody in a building that they do not know; SCENARIO is its map.",
        ),
        click.option("--robots", type=int, metavar="N", help=f"How many of them.  [default: {ROBOTS}]"),
        click.option("--team", type=FILE, metavar="FILE", help="Their bodies, lidars and starts."),
        click.option(
            "--resolution", type=Positive("m per pixel"), help="Of a map that is a plain image [m]."
        ),
        click.option(
            "--order", type=OneOf(ORDERS), default=SeekOptions.order, show_default=True,
            help="Whether they search once all is mapped, or map and search together.",
        ),
        click.option(
            "--reach", type=Positive("m", most=100.0), default=SeekOptions.reach, show_default=True,
            help="Within which they see somebody [m].",
        ),
    )  # fmt: skip


def check_together(context: click.Context, unknown_map: bool) -> None:
    """Refuse what is of the other kind of search.

    Raises:
        InputError: an option is given that would be in vain.
    """
    of_others = OF_VEHICLES if unknown_map else OF_UNKNOWN_MAPS
    for parameter in context.command.params:
        given = context.get_parameter_source(parameter.name or "") is ParameterSource.COMMANDLINE
        if given and parameter.name in of_others:
            kind = "vehicles in a known area; leave it, or --unknown-map, out"
            raise InputError(
                f"{parameter.opts[0]} is of {kind if unknown_map else 'searches with --unknown-map'}"
            )


def seek(
    map_path: Path | None,
    resolution: float | None,
    robots: int | None,
    team: Path | None,
    max_time: float | None,
    output: Output,
    **options: Any,
) -> NoReturn:
    """Let robots look for somebody in a building that they do not know."""
    world, specs = world_named(map_path, resolution), team_named(team, robots, None)
    mission = Seek(world, specs, max_time=MAX_TIME if max_time is None else max_time, **options)
    mission.inputs += files_of(None, team)
    simulate(SEEKING, mission, mission.scene, output)


def closing(summary: SeekSummary, folder: Path) -> list[str]:
    """Say in a few lines how it went and where the pictures are."""
    known = f"{100 * (summary.coverage or 0.0):.0f} % of {summary.world} known"
    how = f"{summary.outcome.said} after {summary.time_s:.0f} s"
    by = "" if summary.found_by is None else f" by {summary.found_by}"
    x, y = summary.somebody
    return [
        f"{how}{by}: somebody at {x:.1f}, {y:.1f} m; {known}, mapped and searched {summary.order}",
        f"pictures: {folder / 'progress.png'}, {folder / 'curves.png'}; all else beside them",
    ]


SEEKING = Kind(EXPLORING.display, EXPLORING.recorder, EXPLORING.write, closing, EXPLORING.leaves)

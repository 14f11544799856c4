"""What the commands that let a team explore share: options, the world and the team, the last words."""

from __future__ import annotations

import warnings
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeVar

import click

from vedette.cli.options import FILE, Named, OneOf, Positive, seed_option, with_options
from vedette.cli.running import Kind
from vedette.domains.mapping.planners import DEFAULT, PLANNER
from vedette.errors import InputError, InputWarning
from vedette.maps.area import Area
from vedette.missions.explore.assemble import FUSIONS
from vedette.missions.explore.options import FRAMES
from vedette.missions.pairs import SCHEME
from vedette.negotiation import SCHEMES
from vedette.number import many
from vedette.outcome import Outcome
from vedette.parts import is_reference, look_in
from vedette.record.explore.live import explore_display
from vedette.record.explore.mcap import ExploreMcapWriter
from vedette.record.explore.outputs import write_outputs
from vedette.record.explore.summary import ExploreSummary
from vedette.run.inputs import ROBOTS, AnyWorld, team_of
from vedette.run.mission import RECORD
from vedette.sim.starts import parse_starts
from vedette.team import PlatformSpec, load_team

CommandT = TypeVar("CommandT", bound=Callable[..., Any])
STAYED = 1.0  # a robot that drove less than this never left its start [m]


class Corners(click.ParamType[Any]):
    """Corners of a polygon, ``"x,y;x,y;x,y"`` [m]."""

    name = "corners"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[tuple[float, float], ...]:
        """Return the corners; InputError if they make no area."""
        corners = []
        for entry in str(value).strip().strip(";").split(";"):
            x, _, y = entry.partition(",")
            try:
                corners.append((float(x), float(y)))
            except ValueError:
                raise InputError(f"--area: {entry.strip()!r} must be x,y in m") from None
        return Area.of(corners).corners


def exploring_options(command: CommandT) -> CommandT:
    """``MAP`` and what says who explores it, and how."""
    return with_options(
        command,
        click.argument("map_path", metavar="[MAP]", required=False, type=FILE),
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
            "--team", type=FILE, metavar="FILE", help="Team file: bodies, lidars and starts of the robots."
        ),
        click.option(
            "--starts",
            metavar='"x,y;x,y"',
            help="Where the robots start [m].  [default: together, chosen by the seed]",
        ),
        click.option(
            "--drift",
            type=float,
            metavar="D",
            help="Odometry errs by a deviation of D m over a metre and D rad over a radian, and SLAM "
            "corrects it where a robot comes by again.",
        ),
        seed_option("the office, the starts and all chance"),
        click.option(
            "--planner",
            type=Named(PLANNER),
            default=DEFAULT,
            show_default=True,
            help="How the team decides.",
        ),
        click.option(
            "--scheme",
            type=OneOf(SCHEMES),
            help=f"How it negotiates.  [default: {SCHEME}, or the planner's own]",
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
        click.option(
            "--area",
            type=Corners(),
            metavar='"x,y;x,y;x,y"',
            help="Corners of the ground that is the team's [m]: it leaves all else alone.  [default: all]",
        ),
        click.option("--unbounded", is_flag=True, help="The robots are not told how far their ground goes."),
        click.option(
            "--prior",
            type=FILE,
            metavar="MAP",
            help="An old map of the building, which may be out of date: what it shows is expected.",
        ),
        click.option(
            "--frames",
            type=OneOf(FRAMES),
            default="known",
            show_default=True,
            help="unknown: each robot's frame is its own, and the team finds how they lie.",
        ),
        click.option(
            "--rendezvous/--no-rendezvous",
            default=False,
            show_default=False,
            help="--frames unknown: ground is worth more where robots of unknown frames may have been.",
        ),
        click.option("--return-home", is_flag=True, help="The robots drive back to their starts in the end."),
    )


def world_named(path: Path | None, resolution: float | None) -> AnyWorld:
    """Return what MAP and ``--resolution`` say of the world.

    Raises:
        InputError: a resolution is given without a map.
    """
    if path is not None:
        if is_reference(str(path)):
            look_in(Path())
        return path, resolution
    if resolution is not None:
        raise InputError("--resolution goes with a MAP that is an image; the default office has 0.1 m")
    return None


def team_named(
    team: Path | None, robots: int | None, starts: str | None, drift: float | None = None
) -> list[PlatformSpec]:
    """Return the platforms of ``--team``, ``--robots``, ``--starts`` and ``--drift``.

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
        specs, rest = specs[:robots], specs[robots:] if robots is not None else []
        if rest:
            _say(f"--robots {robots} leaves out {', '.join(spec.name for spec in rest)} of {team}")
    else:
        specs = list(team_of(robots or len(places) or ROBOTS))
    if len(places) > len(specs):
        raise InputError(
            f"--starts has {many(len(places), 'place')} for {many(len(specs), 'robot')}; leave some out"
        )
    moved = [spec.name for spec, _ in zip(specs, places, strict=False) if spec.start is not None]
    if moved:
        _say(f"--starts replaces the team file's start of {', '.join(moved)}")
    if drift is not None:
        specs = [replace(spec, drift=drift) for spec in specs]
    return [replace(spec, start=places[i]) if i < len(places) else spec for i, spec in enumerate(specs)]


def _say(text: str) -> None:
    warnings.warn(text, InputWarning, stacklevel=3)


def closing(summary: ExploreSummary, folder: Path) -> list[str]:
    """Say in a few lines how it went, what was left out, and where the pictures are."""
    longest = max(summary.path_m.values())
    stayed = sum(way < STAYED for way in summary.path_m.values())
    lines = [
        f"{summary.outcome.said}: {_known(summary)}, longest way {longest:.0f} m, "
        f"{many(summary.collisions, 'collision')}{_told_of_those_who_stayed(stayed)}",
        f"pictures: {folder / 'progress.png'}, {folder / 'curves.png'}; all else beside them",
    ]
    if summary.frames is not None and summary.frames.said:
        errors = max((summary.pose_error_m or {"": 0.0}).values())
        own = f", places of their own {errors:.2f} m" if errors else ""
        lines.insert(1, f"{summary.frames.said}{own}")
    if summary.outcome is Outcome.MAPS_DIFFER:
        holders = (", ".join(names) for names in summary.maps)
        lines.insert(1, f"maps held: one by {'; another by '.join(holders)}")
    if summary.beyond:
        lines.insert(
            1,
            f"left out: {many(summary.beyond, 'beam')} farther off than there is room for; --area says "
            "where the ground is",
        )
    if summary.left_out:
        count = Counter(spot.why for spot in summary.left_out)
        said = ", ".join(f"{number} {why}" for why, number in count.items())
        lines.insert(1, f"frontiers left out: {said}; summary.json lists them")
    return lines


def _known(summary: ExploreSummary) -> str:
    """Say how much is known of the world, and since when; of ground without a known end how fast it grew."""
    after = f"of {summary.world} known after {summary.time_s:.0f} s"
    if summary.coverage is None:
        left = "" if summary.frontiers is None else f", {many(summary.frontiers, 'frontier')} left"
        return f"{summary.known_m2:.0f} m2 {after} ({summary.rate_m2_s:.2f} m2/s{left})"
    t90 = "-" if summary.t90_s is None else f"{summary.t90_s:.0f} s"
    return f"{100 * summary.coverage:.1f} % {after} (90 % after {t90})"


def _told_of_those_who_stayed(robots: int) -> str:
    if robots == 0:
        return ""
    return f", {many(robots, 'robot')} never left {'its' if robots == 1 else 'their'} start"


LEAVES = (RECORD, "summary.json", "timing.json", "map.yaml", "map.pgm", "progress.png", "curves.png")
EXPLORING = Kind(explore_display, ExploreMcapWriter, write_outputs, closing, LEAVES)

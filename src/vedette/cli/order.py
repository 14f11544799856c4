"""``vedette order``: an operator's order to a team on the network."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click
from msgspec import Struct

from vedette.agent.orders import Order, encode
from vedette.cli.options import OneOf
from vedette.cli.reaching import reached, reaching_options
from vedette.errors import InputError
from vedette.net.hearing import Hearing
from vedette.net.names import robot_name
from vedette.net.orders import TAKEN, pen_of, written
from vedette.net.transport import Operator
from vedette.outcome import Outcome
from vedette.scenario import as_scenario

KINDS = (
    "pause", "resume", "stay", "recall", "look", "end", "no-go", "priority", "remove", "exclude", "reinstate"
)  # fmt: skip


class _Said(Struct, frozen=True):
    order: Order


class PlaceOf(click.ParamType[Any]):
    """A place, ``x,y`` [m]."""

    name = "place"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[float, float]:
        """Return it."""
        x, _, y = str(value).partition(",")
        try:
            return float(x), float(y)
        except ValueError:
            raise InputError(f"{param.opts[0] if param else ''}: {value!r} must be x,y in m") from None


class CornersOf(click.ParamType[Any]):
    """Corners of a polygon, ``"x,y;x,y;x,y"`` [m]."""

    name = "polygon"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> list[tuple[float, float]]:
        """Return them."""
        return [PlaceOf().convert(each, param, ctx) for each in str(value).strip().strip(";").split(";")]


@click.command()
@reaching_options
@click.argument("kind", metavar="ORDER", type=OneOf(KINDS))
@click.option("--robot", type=int, metavar="N", help="Which robot, from 1.  [default: the whole team]")
@click.option("--to", type=PlaceOf(), metavar="x,y", help="Where to go back to [m].  [default: its start]")
@click.option("--at", type=PlaceOf(), metavar="x,y", help="Where to look [m].")
@click.option("--area", metavar="NAME", help="Of a no-go or priority area.")
@click.option("--corners", type=CornersOf(), metavar='"x,y;x,y;x,y"', help="Of that area [m].")
@click.option(
    "--frame",
    type=int,
    metavar="N",
    help="The robot in whose frame that is, where the team shares none.",
)
@click.option("--factor", type=float, help="How many times as much a priority area is worth.")
def order(config_paths: tuple[Path, ...], keys: Path | None, wait: float, kind: str, **said: Any) -> None:
    """Give the agents that listen where the CONFIG.yaml files say an order: they pass it on to the others.

    ORDER is pause, resume, stay, recall, look, end, no-go, priority, remove, exclude or reinstate;
    docs/how-to/orders.md says what each does. Exit status: 0 taken, 1 nobody answered, 2 refused.
    """
    _, access = reached(config_paths, keys)
    given = {name: value for name, value in said.items() if value is not None}
    what = as_scenario({"order": {"order": kind, **given}}, _Said, kind).order
    with Operator(access) as operator:
        hearing = Hearing(operator)
        hearing.listen(wait, lambda: len(hearing.reports) >= len(config_paths))
        told = [report.condition for report in hearing.reports.values() if report.condition.mission]
        if not told:
            click.echo(f"nobody who takes orders answered within {wait:g} s", err=True)
            raise SystemExit(Outcome.UNHEARD.status)
        mission = told[0].mission
        heard = [each.counter for condition in told for each in condition.orders]
        answers = operator.order(
            encode(written(what, mission, heard, pen_of(access.credentials, mission))), max(wait, 1.0)
        )
    refused = {robot: line for robot, line in answers.items() if line != TAKEN}
    for robot, line in sorted(refused.items()):
        click.echo(f"{robot_name(robot)}: {line}", err=True)
    taken = answers.keys() - refused.keys()
    if taken:
        click.echo(f"taken by {', '.join(map(robot_name, sorted(taken)))}")
        return
    if refused:
        raise SystemExit(2)
    click.echo(f"nobody answered within {wait:g} s", err=True)
    raise SystemExit(Outcome.UNHEARD.status)

"""``vedette keys``: make the certificates that admit robots to a team, and revoke them."""

from __future__ import annotations

from datetime import UTC, datetime
from pathlib import Path

import click

from vedette.cli.options import FILE
from vedette.errors import InputError
from vedette.net.keys import CA_KEY, DAYS, add_robots, issue_team
from vedette.net.names import OPERATOR
from vedette.net.revoke import revoke


class _Keys(click.Group):
    """Makes keys, but for the word ``revoke``."""

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Return the command that is asked for; what is none is the team that keys are made for."""
        known = args[0] in self.commands
        return super().resolve_command(ctx, args if known else ["make", *args])


@click.group(cls=_Keys, context_settings={"ignore_unknown_options": True}, subcommand_metavar="TEAM DIR ...")
def keys() -> None:
    """Make or revoke the keys of TEAM in DIR.

    \b
    vedette keys TEAM DIR --robots N       a new team of N robots
    vedette keys TEAM DIR --add K          K more robots of the team in DIR
    vedette keys revoke TEAM DIR ROBOT...  take the certificates of some back
    """


@keys.command()
@click.argument("team")
@click.argument("folder", metavar="DIR", type=FILE)
@click.option("--robots", type=int, metavar="N", help="Make DIR, with the keys of a new team of N robots.")
@click.option("--add", type=int, metavar="K", help="Add keys for K more robots to the team in DIR.")
@click.option("--days", type=int, default=DAYS, show_default=True, help="For how long they are valid.")
def make(team: str, folder: Path, robots: int | None, add: int | None, days: int) -> None:
    """Make the keys of TEAM in DIR: an authority of its own, a certificate a robot, one for the operator.

    TEAM is letters, digits, '-' and '_'. Nothing that exists is ever overwritten.
    """
    now = datetime.now(UTC)
    if robots is not None and add is None:
        made = issue_team(team, folder, robots, now, days)
    elif add is not None and robots is None:
        made = add_robots(team, folder, add, now, days)
    else:
        raise InputError(
            "give either --robots N for a new team, or --add K for more robots of one that exists"
        )
    click.echo(_what_goes_where(folder, made))


@keys.command("revoke")
@click.argument("team")
@click.argument("folder", metavar="DIR", type=FILE)
@click.argument("robots", metavar="ROBOT...", nargs=-1, type=int)
def revoke_some(team: str, folder: Path, robots: tuple[int, ...]) -> None:
    """Revoke the certificates of some robots of TEAM, by their numbers, for good.

    DIR is where its keys were made. What is written goes to any one robot: the others learn it from that.
    """
    listed = revoke(team, folder, [robot - 1 for robot in robots], datetime.now(UTC))
    click.echo(
        f"{listed}: copy it beside the keys of one robot at least, into {folder}/robot-1 as it is there; one "
        "that runs finds it within seconds, and passes it on"
    )


def _what_goes_where(folder: Path, made: list[Path]) -> str:
    to_robots = [path.name for path in made if path.name != OPERATOR]
    first, last = to_robots[0], to_robots[-1]
    which = first if first == last else f"{first} to {last}"
    lines = [f"{folder}/{which}: copy each whole folder to its robot, and nothing else"]
    if len(to_robots) < len(made):
        lines.append(f"{folder}/{OPERATOR}: for 'vedette status' on the operator's machine")
    lines.append(f"{folder / CA_KEY}: keep it here, away from all robots: it admits any new one")
    return "\n".join(lines)

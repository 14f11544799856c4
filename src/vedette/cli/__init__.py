"""The ``vedette`` command."""

from __future__ import annotations

import difflib
import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import import_module
from typing import Any

import click

from vedette.cli.pipes import readers_may_leave
from vedette.errors import InputError, InputWarning, check_word
from vedette.interrupt import ending_on_any_signal
from vedette.outcome import Outcome
from vedette.parts import is_reference, named
from vedette.sim.domains import DOMAINS, DomainEntry, entry_of, own_domain

BAD_INPUT = 2


COMMANDS = {
    "agent": "Run one robot of a team, with the neighbours that its file names.",
    "compare": "Lay the figures of runs side by side.",
    "explore": "Let a team of robots explore a building in simulation.",
    "keys": "Make the keys of a team.",
    "map": "Fetch the map of a team on the network.",
    "merge": "Join maps whose frames are not known to each other.",
    **{name: domain.line for name, domain in DOMAINS.items()},
    "new": "Begin something of your own from a skeleton.",
    "order": "Give a team on the network an order: pause, recall, a no-go area ...",
    "plot": "Draw the pictures of a run anew.",
    "replay": "Let recorded lidar data go through a team's agents.",
    "reproduce": "Compute the paper's figures and try its claims.",
    "ros2": "Look at a robot that runs ROS 2.",
    "search": "Let a team of vehicles look for a hidden target in simulation.",
    "status": "List a team's agents: tree, links, agreement, refused messages.",
    "study": "Compare planners on many worlds.",
    "team": "Start a team of agent processes on this host and watch it.",
    "track": "Let a team of vehicles follow targets in simulation.",
    "watch": "Show a team on the network, or a run, in a browser.",
    "world": "Generate an office, a cave or a maze.",
}

_FUNCTIONS = {"map": "map_"}  # where a command's own name is Python's


class _Commands(click.Group):
    """Imports a command when it is asked for: none waits for what only others need, nor does the help."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the names of all commands."""
        return [*COMMANDS, *(name for name in named("missions") if name not in COMMANDS)]

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Return the command that is asked for; for another word, the nearest one is offered."""
        if not (ctx.resilient_parsing or args[0].startswith("-") or is_reference(args[0])):
            check_word("command", args[0], self.list_commands(ctx))
        return super().resolve_command(ctx, args)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Return a command: its module and function have its name, if they can; or a domain has."""
        if cmd_name in DOMAINS or (cmd_name not in COMMANDS and own_domain(cmd_name)):
            command_of: Callable[[DomainEntry], click.Command] = import_module(
                "vedette.cli.domain"
            ).command_of
            return command_of(entry_of(cmd_name))
        if cmd_name not in COMMANDS:
            return None
        module = import_module(f"vedette.cli.{cmd_name}")
        command: click.Command = getattr(module, _FUNCTIONS.get(cmd_name, cmd_name))
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write what each command does, in a line."""
        with formatter.section("Commands"):
            own = [(name, "A domain of somebody's own.") for name in self.list_commands(ctx)[len(COMMANDS) :]]
            formatter.write_dl([*COMMANDS.items(), *own])


@click.command(
    cls=_Commands, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 110}
)
@click.version_option(package_name="vedette")
def commands() -> None:
    """A team of robots gathers information together, with no central computer."""


def main() -> None:
    """Run the command line: one clear line and status 2 for bad input, never a traceback.

    The status is 130 for Ctrl-C, SIGTERM and SIGHUP.
    """
    with ending_on_any_signal(), readers_may_leave(_say):
        _main()


def _main() -> None:
    try:
        with _remarks():
            sys.exit(commands.main(prog_name="vedette", standalone_mode=False))
    except (click.Abort, KeyboardInterrupt):
        sys.exit(Outcome.INTERRUPTED.status)
    except click.exceptions.NoArgsIsHelpError as error:  # nothing was asked for: what can be
        click.echo(error.format_message(), err=True)
        sys.exit(BAD_INPUT)
    except (click.ClickException, InputError) as error:
        _say(_line(error))
        sys.exit(BAD_INPUT)


def _line(error: click.ClickException | InputError) -> str:
    """Return what is wrong, with the nearest option there is, or where all are listed."""
    if isinstance(error, InputError):
        return str(error)
    help_of = (
        f"see {error.ctx.command_path} --help" if isinstance(error, click.UsageError) and error.ctx else ""
    )
    if isinstance(error, click.NoSuchOption) and error.ctx is not None:
        known = [
            name for each in error.ctx.command.get_params(error.ctx) for name in each.opts if name[0] == "-"
        ]
        close = difflib.get_close_matches(error.option_name, known, n=1)
        return f"unknown option {error.option_name!r}; {f'did you mean {close[0]!r}?' if close else help_of}"
    if isinstance(error, click.MissingParameter) and error.param is not None:
        name = error.param.make_metavar(error.ctx) if error.ctx else error.param.name
        option = f"{error.param.opts[-1]} " if isinstance(error.param, click.Option) else ""
        return f"{option}{name} is missing; {help_of}"
    return error.format_message()


@contextmanager
def _remarks() -> Iterator[None]:
    """Say each `InputWarning` in one line, once; other warnings are Python's."""
    said: set[str] = set()
    with warnings.catch_warnings():
        warnings.simplefilter("always", InputWarning)
        show_other = warnings.showwarning

        def show(message: Warning | str, category: type[Warning], *where: Any, **more: Any) -> None:
            if not issubclass(category, InputWarning):
                show_other(message, category, *where, **more)
            elif str(message) not in said:
                said.add(str(message))
                _say(str(message))

        warnings.showwarning = show
        yield


def _say(text: str) -> None:
    click.echo(f"vedette: {' '.join(text.split())}", err=True)

"""The ``vedette`` command."""

from __future__ import annotations

import os
import sys
from importlib import import_module

import click

from vedette.errors import InputError

BAD_INPUT, INTERRUPTED = 2, 130


COMMANDS = ("agent", "explore", "keys", "reproduce", "search", "status", "study", "team", "track", "world")


class _Commands(click.Group):
    """Imports a command when it is asked for: none waits for what only others need."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the names of all commands."""
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Return a command, which is named as its module is."""
        if cmd_name not in COMMANDS:
            return None
        module = import_module(f"vedette.cli.{cmd_name}")
        command: click.Command = getattr(module, cmd_name)
        return command


@click.command(
    cls=_Commands, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 110}
)
@click.version_option(package_name="vedette")
def commands() -> None:
    """A team of robots gathers information together, with no central computer."""


def main() -> None:
    """Run the command line: one clear line and status 2 for bad input, 130 for Ctrl-C, never a traceback."""
    try:
        sys.exit(commands.main(standalone_mode=False))
    except (click.Abort, KeyboardInterrupt):
        sys.exit(INTERRUPTED)
    except (click.ClickException, InputError) as error:
        text = error.format_message() if isinstance(error, click.ClickException) else str(error)
        click.echo(f"vedette: {' '.join(text.split())}", err=True)
        sys.exit(BAD_INPUT)
    except BrokenPipeError:  # the reader of our output has gone
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(1)

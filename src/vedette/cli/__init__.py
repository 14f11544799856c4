"""The ``vedette`` command."""

from __future__ import annotations

import os
import sys

import click

from vedette.cli.explore import explore
from vedette.cli.search import search
from vedette.cli.track import track
from vedette.cli.world import world
from vedette.errors import InputError

BAD_INPUT, INTERRUPTED = 2, 130


@click.group(context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 110})
@click.version_option(package_name="vedette")
def commands() -> None:
    """A team of robots gathers information together, with no central computer."""


commands.add_command(explore)
commands.add_command(search)
commands.add_command(track)
commands.add_command(world)


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

"""What the commands share: options, and errors told in one line."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, NoReturn, TypeVar

import click

from bench import RESULTS
from vedette.errors import InputError
from vedette.record.files import output_directory
from vedette.study.conduct import Conducted

CommandT = TypeVar("CommandT", bound=Callable[..., Any])
BAD_INPUT, INTERRUPTED = 2, 130
_RANGE = re.compile(r"(\d{1,6})(?:-(\d{1,6}))?")


class WholeNumbers(click.ParamType[tuple[int, ...]]):
    """Numbers and ranges such as ``0-9`` or ``1,3,6``; each once, in the order given."""

    name = "numbers"

    def __init__(self, least: int) -> None:
        self.least = least

    def convert(
        self, value: str | tuple[int, ...], param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[int, ...]:
        """Return the numbers, or refuse the text."""
        if isinstance(value, tuple):
            return value
        option = param.opts[0] if param is not None else "value"
        numbers: list[int] = []
        for part in value.split(","):
            match = _RANGE.fullmatch(part.strip())
            if match is None:
                raise InputError(f"{option} must be numbers or ranges, such as 1,3,6 or 0-9; got {value!r}")
            first, last = int(match[1]), int(match[2] or match[1])
            numbers.extend(range(first, last + 1))
        if not numbers or min(numbers) < self.least:
            raise InputError(f"{option} must be at least one number from {self.least} up; got {value!r}")
        return tuple(dict.fromkeys(numbers))


def seeds_option(default: str, of: str = "Of the worlds.") -> Callable[[CommandT], CommandT]:
    """``--seeds``; ``of``: what they decide, for the help."""
    return click.option("--seeds", type=WholeNumbers(0), default=default, show_default=True, help=of)


def robots_option(
    default: str, where: str = "Sizes of the teams.", least: int = 1
) -> Callable[[CommandT], CommandT]:
    """``--robots``, several sizes of teams."""
    return click.option("--robots", type=WholeNumbers(least), default=default, show_default=True, help=where)


def jobs_option(default: int) -> Callable[[CommandT], CommandT]:
    """``--jobs``."""
    many = click.IntRange(min=1)
    return click.option("--jobs", type=many, default=default, show_default=True, help="Processes.")


def out_option(holds: str, default: Path = RESULTS) -> Callable[[CommandT], CommandT]:
    """``--out``; ``holds``: what the folder is for."""
    return click.option("--out", type=Path, default=default, metavar="DIR", help=f"Folder for {holds}.")


def planners_option(default: str) -> Callable[[CommandT], CommandT]:
    """``--planners``."""
    return click.option("--planners", default=default, show_default=True, help="By name, with commas.")


worlds_option = click.option(
    "--worlds", default="office,cave,maze", show_default=True, help="Kinds of worlds, with commas."
)
fresh_option = click.option("--fresh", is_flag=True, help="Run the missions anew that were run before.")
date_option = click.option("--date", help="Of the run, to be put into the JSON.  [default: the commit's]")
minutes_option = click.option(
    "--minutes", type=click.FloatRange(min=0.0), help="Begin no mission after so long."
)


def results_folder(path: Path) -> Path:
    """Return the folder for results, made if it is not there.

    Raises:
        InputError: it cannot be made or written to.
    """
    return output_directory(path, force=True)


def status(done: Conducted) -> int:
    """Return the exit status of a study: 130 if it was interrupted, 1 if a run broke or is still to do."""
    if done.interrupted:
        return INTERRUPTED
    return int(bool(done.broken or done.missing))


def run(command: click.Command, name: str) -> NoReturn:
    """Run a command line: status 2 and one line for bad input, 130 for Ctrl-C."""
    try:
        sys.exit(command.main(prog_name=name, standalone_mode=False) or 0)
    except (click.Abort, KeyboardInterrupt):
        sys.exit(INTERRUPTED)
    except (click.ClickException, InputError) as error:
        text = error.format_message() if isinstance(error, click.ClickException) else str(error)
        click.echo(f"{name}: {' '.join(text.split())}", err=True)
        sys.exit(BAD_INPUT)

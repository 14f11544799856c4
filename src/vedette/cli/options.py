"""What the commands that run a mission share: kinds of options, options, and how a run ends."""

from __future__ import annotations

import math
import re
import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NoReturn, TypeVar

import click

from vedette.errors import InputError, nearest_name
from vedette.record.folder import OutputFolder
from vedette.record.summary import MissionSummary, Timing
from vedette.sim.faults import Schedule, load_faults
from vedette.sim.faults.kinds import Skew
from vedette.sim.radio import Radio, parse_radio

CommandT = TypeVar("CommandT", bound=Callable[..., Any])

_KILL = re.compile(r"(\d+)@(\d+(?:\.\d*)?)")


class OneOf(click.ParamType[str]):
    """A word of a list; for another, the nearest one is offered."""

    name = "name"

    def __init__(self, words: Sequence[str]) -> None:
        self.words = tuple(words)

    def get_metavar(self, param: click.Parameter, ctx: click.Context) -> str:
        """Show the choice in ``--help``."""
        return "|".join(self.words)

    def convert(self, value: str, param: click.Parameter | None, ctx: click.Context | None) -> str:
        """Return the word, or refuse it."""
        if value not in self.words:
            what = param.name if param is not None and param.name else "name"
            raise InputError(f"unknown {what} {value!r}: {nearest_name(value, self.words)}")
        return value


class Positive(click.ParamType[float]):
    """A finite number above zero, with its unit for the message."""

    name = "number"

    def __init__(self, unit: str, least: float = 0.0, most: float = math.inf) -> None:
        self.unit, self.least, self.most = unit, least, most

    def convert(self, value: str | float, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """Return the number, or refuse it."""
        option = param.opts[0] if param is not None else "value"
        number = _number(value)
        if not (number > 0 and self.least <= number <= self.most and math.isfinite(number)):
            most = "" if math.isinf(self.most) else f" and at most {self.most:g}"
            raise InputError(f"{option} must be above {self.least:g}{most} {self.unit}; got {value!r}")
        return number


class Share(click.ParamType[float]):
    """A number from 0 up to a most."""

    name = "share"

    def __init__(self, most: float) -> None:
        self.most = most

    def convert(self, value: str | float, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """Return the number, or refuse it."""
        option = param.opts[0] if param is not None else "value"
        number = _number(value)
        if not 0.0 <= number <= self.most:
            raise InputError(f"{option} must be 0 to {self.most:g}; got {value!r}")
        return number


def seed_option(of: str) -> Callable[[CommandT], CommandT]:
    """``--seed``; ``of``: what it decides, for the help."""
    return click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True, help=f"Of {of}.")


class RadioModel(click.ParamType[Radio]):
    """``RANGE[,WALL_DB]``."""

    name = "RANGE[,WALL_DB]"

    def convert(self, value: str | Radio, param: click.Parameter | None, ctx: click.Context | None) -> Radio:
        """Return the radio, or refuse it."""
        return value if isinstance(value, Radio) else parse_radio(value)


def fault_options(command: CommandT) -> CommandT:
    """``--radio``, ``--faults``, ``--link-delay``, ``--link-loss`` and ``--kill``."""
    return with_options(
        command,
        click.option(
            "--radio", type=RadioModel(), metavar="RANGE[,WALL_DB]",
            help="Robots reach each other over RANGE m at most, less through walls, of which each takes "
            "WALL_DB.  [default: everywhere]",
        ),
        click.option(
            "--faults", metavar="FILE|SEED", help="What befalls robots and links: a schedule or its seed."
        ),
        click.option(
            "--link-delay", type=Positive("s", most=0.3), default=0.02, show_default=True,
            help="Of a message on a link [s].",
        ),
        click.option(
            "--link-loss", type=Share(0.9), default=0.0, show_default=True, help="Share of messages lost."
        ),
        click.option(
            "--kill", "kills", multiple=True, metavar="R@T",
            help="Robot R (from 1) dies at T seconds; may be repeated.",
        ),
    )  # fmt: skip


def output_options(command: CommandT) -> CommandT:
    """``--out``, ``--force``, ``--json`` and ``--animate``."""
    return with_options(
        command,
        click.option(
            "--out", type=Path, metavar="DIR",
            help="Folder for the results.  [default: a new one under runs/]",
        ),
        click.option("--force", is_flag=True, help="Write into DIR although it exists."),
        click.option("--json", "as_json", is_flag=True, help="Print the summary alone, as JSON."),
        click.option("--animate", is_flag=True, help="Make a GIF of the mission as well."),
    )  # fmt: skip


def parse_kills(texts: Sequence[str], robots: int) -> tuple[tuple[int, float], ...]:
    """Return robot indexes and times [s] of ``--kill R@T``, R from 1 to ``robots``.

    Raises:
        InputError: not of that form, or no such robot.
    """
    return tuple(_kill(text, robots) for text in texts)


def parse_faults(text: str | None, robots: int, clocks: bool = True) -> Schedule | None:
    """Return the schedule of ``--faults FILE|SEED`` for a team; ``clocks``: they may go wrong.

    Raises:
        InputError: as :func:`vedette.sim.faults.load_faults`, or clocks go wrong that may not.
    """
    if text is None:
        return None
    schedule = load_faults(text, robots)
    right = [fault for fault in schedule.faults if not isinstance(fault, Skew)]
    if clocks or len(right) == len(schedule.faults):
        return schedule
    if text.strip().isdecimal():  # a seed asks for chance, within what can be
        return Schedule(tuple(right))
    raise InputError(f"{text}: fault skew: vehicles plan by a common clock; leave it out")


@contextmanager
def ending_on_ctrl_c(stop: Callable[[], None]) -> Iterator[None]:
    """Let the first Ctrl-C call ``stop``, which ends the mission in good order; a second one aborts."""

    def interrupted(*_: object) -> None:
        signal.signal(signal.SIGINT, signal.default_int_handler)
        stop()

    if threading.current_thread() is not threading.main_thread():  # only the main one may handle signals
        yield
        return
    before = signal.signal(signal.SIGINT, interrupted)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def write_figures(summary: MissionSummary, timing: Timing, folder: OutputFolder) -> None:
    """Write ``summary.json`` and ``timing.json``."""
    summary.write(folder / "summary.json")
    timing.write(folder / "timing.json")


def end(summary: MissionSummary, lines: Sequence[str], as_json: bool) -> NoReturn:
    """Print the summary alone, or lines for people, and leave with the outcome's status."""
    outcome = summary.outcome
    if as_json:
        click.echo(summary.to_json(), nl=False)
    else:
        lost = [f"lost on the way: {', '.join(summary.lost)}"] if summary.lost else []
        why = [] if outcome.completed else [f"why it ended: {outcome.meaning}"]
        click.echo("\n".join([*lines, *lost, *why]))
    raise SystemExit(outcome.status)


def with_options(command: CommandT, *options: Callable[[CommandT], CommandT]) -> CommandT:
    """Add options, in the order in which the help shows them."""
    for option in reversed(options):
        command = option(command)
    return command


def _number(value: str | float) -> float:
    try:
        return float(value)
    except ValueError:
        return math.nan


def _kill(text: str, robots: int) -> tuple[int, float]:
    match = _KILL.fullmatch(text.strip())
    if match is None:
        raise InputError(f"--kill must be robot@seconds, such as 2@60; got {text!r}")
    robot = int(match[1])
    if not 1 <= robot <= robots:
        raise InputError(f"--kill {text}: there is no robot {robot}; they are 1 to {robots}")
    return robot - 1, float(match[2])

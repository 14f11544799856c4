"""What the commands that run a mission share: kinds of options, and options."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import wraps
from pathlib import Path
from typing import Any, TypeVar

import click
from click.shell_completion import CompletionItem

from vedette.errors import InputError, brief, check_word
from vedette.parts import PartKind, is_reference, look_in
from vedette.sim.radio import Radio, parse_radio

CommandT = TypeVar("CommandT", bound=Callable[..., Any])

FILE = click.Path(path_type=Path, readable=False)  # what it is, its reader says; a shell completes it

_WHOLE = re.compile(r"\s*[+-]?\d{1,18}\s*")
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
        check_word(param.name if param is not None and param.name else "name", value, self.words)
        return value

    def shell_complete(
        self, ctx: click.Context, param: click.Parameter, incomplete: str
    ) -> list[CompletionItem]:
        """Offer the words that begin so."""
        return [CompletionItem(word) for word in self.words if word.startswith(incomplete)]


class Named(OneOf):
    """A part by its name: the house's, an entry point's, or ``module:NAME``, the module in this folder."""

    def __init__(self, kind: PartKind[Any], beside: Sequence[str] = ()) -> None:
        super().__init__((*kind.house, *beside))
        self.kind, self.beside = kind, beside

    def get_metavar(self, param: click.Parameter, ctx: click.Context) -> str:
        """Show the choice in ``--help``."""
        return f"{super().get_metavar(param, ctx)}|MODULE:NAME"

    def convert(self, value: str, param: click.Parameter | None, ctx: click.Context | None) -> str:
        """Return the name, or refuse it."""
        if value in self.words:
            return value
        if not is_reference(value) and value not in self.kind.names:
            check_word(self.kind.word, value, (*self.kind.names, *self.beside))
        look_in(Path())
        self.kind.find(value)
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


class Whole(click.ParamType[int]):
    """A whole number from a least on, and up to a most if there is one."""

    name = "n"

    def __init__(self, least: int, most: int | None = None) -> None:
        self.least, self.most = least, most

    def convert(self, value: str | int, param: click.Parameter | None, ctx: click.Context | None) -> int:
        """Return the number, or refuse it."""
        option = param.opts[0] if param is not None else "value"
        number = int(value) if _WHOLE.fullmatch(str(value)) else None
        if number is None or number < self.least or (self.most is not None and number > self.most):
            span = f"{self.least} or more" if self.most is None else f"{self.least} to {self.most}"
            raise InputError(f"{option} must be a whole number, {span}; got {brief(value)}")
        return number


def seed_option(of: str) -> Callable[[CommandT], CommandT]:
    """``--seed``; ``of``: what it decides, for the help."""
    return click.option("--seed", type=Whole(0), default=0, show_default=True, help=f"Of {of}.")


class RadioModel(click.ParamType[Radio]):
    """``RANGE[,WALL_DB]``."""

    name = "RANGE[,WALL_DB]"

    def convert(self, value: str | Radio, param: click.Parameter | None, ctx: click.Context | None) -> Radio:
        """Return the radio, or refuse it."""
        return value if isinstance(value, Radio) else parse_radio(value)


class Kill(click.ParamType[tuple[int, float]]):
    """``R@T``."""

    name = "R@T"

    def convert(
        self, value: str | tuple[int, float], param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[int, float]:
        """Return the robot's number and the time [s], or refuse them."""
        if isinstance(value, tuple):
            return value
        match = _KILL.fullmatch(value.strip())
        if match is None:
            raise InputError(f"--kill must be robot@seconds, such as 2@60; got {value!r}")
        return int(match[1]), float(match[2])


def orders_option(command: CommandT) -> CommandT:
    """``--orders``."""
    return click.option(
        "--orders",
        type=FILE,
        metavar="FILE",
        help="What the operator orders, and when: pause, recall, no-go areas.",
    )(command)


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
            "--link-loss", type=Share(0.9), default=0.0, show_default=True,
            help="Share of messages lost.",
        ),
        click.option(
            "--kill", "kills", type=Kill(), multiple=True, metavar="R@T",
            help="Robot R (from 1) dies at T seconds; may be repeated.",
        ),
    )  # fmt: skip


@dataclass(frozen=True)
class Output:
    """Where results go, and what is said and drawn of them."""

    out: Path | None
    force: bool
    as_json: bool
    animate: bool


def output_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """``--out``, ``--force``, ``--json`` and ``--animate``, all as one `Output`."""

    @wraps(command)
    def taken(out: Path | None, force: bool, as_json: bool, animate: bool, **others: Any) -> Any:
        return command(output=Output(out, force, as_json, animate), **others)

    return with_options(
        taken,
        click.option(
            "--out", type=FILE, metavar="DIR",
            help="Folder for the results.  [default: a new one under runs/]",
        ),
        click.option("--force", is_flag=True, help="Write into DIR although it exists."),
        click.option("--json", "as_json", is_flag=True, help="Print the summary alone, as JSON."),
        click.option("--animate", is_flag=True, help="Make a GIF of the mission as well."),
    )  # fmt: skip


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

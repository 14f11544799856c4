"""``vedette compare``: the figures of several runs side by side."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import click
from rich.console import Console
from rich.table import Table

from vedette.cli.options import FILE
from vedette.errors import InputError
from vedette.record.plain import json_text
from vedette.run.saved import read_figures

COUNTED = ("travelled", "rounds", "sweeps", "collisions", "min_clearance", "messages", "bytes", "complaints")
LARGEST = ("pose_error_m",)  # by robot: of these the largest counts, not the sum
SHOWN = 5  # runs in a table; more are asked for as JSON
NAMED = 24  # of a figure's name, on a line of a terminal [characters]
WIDE = 1000  # a table that nobody folds: a file's, or a program's [characters]


@dataclass(frozen=True)
class Compared:
    """A figure of every run."""

    name: str
    values: tuple[Any, ...]  # None: a run has none

    @property
    def differs(self) -> bool:
        """Whether the runs differ in it."""
        return any(value != self.values[0] for value in self.values)


@click.command()
@click.argument("runs", metavar="RUN_DIR...", nargs=-1, required=True, type=FILE)
@click.option("--all", "everything", is_flag=True, help="Show what is the same in all runs, too.")
@click.option("--json", "as_json", is_flag=True, help="Print the figures as JSON.")
def compare(runs: tuple[Path, ...], everything: bool, as_json: bool) -> None:
    """Lay the figures of runs side by side: what differs, and by what factor from the first.

    What summary.json has by robot is added up; of errors of poses the largest counts. Exit status: 0, or 2
    for bad input.
    """
    if len(runs) < 2:
        raise InputError("there is one run only; name two or more")
    compared = figures_side_by_side([read_figures(run) for run in runs])
    if as_json:
        figures = {each.name: each.values for each in compared}
        click.echo(json_text({"runs": tuple(map(str, runs)), **figures}), nl=False)
        return
    if len(runs) > SHOWN:
        raise InputError(f"{len(runs)} runs are too many for a table of {SHOWN}: give fewer, or --json")
    shown = [each for each in compared if everything or each.differs]
    if not shown:
        click.echo("the runs have the same figures")
        return
    _print(runs, shown)


def _print(runs: Sequence[Path], shown: Sequence[Compared]) -> None:
    """Print a table: folded into a terminal's width, and elsewhere as wide as it gets; nothing is cut."""
    console = Console()
    folded = console.is_terminal
    named = min(max(len(each.name) for each in shown), NAMED)
    table = Table()
    table.add_column("", overflow="fold", width=named if folded else None)
    for run in runs:
        table.add_column(str(run), justify="right", overflow="fold")
    for each in shown:
        table.add_row(each.name, *(_told(value, each.values[0]) for value in each.values))
    (console if folded else Console(width=WIDE)).print(table)


def figures_side_by_side(summaries: Sequence[Mapping[str, Any]]) -> list[Compared]:
    """Return the figures that any run has, in the order of the first that has them."""
    plain = [_added_up(summary) for summary in summaries]
    names = dict.fromkeys(name for each in plain for name in each)
    return [Compared(name, tuple(each.get(name) for each in plain)) for name in names]


def _added_up(summary: Mapping[str, Any]) -> dict[str, Any]:
    """Return numbers and words as they are, those by robot as their sum or the largest, of lists the length.

    Other objects' fields are named with the object's name before them; of a robot's condition, which says who
    and where it is as well, what it has counted.
    """
    team = set(summary["path_m"]) if isinstance(summary.get("path_m"), dict) else set()
    told: dict[str, Any] = {}
    for name, value in summary.items():
        if name == "condition":
            told |= {each: _plain(value[each]) for each in COUNTED if each in value}
        elif isinstance(value, dict) and value.keys() != team:
            told |= {f"{name}.{inner}": each for inner, each in _added_up(value).items()}
        elif name != "schema_version":
            told[name] = _plain(value, max if name in LARGEST else sum)
    return told


def _plain(value: Any, of: Callable[[list[float]], float] = sum) -> Any:
    if isinstance(value, dict):
        numbers = _numbers(value)
        return of(numbers) if numbers else None
    return len(value) if isinstance(value, list) else value


def _numbers(value: Any) -> list[float]:
    if isinstance(value, dict):
        return [number for inner in value.values() for number in _numbers(inner)]
    return [value] if isinstance(value, int | float) else []


def _told(value: Any, first: Any) -> str:
    """Return a value, with its factor of the first run's if that is another number."""
    if value is None:
        return "-"
    if isinstance(value, bool) or not isinstance(value, int | float):
        return str(value).lower() if isinstance(value, bool) else str(value)
    text = f"{value:.6g}"
    comparable = isinstance(first, int | float) and not isinstance(first, bool) and first > 0
    return f"{text} (x{value / first:.2f})" if comparable and value != first else text

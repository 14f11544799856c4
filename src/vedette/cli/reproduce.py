"""``vedette reproduce``: the paper's figures and claims, made anew by a package that robots do not carry."""

from __future__ import annotations

import shlex
import sys
import time
from datetime import datetime
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

import click
from rich.console import Console
from rich.live import Live
from rich.text import Text

from vedette.cli.ends import aborted
from vedette.cli.options import FILE, seed_option
from vedette.errors import InputError
from vedette.number import many
from vedette.outcome import Outcome
from vedette.record.folder import OutputFolder
from vedette.study.provenance import provenance

if TYPE_CHECKING:
    from vedette_reproduction.reproduce import Reproduction


@click.command()
@click.option(
    "--out", type=FILE, metavar="DIR", help="Folder for the results.  [default: a new one under runs/]"
)
@click.option("--quick", is_flag=True, help="Smaller teams, fewer cases and missions: about a minute.")
@seed_option("all chance, and the offices")
@click.option("--force", is_flag=True, help="Write into DIR although it exists.")
def reproduce(out: Path | None, quick: bool, seed: int, force: bool) -> None:
    """Compute the paper's figures and try its claims, from nothing but this program and its package
    vedette-reproduction, which is in the folder reproduction of a clone.

    DIR gets report.html, which holds everything, and the pictures and data as files. Exit status: 0 complete,
    2 bad input, 130 interrupted: then the report has what was done until then.
    """
    _require()
    # This need not be installed.
    from vedette_reproduction.reproduce import reproduce as run_all
    from vedette_reproduction.run import FULL, QUICK

    made = datetime.now().astimezone().isoformat(" ", "seconds")
    source = provenance(shlex.join(["vedette", *sys.argv[1:]]), made)
    with (
        OutputFolder.make(out, force, "reproduce") as folder,
        LineProgress(Console(stderr=True)) as progress,
        aborted("the report is not written"),
    ):
        result = run_all(folder.path, QUICK if quick else FULL, seed, source, progress)
    click.echo(_closing(result))
    raise SystemExit((Outcome.COMPLETE if result.complete else Outcome.INTERRUPTED).status)


def _require() -> None:
    """Check that the reproduction is installed.

    Raises:
        InputError: it is not.
    """
    if find_spec("vedette_reproduction") is None:
        raise InputError(
            "vedette-reproduction is not installed; in a clone of Vedette, run: pip install ./reproduction"
        )


def _closing(result: Reproduction) -> str:
    """Say how the claims fared and where the report is."""
    fates = [section.verdict.value for section in result.sections if section.verdict is not None]
    counts = ", ".join(f"{fates.count(fate)} {_PLURAL.get(fate, fate)}" for fate in dict.fromkeys(fates))
    lines = [f"{many(len(fates), 'claim')} tried: {counts}" if fates else "no claim was tried"]
    if result.missing:
        lines.append(f"interrupted; missing: {', '.join(result.missing)}")
    return "\n".join([*lines, f"report: {result.report}"])


_PLURAL = {"holds": "hold", "holds in part": "hold in part", "does not hold": "do not hold"}


class LineProgress:
    """A line a part; on a terminal the last one tells what is under way; ``Progress`` of the reproduction."""

    def __init__(self, console: Console) -> None:
        """Write to a console."""
        self._console = console
        self._live = Live(console=console, refresh_per_second=8, transient=True)
        self._name = ""
        self._began = 0.0

    def __enter__(self) -> LineProgress:
        """Begin to show."""
        if self._console.is_terminal:
            self._live.start()
        return self

    def __exit__(self, *_: object) -> None:
        """End the line."""
        if self._console.is_terminal:
            self._live.stop()

    def begin(self, number: int, of: int, name: str) -> None:
        """Name the part."""
        self._name = f"[{number:2d}/{of}] {name:<10}"
        self._began = time.monotonic()
        self.tell("")

    def tell(self, text: str) -> None:
        """Show how far it is, on a terminal."""
        if self._console.is_terminal:
            self._live.update(Text.assemble(self._name, (f"  {text}", "dim")))

    def end(self, seconds: float) -> None:
        """Leave a line that says it is done."""
        self._console.print(Text(f"{self._name} {seconds:6.1f} s"), highlight=False)

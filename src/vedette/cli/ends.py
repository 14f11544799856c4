"""The last words of a command that is aborted, as the second Ctrl-C does: what is not written."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

import click

from vedette.errors import PartError
from vedette.record.folder import OutputFolder


@contextmanager
def aborted(told: str | Callable[[], str]) -> Iterator[None]:
    """Let an abort say what is missing."""
    try:
        yield
    except KeyboardInterrupt:
        click.echo(f"vedette: aborted; {told if isinstance(told, str) else told()}", err=True)
        raise


@contextmanager
def telling_what_is_missing(folder: OutputFolder, leaves: Sequence[str]) -> Iterator[None]:
    """Let an abort say which of its files, by name, a mission does not leave.

    An own part that goes wrong leaves none of them: they would be of half a mission.
    """

    def written() -> list[int | None]:
        places = [folder.path / name for name in leaves]
        return [place.stat().st_mtime_ns if place.exists() else None for place in places]

    before = written()  # by an earlier mission: each file is put in place whole, and thereby anew

    def told() -> str:
        missing = [name for name, old, new in zip(leaves, before, written(), strict=True) if old == new]
        return f"not written to {folder.path}: {', '.join(missing)}" if missing else "every file is written"

    try:
        with aborted(told):
            yield
    except PartError:
        for name, old, new in zip(leaves, before, written(), strict=True):
            if old != new:
                (folder.path / name).unlink()
        raise

"""The folder of a run: nobody else's while the run lasts, and another beside it should it vanish."""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterable
from contextlib import ExitStack, suppress
from pathlib import Path
from types import TracebackType
from typing import Self

from vedette.errors import InputError, InputWarning
from vedette.record.files import new_directory, output_directory
from vedette.record.lock import locked

RUNS = Path("runs")  # where folders are made that nobody has named


class OutputFolder:
    """A folder for results, entered for as long as they are written: ``folder / name`` is a place in it.

    A second run that enters the same folder is refused. A folder that is removed, moved away or replaced is
    noticed when it is next looked at, which `update` does, so that it serves as a sink: another one beside it
    takes its place, and an `InputWarning` says so.
    """

    def __init__(self, path: Path, *, made: bool = False, around: Path | None = None) -> None:
        """Take a folder that is there; ``made`` for this run, as was the one ``around`` it, if given."""
        self._path, self._made, self._around = path, made, around
        self._entered = ExitStack()
        self._identity = path.stat()

    @classmethod
    def make(cls, out: Path | None, force: bool, stem: str, inputs: Iterable[Path] = ()) -> OutputFolder:
        """Make the folder ``out``, or without one ``runs/STEM-001`` or whatever number is free.

        Raises:
            InputError: as `output_directory`.

        Warns:
            InputWarning: ``force`` is in vain, for the folder is a new one.
        """
        if force and out is None:
            text = "--force changes nothing without --out: the results go into a new folder"
            warnings.warn(text, InputWarning, stacklevel=2)
        if out is None:
            around = None if RUNS.exists() else RUNS
            return cls(new_directory(RUNS, stem), made=True, around=around)
        made = not out.exists()
        return cls(output_directory(out, force, inputs), made=made)

    def __enter__(self) -> Self:
        """Keep the folder to this run.

        Raises:
            InputError: another run has it, or it cannot be written to.
        """
        try:
            self._entered.enter_context(locked(self._path))
        except InputError:
            self._undo()
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Leave it to others; what was made for a run that came to nothing is gone again."""
        self._entered.close()
        if error is not None:
            self._undo()

    def _undo(self) -> None:
        """Remove what was made, unless something is in it."""
        if self._made:
            with suppress(OSError):
                self._path.rmdir()
                if self._around is not None:
                    self._around.rmdir()

    @property
    def path(self) -> Path:
        """Where the folder is now.

        Raises:
            InputError: it has vanished, and none can be made beside it.
        """
        if not self._is_there():
            vanished, self._path = self._path, new_directory(self._path.parent, self._path.name)
            self._identity = self._path.stat()
            self._entered.enter_context(locked(self._path))
            warnings.warn(f"{vanished} has vanished; results go to {self._path}", InputWarning, stacklevel=3)
        return self._path

    def __truediv__(self, name: str) -> Path:
        """Return the place of a file."""
        return self.path / name

    def update(self, snapshot: object) -> None:
        """Look whether the folder is still there."""
        _ = self.path

    def _is_there(self) -> bool:
        try:
            return os.path.samestat(self._identity, self._path.stat())
        except OSError:
            return False

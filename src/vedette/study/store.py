"""The results of a study: a file for each run, so that a study that was stopped goes on where it was."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Literal

import msgspec

from vedette.errors import InputError
from vedette.record.files import output_directory, write_text
from vedette.record.summary import SCHEMA_VERSION
from vedette.study.mission import RunResult
from vedette.study.run import Run


class Store:
    """Results in a folder, by the key of their run; each file is put in place whole."""

    def __init__(self, folder: Path, code: str) -> None:
        """Use a folder that is there; ``code`` is the fingerprint of what carries the runs out."""
        self._folder, self._code = folder, code

    @classmethod
    def open(cls, out: Path, code: str, inputs: Iterable[Path] = ()) -> Store:
        """Return the store below ``out``, made if it is not there; none of the ``inputs`` may lie in it.

        Raises:
            InputError: ``out`` is a folder with something else in it, or cannot be written to.
        """
        runs = out / "runs"
        if out.is_dir() and any(out.iterdir()) and not runs.is_dir():
            raise InputError(f"{out} holds something else than a study; give --out another folder")
        output_directory(out, force=True, inputs=inputs)
        return cls(output_directory(runs, force=True), code)

    def path(self, run: Run) -> Path:
        """Return where the result of a run is, or will be."""
        return self._folder / f"{run.key(self._code)}.json"

    def read(self, run: Run) -> RunResult | None:
        """Return the result of a run, ``None`` if there is none that can be read."""
        try:
            return msgspec.json.decode(self.path(run).read_bytes(), type=RunFile).result
        except (OSError, msgspec.DecodeError):
            return None

    def write(self, run: Run, result: RunResult) -> None:
        """Put the result of a run in place."""
        file = RunFile(run=run.columns(), result=result)
        write_text(self.path(run), msgspec.json.encode(file).decode() + "\n")

    def others(self, runs: list[Run]) -> int:
        """Count the results that are here but not of these runs as this code carries them out."""
        return len(
            {path.name for path in self._folder.glob("*.json")} - {self.path(run).name for run in runs}
        )


class RunFile(msgspec.Struct, kw_only=True):
    """The file of one run."""

    schema_version: Literal[3] = SCHEMA_VERSION
    run: dict[str, str | int | float | bool | None]  # for people: the key says the same
    result: RunResult

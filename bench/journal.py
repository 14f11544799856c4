"""The results file: one finished mission a line, so that a table can be gone on with."""

from __future__ import annotations

import json
from collections.abc import Collection, Mapping
from dataclasses import asdict
from pathlib import Path

from bench.cases import Key, Result
from vedette.errors import InputError
from vedette.record.files import write_text


def read(path: Path) -> dict[Key, Result]:
    """Return the missions done so far; none if there is no file.

    Raises:
        InputError: the file cannot be read, or a line of it is not a result.
    """
    if not path.exists():
        return {}
    done: dict[Key, Result] = {}
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"cannot read {path}: {error}; move it away") from error
    for number, line in enumerate(lines, start=1):
        try:
            result = Result(**json.loads(line))
        except (ValueError, TypeError) as error:
            raise InputError(f"{path}, line {number}: not a result; delete the line or the file") from error
        done[result.key] = result
    return done


def append(path: Path, result: Result) -> None:
    """Add a mission."""
    with path.open("a", encoding="utf-8") as file:
        file.write(_line(result))


def forget(path: Path, keys: Collection[Key]) -> None:
    """Take missions out of the file, to run them anew."""
    if path.exists():
        kept: Mapping[Key, Result] = read(path)
        write_text(path, "".join(_line(result) for key, result in kept.items() if key not in keys))


def _line(result: Result) -> str:
    return json.dumps(asdict(result), allow_nan=False) + "\n"

"""The results file: one finished mission a line, so that a table can be gone on with."""

from __future__ import annotations

import json
from collections.abc import Collection, Hashable
from dataclasses import asdict
from pathlib import Path
from typing import Protocol, TypeVar

from vedette.errors import InputError
from vedette.record.files import write_text


class Ended(Protocol):
    """What a table needs to know of a mission, whatever else it holds; a frozen dataclass."""

    @property
    def key(self) -> Hashable:
        """What tells the mission from all others."""

    @property
    def outcome(self) -> str:
        """How it ended."""

    @property
    def time_s(self) -> float:
        """When, simulated [s]."""


EndedT = TypeVar("EndedT", bound=Ended)


def read(path: Path, kind: type[EndedT]) -> dict[Hashable, EndedT]:
    """Return the missions done so far; none if there is no file.

    Raises:
        InputError: the file cannot be read, or a line of it is not a result.
    """
    if not path.exists():
        return {}
    done: dict[Hashable, EndedT] = {}
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"cannot read {path}: {error}; move it away") from error
    for number, line in enumerate(lines, start=1):
        try:
            result = kind(**json.loads(line))
        except (ValueError, TypeError) as error:
            raise InputError(f"{path}, line {number}: not a result; delete the line or the file") from error
        done[result.key] = result
    return done


def append(path: Path, result: Ended) -> None:
    """Add a mission."""
    with path.open("a", encoding="utf-8") as file:
        file.write(_line(result))


def forget(path: Path, keys: Collection[Hashable], kind: type[Ended]) -> None:
    """Take missions out of the file, to run them anew."""
    if path.exists():
        kept = read(path, kind)
        write_text(path, "".join(_line(result) for key, result in kept.items() if key not in keys))


def _line(result: Ended) -> str:
    return json.dumps(asdict(result), allow_nan=False) + "\n"  # type: ignore[call-overload]

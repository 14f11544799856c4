"""A folder in use: whoever locks it first has it until it leaves, or its process ends in whatever way."""

from __future__ import annotations

import contextlib
import fcntl
import os
from collections.abc import Iterator
from pathlib import Path
from typing import IO

from vedette.errors import InputError

LOCK = ".lock"  # holds the number of the process; one that was left behind locks nothing


@contextlib.contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Keep an existing folder to oneself.

    Raises:
        InputError: another run has it, or it cannot be written to.
    """
    path = folder / LOCK
    with contextlib.ExitStack() as leaving:
        try:
            file = _locked_file(path)
            leaving.callback(_left, file, path)
            file.truncate(0)
            file.write(f"{os.getpid()}\n")
            file.flush()
        except OSError as error:
            reason = error.strerror or error
            raise InputError(f"cannot write {path}: {reason}; choose another folder") from error
        yield


def _left(file: IO[str], path: Path) -> None:
    if _is_at(file, path):
        path.unlink()
    with contextlib.suppress(OSError):  # a full disk has no room for what is still to be written
        file.close()


def _locked_file(path: Path) -> IO[str]:
    """Return the lock's file, locked; another than the one at the path was removed meanwhile by its owner."""
    while True:
        file = path.open("a+", encoding="ascii", errors="replace")
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            file.seek(0)
            owner = file.read(20).strip()
            file.close()
            raise InputError(
                f"{path.parent} is in use by another run, process {owner}; let it end or take another folder"
            ) from None
        except OSError:
            return file  # a file system that has no locks
        if _is_at(file, path):
            return file
        file.close()


def _is_at(file: IO[str], path: Path) -> bool:
    try:
        return os.path.samestat(os.fstat(file.fileno()), path.stat())
    except OSError:
        return False

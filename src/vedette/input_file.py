"""Open a file that somebody named as input: a file, and nothing that reading could wait for."""

from __future__ import annotations

import stat
from pathlib import Path
from typing import BinaryIO

from vedette.errors import InputError

_NO_FILES = {
    stat.S_IFIFO: "a pipe",
    stat.S_IFSOCK: "a socket",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
}


def open_input(path: Path, what: str = "") -> BinaryIO:
    """Return the file, opened for reading; ``what`` it should be goes into messages, "map" for instance.

    Raises:
        InputError: it cannot be opened, or it is a folder, a pipe, a socket or a device.
    """
    named = f"{what} {path}".strip()
    try:
        if kind := _NO_FILES.get(stat.S_IFMT(path.stat().st_mode)):
            raise InputError(f"cannot read {named}: it is {kind}; give a file")
        return path.open("rb")
    except OSError as error:
        raise InputError(f"cannot read {named}: {error.strerror or error}") from error
    except ValueError as error:  # a name with a zero byte
        if isinstance(error, InputError):
            raise
        raise InputError(f"cannot read {named!a}: {error}") from error
